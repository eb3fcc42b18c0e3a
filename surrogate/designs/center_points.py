"""Centre points: the middle of every range, to see curvature and pure error.

A categorical parameter has no middle, so centre points are taken at each
combination of the levels of the categorical parameters (pseudo-centre points).
An integer or listed value rests at the allowed value nearest to the middle.
"""

from __future__ import annotations

import itertools

import numpy as np
from numpy.typing import ArrayLike

from surrogate.designs.requirements import uncut, whole
from surrogate.space.space import Space


def center_points(
    space: Space, coded: ArrayLike, *, runs: int = 1, seed: int | None = None
) -> np.ndarray:
    """Rows to add to the design `coded`: `runs` centre points; shape (run, parameter).

    With categorical parameters, `runs` at each combination of their levels. The middle
    of an unbounded parameter is its median.
    """
    return uncut(space, centers(space, whole("runs", runs, 1)), "center_points")


def centers(space: Space, runs: int) -> np.ndarray:
    """`runs` centre points for each combination of categorical levels, (run, parameter)."""
    choices = [p.coded_levels if p.categorical else p.snap([0.0]) for p in space.parameters]
    combinations = np.array(list(itertools.product(*choices)), dtype=float)
    return np.repeat(combinations, whole("center_points", runs, 0), axis=0)
