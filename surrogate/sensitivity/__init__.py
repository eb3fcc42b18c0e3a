"""Global sensitivity analysis of surrogates, and the screening that rests on it.

A method is a function `method(fit, space, *, seed, confidence, **options)` of one output's
fit (or of any function of coded points) that returns an xarray dataset with dimensions
`output` and `parameter`; `table.combine` joins those of several outputs.
"""
