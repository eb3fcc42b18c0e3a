"""Fold-over: a second half with signs reversed, to break aliases.

Reversing every sign separates all main effects from two-factor interactions (Box and
Wilson 1951); reversing one parameter's separates that one and all its interactions.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from surrogate.errors import DesignError, nearest
from surrogate.space.space import Space


def fold_over(
    space: Space, coded: ArrayLike, *, parameter: str | None = None, seed: int | None = None
) -> np.ndarray:
    """Rows to add: the rows of `coded` with the sign of `parameter` (default: all) reversed.

    coded: (run, parameter). Rows that the design holds already, such as centre points,
    are left out. Raises `DesignError` when nothing is left to add.
    """
    coded = np.atleast_2d(np.asarray(coded, dtype=float))
    folded = space.snap(np.where(_reversed_columns(space, parameter), -coded, coded))
    seen = {row.tobytes() for row in _rounded(coded)}
    new = np.array([row.tobytes() not in seen for row in _rounded(folded)], dtype=bool)
    if not new.any():
        raise DesignError(
            "fold_over adds nothing: the design holds every mirrored run already; "
            "remove fold_over, or fold another parameter"
        )
    added: np.ndarray = folded[new]
    return added


def _reversed_columns(space: Space, parameter: str | None) -> np.ndarray:
    """Which columns change sign, shape (parameter,)."""
    if parameter is not None and parameter not in space.names:
        raise DesignError(f"parameter: '{parameter}' is unknown; {nearest(parameter, space.names)}")
    chosen = np.array([parameter in (None, name) for name in space.names])
    for p, reverse in zip(space.parameters, chosen, strict=True):
        if reverse and len(p.levels) > 2:
            raise DesignError(
                f"{p.name}: fold_over reverses signs, which means nothing for "
                f"{len(p.levels)} levels; fold one of the other parameters"
            )
    return chosen


def _rounded(rows: np.ndarray) -> np.ndarray:
    """Rows for comparison: rounding and the sign of zero do not tell two runs apart."""
    return np.round(rows, 12) + 0.0
