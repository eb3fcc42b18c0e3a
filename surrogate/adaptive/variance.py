"""What a further run takes from the variance of a Gaussian process; no answer is needed.

With c the covariance of the process given its runs and t^2 the nugget's variance, a run at x
takes c(x, z)^2 / (c(x, x) + t^2) from the variance at z, and of a weighted sum w' f(Z)

    (c(x, Z) w)^2 / (c(x, x) + t^2)

Averaged over the parameters' law: integrated mean square error (Sacks, Schiller and Welch
1989, Technometrics 31, 41-47), the criterion of Cohn 1996 (Neural Networks 9, 1071-1083).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import linalg

from surrogate.regressors.gaussian_process import GaussianProcess
from surrogate.regressors.matern import correlation

Array = NDArray[np.float64]


def covariances(process: GaussianProcess, X: Array, Z: Array) -> Array:
    """Covariances (m, k) of the process, given its runs, between coded points X and Z."""
    one = process.factors_
    parts = []
    for points in (process.expanded(X), process.expanded(Z)):
        with_runs = correlation(points, process.points_, process.lengths_)
        explained = linalg.solve_triangular(one.factor, with_runs.T, lower=True)
        parts.append((points, explained, process.trend_columns(points) - with_runs @ one.solved))
    (x, ex, rest_x), (z, ez, rest_z) = parts
    found = correlation(x, z, process.lengths_) - ex.T @ ez + rest_x @ one.gain @ rest_z.T
    return np.asarray(process.variance_ * found)


def taken(process: GaussianProcess, X: Array, Z: Array, weights: Array | None = None) -> Array:
    """Variance that a run at each of X (m, d) takes.

    weights  None: the mean over Z (k, d) of what is taken there, shape (m,); else (k, sums):
             what is taken of each weighted sum over Z, shape (m, sums)
    """
    _, deviation = process.predict(X, return_std=True)  # of a run, the nugget included
    joint = covariances(process, X, Z)
    if weights is None:
        return np.asarray((joint**2).mean(axis=1) / deviation**2)
    return np.asarray((joint @ weights) ** 2 / deviation[:, None] ** 2)
