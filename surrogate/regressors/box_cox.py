"""The power of the output that a polynomial describes best (Box and Cox 1964).

With z = (y^lambda - 1) / (lambda g^(lambda - 1)), g the geometric mean of y, and z = g log y at
lambda = 0, the residual sums of squares of the powers can be compared: the likelihood is
largest where SSE(lambda) is least, and the interval holds the powers with

    n log(SSE(lambda) / SSE(best)) <= chi^2(confidence; 1)

(Montgomery, Peck and Vining 2012, section 5.4).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from surrogate.regressors.least_squares import LeastSquares

Array = NDArray[np.float64]

#: Powers that are compared.
POWERS = np.linspace(-3.0, 3.0, 241)
#: A range of y below this ratio of largest to smallest says nothing about powers.
LEAST_RATIO = 1.5
#: What people call the powers that are round.
NAMES = {-1.0: "1 / y", -0.5: "1 / sqrt(y)", 0.0: "log y", 0.5: "sqrt(y)", 2.0: "y^2"}


@dataclass(frozen=True)
class Power:
    """The best power of the output with its interval."""

    best: float
    low: float
    high: float

    @property
    def transformation(self) -> str:
        """The round transformation nearest to the best power inside the interval; "" for none."""
        if self.low <= 1.0 <= self.high:
            return ""
        inside = [power for power in NAMES if self.low <= power <= self.high]
        return NAMES[min(inside, key=lambda power: abs(power - self.best))] if inside else ""


def box_cox(model: LeastSquares, confidence: float = 0.95) -> Power | None:
    """Of the terms and runs of a fit; None where powers mean nothing or nothing can judge them.

    The output must be positive, spread over a ratio of 1.5, and leave degrees of freedom.
    """
    y = model.y
    if model.freedom < 2 or y.min() <= 0.0 or y.max() < LEAST_RATIO * y.min():
        return None
    scaled = np.log(y) - np.log(y).mean()  # y over its geometric mean
    z = np.column_stack([np.expm1(p * scaled) / p if abs(p) > 1e-9 else scaled for p in POWERS])
    sums = ((z - model.basis @ (model.basis.T @ z)) ** 2).sum(axis=0)
    if sums.min() <= 1e-20 * (z**2).sum(axis=0).min():
        return None  # an exact fit: every other power is worse without end
    inside = len(y) * np.log(sums / sums.min()) <= stats.chi2.ppf(confidence, 1)
    held = POWERS[inside]
    return Power(float(POWERS[sums.argmin()]), float(held[0]), float(held[-1]))
