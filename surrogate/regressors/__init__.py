"""Surrogates as scikit-learn estimators on coded inputs; a method a file.

Start from `polynomial.Linear`; `gaussian_process.GaussianProcess` is the other common one.
Optional beyond fit and predict: `predict(X, return_std=True)`, `sobol_indices(groups)`,
`portable()`.
"""
