"""The answer: a probability of failure, its interval, and the design point."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from surrogate.reliability.estimate import Estimate, Interval
from surrogate.reliability.problem import Failure

Array = NDArray[np.float64]
_HOW = {
    "crude": "crude Monte Carlo",
    "importance": "importance sampling",
    "subset": "subset simulation",
}


@dataclass(frozen=True)
class DesignPoint:
    """Most probable failure, by the first-order method.

    beta     distance from the median in standard normal space; negative where the median fails
    first_order  Phi(-beta)
    inputs   the point, in units
    factors  share of each parameter, which sum to 1; of correlated ones, of what is left of each
             when those before it are known
    """

    beta: float
    first_order: float
    inputs: Mapping[str, float]
    factors: Mapping[str, float]


@dataclass(frozen=True, eq=False)
class Reliability:
    """A probability of failure with its interval and the parts of it.

    estimate         of the surrogate's mean, with the interval of the sampling error
    low, high        interval of sampling and surrogate together
    error            interval of the surrogate's error alone
    how              how the surrogate's part was found
    levels, exceedance  (k,) values of the output, and the probability of passing each
    """

    problem: Failure
    surrogate: str
    estimate: Estimate
    low: float
    high: float
    error: Interval
    how: str
    design_point: DesignPoint | None
    levels: Array
    exceedance: Array

    @property
    def probability(self) -> float:
        """Of failure."""
        return self.estimate.probability

    @property
    def sampling(self) -> Interval:
        """Interval of the sampling error alone."""
        return self.estimate.low, self.estimate.high

    @property
    def leading(self) -> str:
        """Which part of the interval is the larger one."""
        wide = [
            (high - low, name)
            for (low, high), name in ((self.error, "surrogate"), (self.sampling, "sampling"))
        ]
        return max(wide)[1]

    def __str__(self) -> str:
        interval = f"(95 % interval {self.low:.2g} to {self.high:.2g})"
        if not self.probability > 0.0:
            return f"probability of {self.problem}: below {self.high:.2g}; no sample fails"
        said = f"probability of {self.problem}: {self.probability:.3g} {interval}"
        if self.probability < 1.0:
            said += f", reliability index {self.estimate.beta:.3g}"
        said += f", by {_HOW[self.estimate.method]} of {self.surrogate}"
        return f"{said}; most of the interval is {self._cause}"

    @property
    def _cause(self) -> str:
        if self.leading == "surrogate":
            return "the surrogate's error: runs near the limit would narrow it"
        return "sampling error"
