"""Workers that share a folder and nothing else: they claim runs, each keeps its own records.

Start from `work.work`; `claims` says who does what.
"""
