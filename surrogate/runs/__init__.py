"""Runs of the solver: what identifies one, where it is kept, and the dataset of all.

Start from `assembly.assemble`; the truth while runs go on is `journal.Journal`.
"""
