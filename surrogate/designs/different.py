"""Points of a sequence that differ, or that keep the constraints of the space."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from surrogate.errors import DesignError
from surrogate.space.space import Space

Coded = NDArray[np.float64]

#: The sequence is searched up to this many times the points asked for, and at least so far.
DRAWN, LEAST = 16, 4096
#: Points of a sequence that are tried for those that keep the constraints.
MOST = 2**22


def different(space: Space, draw: Callable[[int], Coded], runs: int) -> Coded:
    """The first `runs` points (run, parameter) of a sequence that differ from all before them.

    draw: gives the first n points of the sequence. Points can coincide only where every
    parameter is categorical or discrete. Where the sequence comes upon too few that differ,
    points that stood before follow in its order.
    """
    discrete = any(p.allowed is not None for p in space.parameters)
    if not discrete or any(p.continuous for p in space.parameters):
        return draw(runs)
    points = draw(max(DRAWN * runs, LEAST))
    new = np.zeros(len(points), dtype=bool)
    new[np.unique(points, axis=0, return_index=True)[1]] = True
    return np.concatenate([points[new], points[~new]])[:runs]


def feasible(space: Space, uniform: Callable[[int], Coded], runs: int, method: str) -> Coded:
    """The first `runs` points of a sequence that keep the constraints of the space.

    uniform: gives the next n uniform numbers (n, parameter) of the sequence. Raises
    `DesignError` when the region is too small for that.
    """
    assert space.region is not None
    parts: list[Coded] = []
    found, drawn, batch = 0, 0, 1 << max(runs - 1, 1).bit_length()
    while found < runs:
        if drawn >= MOST:
            raise DesignError(
                f"{method} finds {found} of {runs} points in its first {drawn:,}: constraints "
                "leave too little of the box; use latin_hypercube"
            )
        coded, kept = space.region.points(uniform(batch))
        parts.append(coded[kept])
        drawn, found = drawn + batch, found + int(kept.sum())
        batch = drawn
    return np.concatenate(parts)[:runs]
