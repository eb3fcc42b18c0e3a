"""Which effects of a saturated orthogonal design are real, without an error to test against.

Most effects are noise, so that their typical size is the noise's: Lenth 1989 (doi
10.1080/00401706.1989.10488595). With s0 = 1.5 median |c_j| and the pseudo standard error

    PSE = 1.5 median {|c_j| : |c_j| < 2.5 s0},

effects beyond the margin of error t(0.975; m / 3) PSE are taken for active, m being their
number. The margin is on the safe side (Ye and Hamada 2000, doi 10.1080/00224065.2000.11979971).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from surrogate.regressors.least_squares import LeastSquares

Array = NDArray[np.float64]

#: Fewer effects give no typical size.
FEWEST = 5


@dataclass(frozen=True)
class Lenth:
    """Pseudo standard error of a coefficient, and the margin beyond which it is active.

    simultaneous: the margin for all coefficients together, so that one experiment in twenty
    without any effect shows one.
    """

    pse: float
    margin: float
    simultaneous: float


def lenth(coefficients: Array, confidence: float = 0.95) -> Lenth:
    """Of coefficients (m,) with equal variances, the constant left out."""
    sizes = np.abs(coefficients)
    first = 1.5 * np.median(sizes)
    pse = 1.5 * float(np.median(sizes[sizes < 2.5 * first])) if first > 0.0 else 0.0
    count = len(sizes)
    alone = stats.t.ppf(0.5 + confidence / 2.0, count / 3.0)
    together = stats.t.ppf(0.5 + 0.5 * confidence ** (1.0 / count), count / 3.0)
    return Lenth(pse, float(alone * pse), float(together * pse))


def of_saturated(model: LeastSquares, confidence: float = 0.95) -> Lenth | None:
    """Of a fit whose runs leave no degree of freedom and whose columns are orthogonal."""
    effects = model.matrix[:, model.kept][:, 1:]
    products = effects.T @ effects
    size = products[0, 0] if len(products) else 0.0
    orthogonal = np.abs(products - size * np.eye(len(products))).max(initial=0.0) < 1e-9 * size
    if model.freedom or len(products) < FEWEST or not orthogonal:
        return None
    return lenth(model.coefficients[model.kept][1:], confidence)
