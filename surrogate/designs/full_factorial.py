"""Full factorial: every combination of levels."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import pyDOE3
from numpy.typing import NDArray

from surrogate.designs.center_points import centers
from surrogate.designs.requirements import affordable, bounded, uncut, whole
from surrogate.errors import DesignError, nearest
from surrogate.space.space import Parameter, Space


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
    counts = _counts(space, levels)
    affordable(
        math.prod(counts),
        "full_factorial",
        "use fractional_factorial, d_optimal or latin_hypercube",
    )
    index = pyDOE3.fullfact(counts).astype(int)
    grids = [_grid(p, count) for p, count in zip(space.parameters, counts, strict=True)]
    coded = np.column_stack([grid[index[:, j]] for j, grid in enumerate(grids)])
    coded = np.vstack([coded, centers(space, center_points)])
    return uncut(space, coded, "full_factorial")


def _grid(parameter: Parameter, count: int) -> NDArray[np.float64]:
    """`count` coded levels of one parameter, from -1 to 1."""
    allowed = parameter.allowed
    if allowed is None:
        return np.linspace(-1.0, 1.0, count)
    chosen = np.rint(np.linspace(0, len(allowed) - 1, count)).astype(int)
    return np.asarray(allowed[chosen])


def _counts(space: Space, levels: Any) -> list[int]:
    named = (
        dict(levels)
        if isinstance(levels, Mapping)
        else dict.fromkeys((p.name for p in space.parameters if not p.categorical), levels)
    )
    unknown = [name for name in named if name not in space.names]
    if unknown:
        raise DesignError(
            f"levels: parameter '{unknown[0]}' is unknown; {nearest(unknown[0], space.names)}"
        )
    return [_count(p, named.get(p.name)) for p in space.parameters]


def _count(parameter: Parameter, wanted: Any) -> int:
    if not parameter.categorical:
        count = whole(f"levels of {parameter.name}", 2 if wanted is None else wanted, 2)
        allowed = parameter.allowed
        if allowed is not None and count > len(allowed):
            raise DesignError(
                f"levels of {parameter.name}: {count} are more than its {len(allowed)} allowed "
                f"values; give at most {len(allowed)}"
            )
        return count
    if wanted not in (None, len(parameter.levels)):
        raise DesignError(
            f"levels of {parameter.name}: {wanted!r} must be "
            f"{len(parameter.levels)}, the number of its named levels; leave it out"
        )
    return len(parameter.levels)
