"""Lengths and nuggets that the runs allow: Laplace's approximation of their posterior.

About its maximum, -2 log of the posterior of log lengths and log nugget x is nearly quadratic,
with Hessian H, so x is nearly normal with covariance 2 H^-1 (MacKay, Information Theory,
Inference, and Learning Algorithms, 2003, chapter 27). At a bound, and where the runs say next to
nothing, H is no guide: there the deviation is that of the prior of a length.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from surrogate.regressors.likelihood import Posterior

Array = NDArray[np.float64]

#: Step of the differences of gradients, in log lengths.
STEP = 1e-3


def plausible(
    posterior: Posterior, logs: Array, bounds: Array, count: int, rng: np.random.Generator
) -> Array:
    """Drawn log lengths and log nuggets (count, c + 1) about the most probable `logs` (c + 1,).

    posterior  of one output;  bounds (c + 1, 2), within which draws are clipped
    """
    precisions, axes = np.linalg.eigh(0.5 * _hessian(posterior, logs))
    deviations = 1.0 / np.sqrt(np.maximum(precisions, posterior.prior.spread**-2))
    moves = (deviations * rng.standard_normal((count, len(logs)))) @ axes.T
    return np.asarray(np.clip(logs + moves, *bounds.T))


def _hessian(posterior: Posterior, logs: Array) -> Array:
    """Symmetric second derivatives (c + 1, c + 1) of -2 log posterior, by central differences."""
    rows = [
        posterior.at(logs + move).gradient(0) - posterior.at(logs - move).gradient(0)
        for move in STEP * np.eye(len(logs))
    ]
    found = np.array(rows) / (2.0 * STEP)
    return np.asarray(0.5 * (found + found.T))
