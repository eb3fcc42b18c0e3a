"""Points of a sequence that differ, in a space where points can coincide."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from surrogate.space.space import Space

Coded = NDArray[np.float64]

#: The sequence is searched up to this many times the points asked for, and at least so far.
DRAWN, LEAST = 16, 4096


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
