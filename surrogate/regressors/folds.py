"""Folds of cross-validation: which runs are left out together.

Up to `LEAVE_ONE_OUT` points each point is left out in turn; above, ten folds. Replicates are
left out together.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Numbers = NDArray[np.intp]

#: Largest number of points that are left out one at a time.
LEAVE_ONE_OUT = 20
FOLDS = 10


def folds(runs: int, *, seed: int = 0) -> Numbers:
    """Fold number of each run (n,): one run each up to `LEAVE_ONE_OUT` runs, else ten folds."""
    if runs <= LEAVE_ONE_OUT:
        return np.arange(runs)
    return np.random.default_rng(seed).permutation(np.arange(runs) % FOLDS)


def point_folds(points: Array, *, seed: int = 0) -> Numbers:
    """Fold number of each run (n,) at coded points (n, d): replicates are left out together."""
    _, first, point = np.unique(np.round(points, 9), axis=0, return_index=True, return_inverse=True)
    order = np.argsort(np.argsort(first))  # points are counted as they appear
    return folds(len(first), seed=seed)[order[point.ravel()]]
