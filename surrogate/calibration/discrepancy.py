"""How reality differs from the solver: a Gaussian process over the known inputs.

Kennedy and O'Hagan 2001, "Bayesian calibration of computer models", J. R. Statist. Soc. B 63,
equation 4, with scale factor 1: measured = solver(known, free) + discrepancy(known) + error, the
discrepancy having mean 0 and covariance

    s^2 (1 + r + r^2 / 3) exp(-r),   r = sqrt(5) |x - x'| / length

(Matern 5/2; one length for all known inputs, in coded values; unlike levels lie 2 apart). With
measurements at one or two different points it is a constant bias: covariance s^2.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from surrogate.space.space import Parameter

Array = NDArray[np.float64]

#: With fewer different points than this the discrepancy is a constant.
POINTS = 3


def varies(known: Array) -> bool:
    """True when the points (case, known) tell a constant from a function."""
    return known.shape[1] > 0 and len(np.unique(np.round(known, 9), axis=0)) >= POINTS


def distances(known: Array, parameters: list[Parameter]) -> Array:
    """Distances (case, case) between coded known inputs (case, known)."""
    squares = np.zeros((len(known), len(known)))
    for column, parameter in zip(known.T, parameters, strict=True):
        gap = np.abs(column[:, None] - column[None, :])
        squares += (2.0 * (gap > 1e-9) if parameter.categorical else gap) ** 2
    return np.sqrt(squares)


def covariance(distance: Array, deviation: Array, length: Array | None) -> Array:
    """Covariances (w, case, case) for deviations (w,) and lengths (w,); None: constant."""
    variance = deviation[:, None, None] ** 2
    if length is None:
        return np.asarray(np.broadcast_to(variance, (len(deviation), *distance.shape)).copy())
    r = np.sqrt(5.0) * distance / length[:, None, None]
    return np.asarray(variance * (1.0 + r + r**2 / 3.0) * np.exp(-r))
