"""What follows from the runs of a study: fits, comparison, indices, decision, report.

Start from `table.STAGES`: a row a stage. `walk.Walk` does those whose inputs changed.
"""
