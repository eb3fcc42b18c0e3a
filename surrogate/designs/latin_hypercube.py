"""Latin hypercube: each parameter takes `runs` different values, one in each equal slice.

McKay, Beckman and Conover 1979. `maximin` moves the points as far apart as it can, by
exchanging values within a column (Morris and Mitchell 1995; Jin, Chen and Sudjianto 2005).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from surrogate.designs.design import searching
from surrogate.designs.maximin import LARGEST, maximin
from surrogate.designs.requirements import affordable, choice, number, whole
from surrogate.designs.scattered import scattered
from surrogate.designs.sliced import sliced_ranks, slicing
from surrogate.space.space import Space

CRITERIA = ("maximin", "random")


def checked(
    space: Space,
    *,
    runs: int,
    criterion: str = "maximin",
    effort: float = 1.0,
    slices: str | None = None,
    **_: object,
) -> int:
    """Number of points that these options of `latin_hypercube` give; raises `DesignError`."""
    runs = whole("runs", runs, 1)
    affordable(runs * space.size, "latin_hypercube", "lower runs, or use sobol")
    number("effort", effort, 0.01, 1e6)
    choice("criterion", criterion, CRITERIA)
    if slices is not None:
        slicing(space, slices, runs)
    return runs


@searching(checked, spread=True)
def latin_hypercube(
    space: Space,
    *,
    runs: int,
    criterion: str = "maximin",
    effort: float = 1.0,
    slices: str | None = None,
    seed: int | None = None,
) -> NDArray[np.float64]:
    """`runs` points, coded (run, parameter), by the law of each parameter.

    criterion  maximin: in the middle of the slices, as far apart as possible (beyond 10,000
               runs in random order); random: anywhere in the slices, in random order
    effort     how many times the usual number of exchanges maximin tries: 10 takes ten times
               as long and brings the points some per cent further apart
    slices     a parameter with levels: the points at each of them are a Latin hypercube of the
               other parameters too (sliced; Qian 2012), so that a model of each level is good
    Integers and listed values take what lies in the slices; maximin keeps the points apart as
    they are taken. Constraints leave no slices: maximin then spreads the points over what is
    left of the box, and random draws them from it. Correlated parameters keep their slices and
    take the rank correlation of the space.
    """
    runs = checked(space, runs=runs, criterion=criterion, effort=effort, slices=slices)
    rng = np.random.default_rng(seed)
    if slices is not None:
        return _sliced(space, slices, runs, criterion, effort, rng)
    if space.region is not None:
        return (
            scattered(space, runs, rng, effort)
            if criterion == "maximin" and runs <= LARGEST
            else space.sample(runs, seed=seed)
        )
    ranks = rng.permuted(np.tile(np.arange(runs)[:, None], space.size), axis=0)
    if criterion == "maximin":
        ranks, within = _apart(space, ranks, rng, effort), np.full(ranks.shape, 0.5)
    else:
        within = rng.random(ranks.shape)
    if not space.independent:
        ranks = _correlated(space, (ranks + within) / runs, ranks)
    u = (ranks + within) / runs
    return np.column_stack([p.quantile(u[:, j]) for j, p in enumerate(space.parameters)])


def _sliced(
    space: Space,
    name: str,
    runs: int,
    criterion: str,
    effort: float,
    rng: np.random.Generator,
) -> NDArray[np.float64]:
    """Coded points (run, parameter), the levels of the sliced parameter one after another."""
    own, levels = slicing(space, name, runs), space[name].coded_levels
    tried = effort if criterion == "maximin" else 0.0
    ranks = sliced_ranks(len(levels), runs // len(levels), space.size - 1, rng, tried)
    within = np.full(ranks.shape, 0.5) if tried else rng.random(ranks.shape)
    u = np.insert((ranks + within) / runs, own, 0.5, axis=1)
    coded = np.column_stack([p.quantile(u[:, j]) for j, p in enumerate(space.parameters)])
    coded[:, own] = np.repeat(levels, runs // len(levels))
    return coded


def _apart(
    space: Space, ranks: NDArray[np.int64], rng: np.random.Generator, effort: float
) -> NDArray[np.int64]:
    """Ranks of points that lie far apart once integers and listed values have been taken.

    Distances are then those of the middles of what falls on one value, and among points that
    agree in all of them those of the ranks: position = `base` x middle + rank.
    """
    if all(p.allowed is None for p in space.parameters):
        return maximin(ranks, rng, effort)
    runs = len(ranks)
    base = 2 * runs
    positions = np.arange(runs)
    taken = [p.quantile((positions + 0.5) / runs) for p in space.parameters]
    lifted = np.column_stack([base * _middles(column) + positions for column in taken])
    found = maximin(np.take_along_axis(lifted, ranks, axis=0), rng, effort)
    return found % base


def _middles(rising: NDArray[np.float64]) -> NDArray[np.int64]:
    """Twice the mean position of the equal values around each of `rising` (run,)."""
    first = np.searchsorted(rising, rising, side="left")
    last = np.searchsorted(rising, rising, side="right") - 1
    return (first + last).astype(np.int64)


def _correlated(space: Space, u: np.ndarray, ranks: np.ndarray) -> np.ndarray:
    """Ranks in the order that the space's copula gives to the points `u` (Iman, Conover 1982).

    The copula moves points out of their slices; ranking puts one back into each. Levels
    tie, so categorical columns are ordered by their own slices within a level.
    """
    joint = space.quantile(u)
    order = [np.lexsort((ranks[:, j], joint[:, j])) for j in range(space.size)]
    return np.argsort(np.column_stack(order), axis=0)
