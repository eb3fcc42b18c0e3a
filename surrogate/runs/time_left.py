"""How long the runs that are left will take.

What runs took is described by the product-limit estimate (Kaplan and Meier 1958), in which a run
under way counts as one that takes longer than it has run: so the short runs that end first do
not mislead. A trend over the study is followed where it is beyond doubt. The runs that are left
are then handed to the places as they come free, a few times over with drawn durations.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: Latest runs that are looked at.
WINDOW = 400
#: A slope of so many standard errors, from so many runs, is a trend.
SURE, FEWEST = 4.0, 8
#: Numbers drawn at a time, and runs at the end that are handed to the places one by one.
DRAWS, TAIL = 512, 200


def time_left(
    ended: Sequence[float],
    running: Sequence[float],
    left: int,
    places: int,
    order: Sequence[float] | None = None,
) -> float | None:
    """Expected seconds until all runs have ended; None when no run has ended yet.

    ended    seconds that runs took
    running  seconds for which those under way have run
    left     number of runs that have not ended, those under way included
    order    when those that ended began: numbers from 0 on; default: one after the other
    """
    if not left:
        return 0.0
    if not len(ended):
        return None
    took, ages = np.asarray(ended[-WINDOW:], dtype=float), np.asarray(running, dtype=float)[:left]
    begun = np.arange(len(ended)) if order is None else np.asarray(order)
    levels = _levels(took, begun[-WINDOW:].astype(float), len(ended), left)
    law = _Law.of(took / levels[: len(took)], ages / levels[len(took) :][: len(ages)])
    draws = max(8, DRAWS // places)
    ends = np.zeros((draws, places))
    generator = np.random.default_rng(0)
    ahead = levels[len(took) :]

    def strata() -> Array:
        return np.asarray((generator.permutation(draws) + 0.5) / draws)

    for place, age in enumerate(ages[:places]):
        ends[:, place] = ahead[place] * law.rest(age / ahead[place], strata())
    waiting = ahead[len(ages) :]
    rounds = max(0, len(waiting) - min(4 * places, TAIL)) // places
    bulk = rounds * places
    ends += law.mean * waiting[:bulk].sum() / places
    rows = np.arange(draws)
    for level in waiting[bulk:]:
        free = ends.argmin(axis=1)
        ends[rows, free] += level * law.draw(strata())
    return float(ends.max(axis=1).mean())


def continues(earlier: Sequence[float], ended: Sequence[float], places: int) -> bool:
    """False when runs that ended are beyond doubt slower or faster than `earlier` ones go on.

    Of the first runs on several places the short ones end first, so they are no sign.
    """
    if len(earlier) < 3 or len(ended) < max(3, 2 * places):
        return True
    before, now = np.asarray(earlier[-WINDOW:]), np.asarray(ended)
    levels = _levels(before, np.arange(float(len(before))), len(before), len(now))
    before, now = before / levels[: len(before)], now / levels[len(before) :]
    error = np.sqrt(before.var(ddof=1) / len(before) + now.var(ddof=1) / len(now))
    return bool(abs(now.mean() - before.mean()) <= SURE * error)


def _levels(took: Array, order: Array, ended: int, left: int) -> Array:
    """Level of the durations at each run, past and to come: 1, or their trend."""
    count = len(took)
    level = np.ones(count + left)
    x = order - order.mean()
    if count >= FEWEST and took.any() and x.any():
        slope = x @ took / (x @ x)
        scatter = took - took.mean() - slope * x
        error = np.sqrt(scatter @ scatter / (count - 2) / (x @ x))
        if abs(slope) > SURE * error:
            ahead = ended - order.mean() + np.arange(left)
            line = took.mean() + slope * np.concatenate([x, ahead])
            level = np.maximum(line, 0.1 * took.mean())
    return level


@dataclass(frozen=True)
class _Law:
    """Durations (k,), ascending, with the share of the runs that takes at most so long (k,)."""

    values: Array
    shares: Array

    @classmethod
    def of(cls, ended: Array, running: Array) -> _Law:
        """The product-limit estimate; what it leaves open goes to the longest run that ended."""
        values, counts = np.unique(ended, return_counts=True)
        at_risk = len(ended) - np.cumsum(counts) + counts
        at_risk = at_risk + (running[None, :] >= values[:, None]).sum(axis=1)
        shares = 1.0 - np.cumprod(1.0 - counts / at_risk)
        shares[-1] = 1.0
        return cls(values, shares)

    @cached_property
    def mean(self) -> float:
        """Mean duration."""
        return float(self.values @ np.diff(self.shares, prepend=0.0))

    def draw(self, uniform: Array) -> Array:
        """Durations for numbers of [0, 1), scaled to have the mean of the law."""
        found = np.asarray(self.values[np.searchsorted(self.shares, uniform, side="right")])
        return found * (self.mean / found.mean()) if found.any() else found

    def rest(self, age: float, uniform: Array) -> Array:
        """What is left of runs that have run for `age`, for numbers of [0, 1).

        One that has run longer than any other is given as much again as it is over.
        """
        behind = np.searchsorted(self.values, age, side="right")
        over = self.shares[behind - 1] if behind else 0.0
        if behind == len(self.values) or over >= 1.0:
            return np.full(uniform.shape, max(age - self.values[-1], 0.0))
        longer = over + (1.0 - over) * uniform
        return np.asarray(self.values[np.searchsorted(self.shares, longer, side="right")] - age)
