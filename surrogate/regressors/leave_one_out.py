"""Leaving each run out by refitting, for estimators without a closed form."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from sklearn.base import clone

from surrogate.estimator import Regressor

Array = NDArray[np.float64]


def by_refits(estimator: Regressor, coded: Array, values: Array) -> Array:
    """Predictions (n,) of the runs coded (n, d), values (n,), each by a fit to the others."""
    found = np.empty(len(values))
    for run in range(len(values)):
        others = np.arange(len(values)) != run
        found[run] = clone(estimator).fit(coded[others], values[others]).predict(coded[[run]])[0]
    return found
