"""What constraints leave of the box of the parameters.

Points of the region follow the law of the parameters restricted to it: draws of that law of
which those outside are rejected. Where too few are kept, points walk from those found:
hit-and-run in the probabilities of the parameters (Smith 1984), a step along a random line
drawn anew, ever nearer, until it is inside (Neal 2003, "Slice sampling", section 5).
"""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from surrogate.errors import StudyError
from surrogate.space.constraints import Relation
from surrogate.space.equalities import Equalities, equalities
from surrogate.space.parameter import Parameter

Numbers = NDArray[np.float64]
Truth = NDArray[np.bool_]
#: Uniform numbers (run, parameter) -> coded points by the law of the box.
Quantile = Callable[[Numbers], Numbers]
#: Uniform numbers of some points, and the rows that they stand for -> which are inside.
Inside = Callable[[Numbers, NDArray[np.intp]], Truth]

#: A region with a smaller share of the box than this is a mistake.
SMALLEST = 1e-6
#: Points tried to find the region, at first and at most; points at once; starts of walks.
FIRST, TRIED, BATCH, STARTS = 2**14, 2**22, 2**17, 1024
#: With a smaller share than this points walk. Steps of a walk for each parameter.
WALKED, STEPS = 2e-3, 15
#: Share of its range by which a printed value may miss an equality.
PRINTED = 2e-3
#: Tries to stay inside on one line before a walk keeps its place.
SHRINKS = 40


