"""The search among the inputs that may be chosen.

A space-filling pool is judged first. From its best points, which lie apart from each other,
the search goes on in neighbourhoods that shrink: each round judges random neighbours of every
point together and keeps the best. It takes levels, integers, listed values and constraints as
they are, and judges many candidates in one prediction.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.stats import qmc

from surrogate.errors import StudyError
from surrogate.fitting.extrapolation import Cloud
from surrogate.space.space import Space

Array = NDArray[np.float64]
#: Coded points (m, d), and the number of the start that each belongs to (m,) -> merits (m,).
Judge = Callable[[Array, NDArray[np.intp]], Array]

#: Size of the pool; rounds; neighbours of a point in a round; first and last size of a step.
POOL, ROUNDS, NEIGHBOURS, FIRST, LAST = 1024, 28, 20, 0.4, 2e-4
#: Coded values of a law without ends stop here: all but a thousandth of it.
OPEN_END = 0.999


@dataclass(frozen=True, eq=False)
class Choice:
    """The points that may be chosen: free parameters vary, the others are held.

    held    coded point (d,); its free values do not count
    clouds  of training points, among which the points must lie
    """

    space: Space
    free: tuple[int, ...]
    held: Array
    clouds: tuple[Cloud, ...] = ()

    @cached_property
    def ends(self) -> Array:
        """Largest coded value of each parameter, (d,)."""
        return np.array([1.0 if p.bounded else OPEN_END for p in self.space.parameters])

    def allowed(self, coded: Array) -> tuple[Array, NDArray[np.bool_]]:
        """Points (m, d) brought to allowed values, and which of them may be chosen."""
        coded = self.space.snap(np.clip(coded, -self.ends, self.ends))
        inside = np.ones(len(coded), dtype=bool)
        if self.space.region is not None:
            coded, inside = self.space.region.moved(coded, self.free)
            inside &= self.space.contains(coded)
        for cloud in self.clouds:
            inside &= ~cloud.leaves_out(coded)
        return coded, inside

    def pool(self, size: int, seed: int) -> Array:
        """Points that fill what may be chosen, (m, d) with m up to `size`.

        Raises `StudyError` where constraints leave nothing for the held values.
        """
        found, rng = np.empty((0, self.space.size)), np.random.default_rng(seed)
        for attempt in range(8):
            u = qmc.Sobol(len(self.free), seed=seed + attempt).random(size)
            coded = np.tile(self.held, (size, 1))
            coded[:, list(self.free)] = self._spread(np.asarray(u))
            coded, inside = self.allowed(coded)
            found = np.concatenate([found, coded[inside]])[:size]
            if len(found) >= size // 4:
                return np.unique(found, axis=0)
        if self.space.region is not None and len(self.free) == self.space.size:
            found = np.concatenate([found, self.space.region.sample(size // 4, rng)])
        if not len(found):
            raise StudyError(
                "no values of the free inputs keep the constraints of the study, or lie among the "
                "rows of its table, at the values that are held; hold other values, or free more "
                "inputs"
            )
        return np.unique(found, axis=0)

    def _spread(self, u: Array) -> Array:
        """Coded values of the free parameters, evenly over their ranges or levels."""
        columns = []
        for k, j in enumerate(self.free):
            parameter = self.space.parameters[j]
            steps = parameter.coded_levels if parameter.categorical else parameter.allowed
            if steps is None:
                columns.append((2.0 * u[:, k] - 1.0) * self.ends[j])
            else:
                columns.append(
                    steps[np.minimum((u[:, k] * len(steps)).astype(int), len(steps) - 1)]
                )
        return np.column_stack(columns)

    def neighbours(self, coded: Array, size: float, rng: np.random.Generator) -> Array:
        """A random neighbour of each point (m, d): some free parameters take a step."""
        moved, free = coded.copy(), list(self.free)
        takes = rng.random((len(coded), len(free))) < max(0.5, 2.0 / len(free))
        takes[np.arange(len(coded)), rng.integers(len(free), size=len(coded))] = True
        for k, j in enumerate(free):
            parameter, rows = self.space.parameters[j], np.flatnonzero(takes[:, k])
            if parameter.categorical:
                moved[rows, j] = rng.choice(parameter.coded_levels, size=len(rows))
                continue
            step = size * rng.standard_normal(len(rows))
            if parameter.allowed is not None:  # at least to the next value, either way
                least = np.diff(parameter.allowed).min()
                step = np.where(np.abs(step) < least, np.copysign(least, step), step)
            moved[rows, j] += step
        return moved


def search(choice: Choice, judge: Judge, starts: Array, *, seed: int) -> Array:
    """Each start (k, d) after the search for a better point near it, (k, d).

    judge  gives the merit of points; those that may not be chosen are not shown to it
    """
    rng, best = np.random.default_rng(seed), starts.copy()
    merit = judge(best, np.arange(len(best)))
    for size in np.geomspace(FIRST, LAST, ROUNDS):
        owner = np.repeat(np.arange(len(best)), NEIGHBOURS)
        moved, inside = choice.allowed(choice.neighbours(best[owner], size, rng))
        moved, owner = moved[inside], owner[inside]
        if not len(moved):
            continue
        found = judge(moved, owner)
        order = np.lexsort((found, owner))
        last = np.flatnonzero(np.append(np.diff(owner[order]) > 0, True))
        top = order[last]  # the best neighbour of each start
        better = top[found[top] > merit[owner[top]]]
        best[owner[better]], merit[owner[better]] = moved[better], found[better]
    return best


def apart(
    coded: Array, merit: Array, count: int, distance: float, *, least: float = 0.0
) -> NDArray[np.intp]:
    """Rows of the best points (m, d) that lie apart from each other, the best first.

    distance: Euclidean, in coded values; halved while there are fewer than `count`, down to
    `least`, so that there may be fewer.
    """
    order, chosen = np.argsort(-merit, kind="stable"), np.empty(0, dtype=np.intp)
    while True:
        for row in order:
            gaps = np.linalg.norm(coded[chosen] - coded[row], axis=1)
            if len(chosen) < count and (not len(chosen) or gaps.min() > distance):
                chosen = np.append(chosen, row)
        distance /= 2.0
        if len(chosen) >= min(count, len(coded)) or distance < max(least, 1e-9):
            return chosen
