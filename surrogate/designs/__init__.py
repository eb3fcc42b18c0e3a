"""Designs of experiments: a method a file, coded points out.

A method is a function `(space, *, seed=None, **options) -> coded (run, parameter)`
with values in [-1, 1]; its options are keyword-only and have their types and
defaults in the signature. `fold_over`, `center_points` and `axial_points` augment:
`(space, coded, *, seed=None, **options) -> coded rows to add`.

`seed=None` draws fresh random numbers, as NumPy does; a study gives every design
its own seed so that the same study has the same points.
"""
