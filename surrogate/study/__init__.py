"""From a study file to a `Study`: shape, places of mistakes, words to objects.

Start from `study.Study` and, below it, `description.Description`; `file` has the shape of the file, `reading` turns words to objects.
"""
