"""The command `surrogate`: its verbs, what they print, and the folder of results.

Start from `verbs.app`.
"""
