"""The Pareto front of several objectives: no one can be bettered without loss in another."""

from __future__ import annotations

from dataclasses import replace
from itertools import product
from math import comb

import numpy as np
from numpy.typing import NDArray

from surrogate.solving.merit import Merit
from surrogate.solving.search import Choice, apart, search

Array = NDArray[np.float64]

#: Points of a front at most, besides the best of each objective.
POINTS = 21
#: Starts for the best of one objective, and how far apart they lie.
STARTS, APART = 3, 0.2


def front(merit: Merit, choice: Choice, pool: Array, seed: int) -> Array:
    """Points of the front (k, d): each objective alone, then weighted distances from these."""
    size = len(merit.problem.objectives)
    alone = np.stack([_best_of(k, merit, choice, pool, seed) for k in range(size)])
    at_ends = merit.pushed(merit.judge(alone).objectives)
    span = np.maximum(np.ptp(at_ends, axis=0), 1e-9)
    aimed = replace(merit, ideal=at_ends.min(axis=0) - 1e-6 * span)
    weights = simplex(size, POINTS) / span
    every = np.concatenate([pool, alone])
    merits = [aimed.judge(every, np.tile(one, (len(every), 1))).merit for one in weights]
    starts = every[np.argmax(merits, axis=1)]
    found = search(choice, lambda X, who: aimed.judge(X, weights[who]).merit, starts, seed=seed)
    found = np.unique(np.concatenate([alone, found]), axis=0)
    judged = merit.judge(found)
    sure = judged.probability >= merit.problem.sure
    kept = found[sure] if sure.any() else found
    return kept[undominated(merit.pushed(merit.judge(kept).objectives))]


def _best_of(k: int, merit: Merit, choice: Choice, pool: Array, seed: int) -> Array:
    """The best point of one objective alone, (d,)."""
    goal = merit.problem.objectives[k]
    alone = replace(merit, problem=replace(merit.problem, goals=(goal,)))
    starts = pool[apart(pool, alone.judge(pool).merit, STARTS, APART)]
    ends = search(choice, lambda X, _: alone.judge(X).merit, starts, seed=seed)
    best: Array = ends[np.argmax(alone.judge(ends).merit)]
    return best


def simplex(size: int, count: int) -> Array:
    """At most `count` weights (k, size) that sum to 1, evenly over the simplex; none is zero."""
    parts = 1
    while comb(parts + size, size - 1) <= count:
        parts += 1
    grid = [w for w in product(range(parts + 1), repeat=size) if sum(w) == parts]
    return np.maximum(np.array(grid, dtype=float) / parts, 1e-3)


def undominated(costs: Array) -> NDArray[np.bool_]:
    """Which rows (m, objectives), each to be small, no other row beats in all of them."""
    at_least = np.all(costs[None, :, :] <= costs[:, None, :], axis=2)
    better = np.any(costs[None, :, :] < costs[:, None, :], axis=2)
    return np.asarray(~np.any(at_least & better, axis=1))
