"""Full factorial: every combination of levels."""

from __future__ import annotations

import math

import numpy as np
import pyDOE3

from surrogate.designs.center_points import centers
from surrogate.designs.levels import counts_of, grid
from surrogate.designs.requirements import affordable, bounded, uncut
from surrogate.space.space import Space


def full_factorial(
    space: Space,
    *,
    levels: int | dict[str, int] = 2,
    center_points: int = 0,
    seed: int | None = None,
) -> np.ndarray:
    """Every combination of evenly spaced levels, the first parameter changing fastest.

    levels: number of levels of each parameter, or of the named ones (the others get 2);
    a categorical parameter always takes all of its own. Levels of integers and listed values
    are allowed values, evenly spaced in their order. Returns coded (run, parameter).
    """
    bounded(space, "full_factorial")
    counts = counts_of(space, levels)
    affordable(
        math.prod(counts),
        "full_factorial",
        "use fractional_factorial, d_optimal or latin_hypercube",
    )
    index = pyDOE3.fullfact(counts).astype(int)
    grids = [grid(p, count) for p, count in zip(space.parameters, counts, strict=True)]
    coded = np.column_stack([values[index[:, j]] for j, values in enumerate(grids)])
    coded = np.vstack([coded, centers(space, center_points)])
    return uncut(space, coded, "full_factorial")
