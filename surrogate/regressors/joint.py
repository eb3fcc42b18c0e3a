"""Joint law of new runs at several points, by a fitted Gaussian process.

The covariance of runs at x and y is, the variance of the process being s2, with R, F, r, f as
in `surrogate.regressors.kriging` and h = f - F' R^-1 r,

    s2 (k(x, y) + nugget(x) [x = y] - r(x)' R^-1 r(y) + h(x)' (F' R^-1 F)^-1 h(y))

(Santner, Williams, Notz, The Design and Analysis of Computer Experiments, 2nd ed. 2018,
section 3.2). Runs at the same point are one run: they share the nugget.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import linalg

from surrogate.regressors.columns import expand
from surrogate.regressors.matern import ROOT5, correlation
from surrogate.regressors.process import Process

Array = NDArray[np.float64]


def joint(process: Process, X: Array) -> tuple[Array, Array]:
    """Means (m, n) and covariances (m, n, n) of runs at m sets of n coded points X (m, n, d)."""
    sets, size, _ = X.shape
    points, one = expand(X.reshape(sets * size, -1), process.columns_), process.factors_
    with_runs = correlation(points, process.points_, process.lengths_)
    trend = process.trend_columns(points)
    mean = with_runs @ process.weights_ + trend @ process.trend_
    explained = linalg.solve_triangular(
        one.factor, with_runs.T, lower=True, check_finite=False
    ).T.reshape(sets, size, -1)
    rest = (trend - with_runs @ one.solved).reshape(sets, size, -1)
    nuggets = (process.nugget_ * process.noise_at(points)).reshape(sets, size)
    found = _within(points.reshape(sets, size, -1), process.lengths_, nuggets)
    found -= explained @ explained.swapaxes(1, 2)
    found += rest @ one.gain @ rest.swapaxes(1, 2)
    diagonal = np.einsum("kii->ki", found)
    np.maximum(diagonal, nuggets, out=diagonal)
    return (
        process.offset_ + process.scale_ * mean.reshape(sets, size),
        process.predictive_variance * found,
    )


def _within(points: Array, lengths: Array, nuggets: Array) -> Array:
    """Covariances (m, n, n) of runs within each set of points (m, n, c), the process's being 1."""
    found = np.ones((*points.shape[:2], points.shape[1]))
    same = np.ones(found.shape, dtype=bool)
    for column in np.moveaxis(points * (ROOT5 / lengths), 2, 0):
        s = np.abs(column[:, :, None] - column[:, None, :])
        found *= (1.0 + s + s**2 / 3.0) * np.exp(-s)
        same &= s == 0.0
    return np.asarray(found + nuggets[:, :, None] * same)
