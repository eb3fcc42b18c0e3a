"""A probability of failure with the interval of its sampling."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtri

Array = NDArray[np.float64]
#: Its two ends.
Interval = tuple[float, float]


@dataclass(frozen=True)
class Estimate:
    """What one method says.

    probability  of failure
    low, high    ends of the interval for the sampling; NaN where the method has none (FORM)
    evaluations  of the limit state
    """

    method: str
    probability: float
    low: float
    high: float
    evaluations: int

    @property
    def beta(self) -> float:
        """Generalised reliability index, -Phi^-1(probability)."""
        return float(-ndtri(self.probability))


@dataclass(frozen=True)
class Population:
    """Weighted points of the standard normal space, many of them near the limit.

    u       (m, d)
    weight  (m,), sums to 1: a probability is the sum of the weights of its points
    g       (m,) of the limit state that the points were found by
    """

    u: Array
    weight: Array
    g: Array

    @property
    def failing(self) -> Array:
        """Points (k, d) that fail."""
        return np.asarray(self.u[self.g <= 0.0])

    def probability(self, failed: NDArray[np.bool_]) -> float:
        """Of the event that holds at the points `failed` (m,)."""
        return float(self.weight[failed].sum())
