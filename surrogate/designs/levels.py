"""Levels of a factorial: how many each parameter has, and at which coded values."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from surrogate.designs.requirements import whole
from surrogate.errors import DesignError, nearest
from surrogate.space.space import Parameter, Space


def grid(parameter: Parameter, count: int) -> NDArray[np.float64]:
    """`count` coded levels of one parameter, from -1 to 1."""
    allowed = parameter.allowed
    if allowed is None:
        return np.linspace(-1.0, 1.0, count)
    chosen = np.rint(np.linspace(0, len(allowed) - 1, count)).astype(int)
    return np.asarray(allowed[chosen])


def counts_of(space: Space, levels: Any, default: int = 2) -> list[int]:
    """Number of levels of each parameter: of all, or of the named ones; the rest `default`.

    A categorical parameter has its own. Raises `DesignError`.
    """
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
    return [_count(p, named.get(p.name), default) for p in space.parameters]


def _count(parameter: Parameter, wanted: Any, default: int) -> int:
    if not parameter.categorical:
        count = whole(f"levels of {parameter.name}", default if wanted is None else wanted, 2)
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