@dataclass(frozen=True, eq=False)
class Region:
    """Constraints between parameters; `fixed` are the constants in them."""

    parameters: tuple[Parameter, ...]
    constraints: tuple[Relation, ...]
    fixed: dict[str, float]
    quantile: Quantile

    @cached_property
    def equalities(self) -> Equalities | None:
        """The linear equalities among them."""
        return equalities(self.constraints, self.parameters, self.fixed)

    @property
    def dependent(self) -> tuple[int, ...]:
        """Numbers of the parameters that follow from the others by equalities."""
        return self.equalities.dependent if self.equalities else ()

    def keeps(self, one: Relation, coded: Numbers) -> Truth:
        """Where coded points (run, parameter) keep one constraint, (run,)."""
        columns = {
            p.name: p.decode(coded[:, j])
            for j, p in enumerate(self.parameters)
            if p.name in one.names
        }
        constants = {
            name: np.full(len(coded), self.fixed[name]) for name in one.names if name in self.fixed
        }
        return one.holds({**columns, **constants})

    def holds(self, coded: Numbers) -> Truth:
        """Where coded points (run, parameter) keep all constraints, (run,)."""
        kept = np.ones(len(coded), dtype=bool)
        for one in self.constraints:
            kept &= self.keeps(one, coded)
        return kept

    def broken(self, coded: Numbers) -> list[tuple[str, Truth]]:
        """Each constraint that some coded points (run, parameter) break, and which ones do."""
        found = ((one.text, ~self.keeps(one, coded)) for one in self.constraints)
        return [(text, where) for text, where in found if where.any()]

    def moved(self, coded: Numbers, inside: Collection[int] | None = None) -> tuple[Numbers, Truth]:
        """Points with dependent parameters (among `inside`) solved for, and which are inside."""
        if self.equalities:
            coded = self.equalities.solve(coded, inside)
        kept: Truth = np.asarray((np.abs(coded) <= 1.0).all(axis=1))
        kept[kept] = self.holds(coded[kept])
        return coded, kept

    def completed(self, coded: Numbers) -> Numbers:
        """Points of printed digits with their equalities made exact, (run, parameter).

        A dependent parameter moves by at most `PRINTED` of its range: 0.333 three times is 1.
        """
        if not self.equalities:
            return coded
        solved = self.equalities.solve(coded)
        near = (np.abs(solved - coded).max(axis=1) <= 2.0 * PRINTED) & (
            np.abs(solved).max(axis=1) <= 1.0 + 2.0 * PRINTED
        )
        return np.where(near[:, None], np.clip(solved, -1.0, 1.0), coded)

    def points(self, u: Numbers) -> tuple[Numbers, Truth]:
        """Coded points of uniform numbers (run, parameter), and which of them are inside."""
        return self.moved(self.quantile(u))

    @cached_property
    def found(self) -> tuple[float, Numbers]:
        """Share of the box that is left, and uniform numbers of some points of it.

        Raises `StudyError` when there is next to nothing, with the constraint to blame.
        """
        rng, tried, kept = np.random.default_rng(0), 0, [np.empty((0, len(self.parameters)))]
        while tried < TRIED and (tried < FIRST or sum(map(len, kept)) < STARTS // 8):
            u = rng.random((FIRST if not tried else BATCH, len(self.parameters)))
            kept.append(u[self.points(u)[1]])
            tried += len(u)
        inside = np.concatenate(kept)
        if len(inside) < max(1.0, 0.5 * SMALLEST * tried):
            raise StudyError(self._blame())
        return len(inside) / tried, inside[:STARTS]

    def _blame(self) -> str:
        rng = np.random.default_rng(1)
        coded = self.quantile(rng.random((BATCH, len(self.parameters))))
        if self.equalities:
            coded = self.equalities.solve(coded)
        kept = (np.abs(coded) <= 1.0).all(axis=1)
        first = [one for one in self.constraints if one.is_equality]
        for one in [*first, *(one for one in self.constraints if one not in first)]:
            kept &= self.keeps(one, coded)
            if not kept.any():
                break
        others = ", the other constraints kept" if len(self.constraints) > 1 else ""
        return (
            f"constraint '{one.text}' leaves nothing of the ranges of the parameters (less than "
            f"{SMALLEST:g} of the box{others}); check its numbers and units, or widen a range"
        )

    def sample(self, runs: int, rng: np.random.Generator) -> Numbers:
        """Random coded points (run, parameter) of the law that is left."""
        share, inside = self.found
        if share < WALKED:
            starts = inside[rng.integers(len(inside), size=runs)]
            return self.points(self.walk(starts, rng))[0]
        parts, left = [], runs
        while left > 0:
            u = rng.random((min(BATCH, int(1.3 * left / share) + 16), len(self.parameters)))
            coded, kept = self.points(u)
            parts.append(coded[kept][:left])
            left -= len(parts[-1])
        return np.concatenate(parts)

    def walk(self, u: Numbers, rng: np.random.Generator) -> Numbers:
        """Uniform numbers of points inside after enough steps from those at `u`."""
        for _ in range(STEPS * u.shape[1]):
            u = step(u, lambda moved, rows: self.points(moved)[1], rng)
        return u


def step(u: Numbers, inside: Inside, rng: np.random.Generator) -> Numbers:
    """Points of the unit cube (run, d) after one step of hit-and-run within a region.

    The uniform law on the region stays what it is, whatever its shape.
    """
    direction = rng.standard_normal(u.shape)
    with np.errstate(divide="ignore"):
        ends = np.stack([-u / direction, (1.0 - u) / direction])
    low, high = ends.min(axis=0).max(axis=1), ends.max(axis=0).min(axis=1)
    found, left = u.copy(), np.arange(len(u))
    for _ in range(SHRINKS):
        t = low[left] + (high[left] - low[left]) * rng.random(len(left))
        tried = np.clip(u[left] + t[:, None] * direction[left], 1e-12, 1.0 - 1e-12)
        kept = inside(tried, left)
        found[left[kept]] = tried[kept]
        below = left[~kept & (t < 0.0)]
        above = left[~kept & (t >= 0.0)]
        low[below], high[above] = t[~kept & (t < 0.0)], t[~kept & (t >= 0.0)]
        left = left[~kept]
        if not len(left):
            break
    return found
