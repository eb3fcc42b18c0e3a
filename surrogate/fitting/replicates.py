"""Replicates: runs at one point, whose scatter is the pure error.

Pure error and its degrees of freedom: Montgomery, Peck and Vining 2012, section 4.5. Whether
the scatter depends on the place: Brown and Forsythe 1974 (J. Am. Stat. Assoc. 69, 364), the
test of Levene about the medians, over the points with three replicates or more.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import stats

#: Replicates of a point from which its scatter can be compared with that of others.
ENOUGH = 3
#: Chance below which the scatter is said to depend on the place.
CHANCE = 0.01


@dataclass(frozen=True)
class Replicates:
    """The scatter of one output at repeated points.

    points, runs  repeated points, and the runs at them
    std           standard deviation of the pure error, in the output's unit; freedom: of it
    p             of the Brown-Forsythe test; NaN where too few points have three replicates
    smallest, largest  standard deviation at the calmest and at the wildest of these points
    """

    points: int
    runs: int
    std: float
    freedom: int
    p: float = math.nan
    smallest: float = math.nan
    largest: float = math.nan

    @property
    def uneven(self) -> bool:
        """True when the scatter depends on the place by more than chance."""
        return self.p < CHANCE


def runs_by_point(coded: NDArray[np.float64]) -> list[NDArray[np.intp]]:
    """Numbers of the runs at each different point of coded (n, d), rising."""
    _, point, runs = np.unique(np.round(coded, 9), axis=0, return_inverse=True, return_counts=True)
    return np.split(np.argsort(point.ravel(), kind="stable"), np.cumsum(runs)[:-1])


def replicates(coded: NDArray[np.float64], values: NDArray[np.float64]) -> Replicates | None:
    """The scatter of values (n,) at equal points of coded (n, d); None when there is none.

    Equal answers at equal points are those of a deterministic solver and no scatter.
    """
    groups = [values[own] for own in runs_by_point(coded) if len(own) > 1]
    size = 1e-12 * np.abs(values).max(initial=0.0)
    if not any(np.ptp(group) > size for group in groups):
        return None
    squares = sum(float(((group - group.mean()) ** 2).sum()) for group in groups)
    runs = sum(map(len, groups))
    freedom = runs - len(groups)
    found = Replicates(len(groups), runs, math.sqrt(squares / freedom), freedom)
    large = [group for group in groups if len(group) >= ENOUGH]
    if len(large) < 2:
        return found
    spreads = [float(group.std(ddof=1)) for group in large]
    with np.errstate(divide="ignore", invalid="ignore"):
        p = float(stats.levene(*large, center="median").pvalue)
    return Replicates(len(groups), runs, found.std, freedom, p, min(spreads), max(spreads))
