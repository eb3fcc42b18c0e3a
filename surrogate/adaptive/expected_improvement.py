"""Expected improvement of a minimum.

Jones, Schonlau and Welch 1998, "Efficient global optimization of expensive black-box
functions", J. Global Optimization 13, 455-492, equation 15:

    E max(best - Y, 0) = (best - m) Phi(u) + s phi(u),   u = (best - m) / s,   Y ~ N(m, s^2)
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr

Array = NDArray[np.float64]

#: Deviations below this share of the largest one count as it, so that nothing divides by zero.
TINY = 1e-12


def expected_improvement(mean: Array, deviation: Array, best: float) -> Array:
    """How far a run is expected to fall below `best`, (m,), in the output's unit.

    mean, deviation  (m,) of the prediction at each candidate
    best             least value so far; of noisy runs the least prediction at a run, so that a
                     lucky run does not count as an improvement (Forrester, Keane and
                     Bressloff 2006, AIAA J. 44, 2331)
    """
    s = positive(deviation)
    u = (best - mean) / s
    return np.asarray(np.maximum((best - mean) * ndtr(u) + s * density(u), 0.0))


def positive(deviation: Array) -> Array:
    """Deviations (m,) that may be divided by."""
    largest = float(np.max(deviation, initial=0.0))
    return np.maximum(deviation, TINY * largest if largest > 0.0 else TINY)


def density(u: Array) -> Array:
    """The standard normal density."""
    return np.asarray(np.exp(-0.5 * u**2) / np.sqrt(2.0 * np.pi))
