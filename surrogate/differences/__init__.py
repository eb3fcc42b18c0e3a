"""What changed between two results folders: `compare` gives it part by part.

`surrogate.differences.compare` reads two folders, `page` draws the parts. Files that are missing
or damaged cost their part only.
"""
