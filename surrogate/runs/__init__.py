"""Runs of the solver: what identifies one, where it is kept, and the dataset of all.

Start from `dataset.assemble`; the truth while runs go on is `journal.Journal`.
"""
