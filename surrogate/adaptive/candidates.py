"""Points among which the next one is chosen: allowed ones, away from all points so far.

They follow the law of the parameters, constraints kept; those near to the best are then added.
Failed runs are data: a candidate whose nearest point so far has failed is left out, so that
nothing is asked for there again, while runs beside it still draw the border.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from surrogate.regressors.columns import columns_of, expand
from surrogate.space.space import Space

Array = NDArray[np.float64]

#: Candidates at first.
COUNT = 1000
#: Candidates nearer than this to a point so far, in coded units, are that point.
APART = 1e-4
#: Farthest coded value of an unbounded parameter: the quantile of 0.99995.
FAR = 0.9999
#: Steps, in coded units, to the candidates near the best ones; how many best ones, how many each.
STEPS, LEADING, NEAR = (0.2, 0.05), 5, 40


def candidates(
    space: Space, coded: Array, failed: NDArray[np.bool_], *, seed: int, count: int = COUNT
) -> Array:
    """Allowed coded points (m, d) that are not among `coded` (n, d); none when all are done."""
    points = space.snap(space.sample(count, seed=seed))
    return allowed(space, np.unique(points, axis=0), coded, failed)


def around(space: Space, best: Array, step: float, *, seed: int) -> Array:
    """Allowed coded points (m, d) near to each of some (k, d); levels stay as they are."""
    rng = np.random.default_rng(seed)
    points = np.repeat(best, NEAR, axis=0)
    moves = [not p.categorical for p in space.parameters]
    points[:, moves] += step * rng.standard_normal((len(points), sum(moves)))
    ends = np.array([1.0 if p.bounded else FAR for p in space.parameters])
    points = space.snap(np.clip(points, -ends, ends))
    if space.region is not None:
        points, inside = space.region.moved(points)
        points = space.snap(points[inside])
    return points[space.contains(points)] if len(points) else points


def allowed(space: Space, points: Array, coded: Array, failed: NDArray[np.bool_]) -> Array:
    """Those points (m, d) that are apart from all points so far and not next to a failed one."""
    if not len(coded) or not len(points):
        return points
    distance, nearest = cKDTree(spread(space, coded)).query(spread(space, points))
    return np.asarray(points[(distance > APART) & ~failed[nearest]])


def spread(space: Space, coded: Array) -> Array:
    """Coded points in columns between which distances mean something, levels being apart."""
    return expand(coded, columns_of(space, space.size))


def farthest(space: Space, points: Array, coded: Array) -> int:
    """Number of the point that lies farthest from all points so far: space-filling."""
    if not len(coded):
        return 0
    distance, _ = cKDTree(spread(space, coded)).query(spread(space, points))
    return int(np.argmax(distance))
