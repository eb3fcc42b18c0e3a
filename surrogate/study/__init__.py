"""From a study file to a `Study`: shape, places of mistakes, words to objects.

Start from `study.Study`; below it `description.Description` is what the file says, `file` has
the shape of the file, and `reading` turns words into objects.
"""
