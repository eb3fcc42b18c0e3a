"""Where the side of a limit is unsure: the learning functions of reliability.

Echard, Gayton and Lemaire 2011, "AK-MCS", Structural Safety 33, 145-154: U = |m - limit| / s,
the side is wrong with probability Phi(-U); a point with U below 2 is unsure.

Bichon, Eldred, Swiler, Mahadevan and McFarland 2008, "Efficient global reliability analysis",
AIAA Journal 46, 2459-2468, equation 17: the expected feasibility, E max(e - |Y - limit|, 0)
for Y ~ N(m, s^2), e = 2 s.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr

from surrogate.adaptive.expected_improvement import density, positive

Array = NDArray[np.float64]

#: Below this U the side of a point is unsure (probability of being wrong 2.3 %).
UNSURE = 2.0
#: Half-width of the band about the limit, in deviations.
WIDTH = 2.0


def deviations_away(mean: Array, deviation: Array, limit: float) -> Array:
    """U (m,): distance of each prediction from the limit, in its deviations."""
    return np.asarray(np.abs(mean - limit) / positive(deviation))


def expected_feasibility(
    mean: Array, deviation: Array, limit: float, *, width: float = WIDTH
) -> Array:
    """How near to the limit a run is expected to be, (m,), in the output's unit.

    mean, deviation  (m,) of the prediction at each candidate; width: of the band, in deviations
    """
    s = positive(deviation)
    middle, low, high = (
        (limit - mean) / s,
        (limit - mean) / s - width,
        (limit - mean) / s + width,
    )
    told = (mean - limit) * (2.0 * ndtr(middle) - ndtr(low) - ndtr(high))
    told -= s * (2.0 * density(middle) - density(low) - density(high))
    told += width * s * (ndtr(high) - ndtr(low))
    return np.asarray(np.maximum(told, 0.0))
