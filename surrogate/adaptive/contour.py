"""Expected improvement of a contour: where an output takes a given value.

Ranjan, Bingham and Michailidis 2008, "Sequential experiment design for contour estimation from
complex computer codes", Technometrics 50, 527-541. A run improves by e^2 - (Y - value)^2 where
that is positive, with e = alpha s; its expectation for Y ~ N(m, s^2), with d = m - value and
u1, u2 = (-d - e) / s, (-d + e) / s, is

    (e^2 - d^2) (Phi(u2) - Phi(u1)) - 2 d s (phi(u1) - phi(u2))
        - s^2 (Phi(u2) - Phi(u1) - u2 phi(u2) + u1 phi(u1))
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr

from surrogate.adaptive.expected_improvement import density, positive

Array = NDArray[np.float64]

#: Half-width of the band about the value, in deviations.
ALPHA = 2.0


def contour_improvement(
    mean: Array, deviation: Array, value: float, *, alpha: float = ALPHA
) -> Array:
    """What a run at each candidate is expected to tell of the contour, (m,), unit squared.

    mean, deviation  (m,) of the prediction at each candidate
    """
    s, d = positive(deviation), mean - value
    e = alpha * s
    u1, u2 = (-d - e) / s, (-d + e) / s
    inside, low, high = ndtr(u2) - ndtr(u1), density(u1), density(u2)
    told = (e**2 - d**2) * inside - 2.0 * d * s * (low - high)
    told -= s**2 * (inside - u2 * high + u1 * low)
    return np.asarray(np.maximum(told, 0.0))
