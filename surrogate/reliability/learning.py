"""Active learning at the limit state: where to run next, and when to stop.

Candidates are the points of a subset simulation on the surrogate, so that failures of any
rarity are among them. Of those the next run is where the sign of g is least sure: the smallest
U = |m| / s (Echard, Gayton and Lemaire 2011, doi 10.1016/j.strusafe.2011.01.002); further runs
of a batch keep away from it. The probability is known well enough when its index is
stable and the bounds from m - 2 s and m + 2 s lie close (Moustapha, Marelli and Sudret 2022,
doi 10.1016/j.strusafe.2021.102174, section 3.5).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtri

from surrogate.reliability.estimate import Population
from surrogate.reliability.limit_state import LimitState
from surrogate.reliability.subset import population

Array = NDArray[np.float64]
#: Mean and standard deviation, both (m,), of g at points (m, d) of the standard normal space.
Process = Callable[[Array], tuple[Array, Array]]

#: Deviations of the bounds.
WIDTH = 2.0
#: Allowed width of the bounds of beta and change of beta, as shares of beta; steps in a row.
BOUNDS, CHANGE, STEPS = 0.05, 0.01, 3
#: Points of a batch lie this far apart, in standard deviations.
APART = 0.3


@dataclass(frozen=True)
class Known:
    """What the surrogate says of the probability now: its value and its bounds."""

    probability: float
    low: float
    high: float

    @property
    def betas(self) -> Array:
        """Index of the value, of the upper and of the lower bound of the probability."""
        return np.asarray(-ndtri(np.array([self.probability, self.high, self.low])))


def candidates(process: Process, size: int, *, samples: int = 2_000, seed: int = 0) -> Population:
    """Weighted points of a subset simulation on the mean of the surrogate."""
    return population(LimitState(size, lambda u: process(u)[0]), samples=samples, seed=seed)


def known(process: Process, points: Population) -> Known:
    """The probability by m, and by m + 2 s and m - 2 s."""
    mean, deviation = process(points.u)
    return Known(
        points.probability(mean <= 0.0),
        points.probability(mean + WIDTH * deviation <= 0.0),
        points.probability(mean - WIDTH * deviation <= 0.0),
    )


def next_points(process: Process, points: Population, runs: int = 1) -> Array:
    """`runs` points (run, d) at most where the sign is least sure, apart from each other."""
    mean, deviation = process(points.u)
    unsure = np.abs(mean) / np.maximum(deviation, np.finfo(float).tiny)
    chosen: list[Array] = []
    for k in np.argsort(unsure, kind="stable"):
        if all(np.linalg.norm(points.u[k] - one) >= APART for one in chosen):
            chosen.append(points.u[k])
        if len(chosen) == runs:
            break
    return np.array(chosen)


def enough(history: Sequence[Known]) -> bool:
    """Whether bounds and changes of beta were small over the last steps."""
    if len(history) <= STEPS:
        return False
    betas = np.array([one.betas for one in history[-STEPS - 1 :]])
    if not np.isfinite(betas).all():
        return False
    size = np.maximum(np.abs(betas[:, 0]), np.finfo(float).tiny)
    narrow = (betas[1:, 2] - betas[1:, 1]) <= BOUNDS * size[1:]
    still = np.abs(np.diff(betas[:, 0])) <= CHANGE * size[1:]
    return bool(narrow.all() and still.all())
