"""Sliced Latin hypercubes: one as a whole, and one in each level of a categorical parameter.

Of n = m t points each of t slices has m. In every column the n ranks fall into m groups of t
neighbours, and each slice takes one rank of each group: so a slice has one point in each of m equal
parts of a parameter's law, and the whole one in each of n (Qian 2012, doi
10.1080/01621459.2011.644132). Points are moved apart by exchanges that keep this: two ranks of one
slice, or two neighbours of two slices (Ba, Myers and Brenneman 2015, Technometrics 57, 479). With
d^2 a squared distance of ranks in k columns the criterion is

    sum over pairs (d^2)^-16  +  sum over pairs in one slice (d^2 t^(-2 / k))^-16,

phi_p of Morris and Mitchell for the whole and for the slices, whose points lie t^(1 / k) times
farther apart.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from surrogate.errors import DesignError, nearest
from surrogate.space.space import Space

Ranks = NDArray[np.int64]
Floats = NDArray[np.float64]

#: Exchanges tried for each point, but with exchanges x points at most `LARGEST_WORK`; of them the
#: share between neighbours of two slices.
EXCHANGES, LARGEST_WORK, ACROSS = 100, 2e7, 0.3
POWER = 16


def slicing(space: Space, name: str, runs: int) -> int:
    """Number of the parameter whose levels are the slices; raises `DesignError`."""
    if name not in space.names or not space[name].categorical:
        levels = [p.name for p in space.parameters if p.categorical]
        known = (
            nearest(name, levels) if levels else "add one, such as side: {levels: [left, right]}"
        )
        raise DesignError(f"slices: '{name}' is no parameter with levels; {known}")
    count = len(space[name].levels)
    if runs % count or runs < 2 * count:
        raise DesignError(
            f"runs: {runs} do not divide into {count} slices of 2 or more equal numbers; take "
            f"{max(2, round(runs / count)) * count}"
        )
    if space.size < 2:
        raise DesignError("slices: at least one parameter must vary within them")
    if not space.independent:
        raise DesignError(
            "slices: a sliced Latin hypercube needs independent parameters; leave slices out"
        )
    return space.names.index(name)


def sliced_ranks(
    slices: int, each: int, columns: int, rng: np.random.Generator, effort: float = 1.0
) -> Ranks:
    """Ranks 0 .. n - 1 (slices * each, columns), slice after slice, far apart.

    effort: how many times the usual number of exchanges are tried
    """
    n = slices * each
    owner = np.argsort(rng.random((columns, each, slices)), axis=2)  # which slice has which rank
    groups = np.arange(n).reshape(each, slices)
    ranks = np.empty((slices, each, columns), dtype=np.int64)
    for j in range(columns):
        for k in range(slices):
            ranks[k, :, j] = rng.permutation(groups[owner[j] == k])
    design = _Design(ranks.reshape(n, columns), slices)
    for _ in range(round(effort * min(EXCHANGES * n, LARGEST_WORK / n))):
        design.exchange(rng)
    return design.ranks


class _Design:
    """Ranks (n, columns), slice after slice, and how much more a pair within a slice counts."""

    def __init__(self, ranks: Ranks, slices: int) -> None:
        self.ranks, self.slices, self.each = ranks, slices, len(ranks) // slices
        self.own = np.arange(len(ranks)) // self.each
        columns = ranks.shape[1]
        self.more = slices ** (2.0 * POWER / columns)
        self.scale = float(columns * len(ranks) ** 2) / len(ranks) ** (2.0 / columns)

    def exchange(self, rng: np.random.Generator) -> None:
        """Exchange two ranks of a random column when that lowers the criterion."""
        j = int(rng.integers(self.ranks.shape[1]))
        pair = self._across(j, rng) if rng.random() < ACROSS else self._within(rng)
        before = self._share(pair)
        self.ranks[pair, j] = self.ranks[pair[::-1], j]
        if self._share(pair) > before:
            self.ranks[pair, j] = self.ranks[pair[::-1], j]

    def _within(self, rng: np.random.Generator) -> NDArray[np.intp]:
        """Two points of one slice."""
        start = self.each * int(rng.integers(self.slices))
        return start + rng.choice(self.each, 2, replace=False)

    def _across(self, j: int, rng: np.random.Generator) -> NDArray[np.intp]:
        """Two points whose ranks in a column are of one group of neighbours."""
        group = int(rng.integers(self.each))
        points = np.flatnonzero(self.ranks[:, j] // self.slices == group)
        return np.asarray(rng.choice(points, 2, replace=False))

    def _share(self, pair: NDArray[np.intp]) -> float:
        """What two points add to the criterion, but for their own pair."""
        difference = self.ranks[pair][:, None, :] - self.ranks[None, :, :]
        squared = (difference**2).sum(axis=2).astype(float)
        squared[:, pair] = np.inf
        weights = 1.0 + self.more * (self.own[pair][:, None] == self.own)
        return float((weights * (self.scale / squared) ** POWER).sum())
