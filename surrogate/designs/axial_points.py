"""Axial (star) points: one parameter at a time away from the centre.

They turn a two-level design into a central composite one, from which squares can be
estimated (Box and Wilson 1951).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from surrogate.designs.center_points import centers
from surrogate.designs.requirements import bounded, number, uncut
from surrogate.errors import DesignError
from surrogate.space.space import Space


def axial_points(
    space: Space, coded: ArrayLike, *, alpha: float = 1.0, seed: int | None = None
) -> np.ndarray:
    """Rows to add: each continuous parameter at -alpha and +alpha, the others at the centre.

    alpha: distance from the centre, in (0, 1]. With categorical parameters, a star for each
    combination of their levels. Raises `DesignError` for unbounded parameters at alpha = 1.
    """
    alpha = number("alpha", alpha, 1e-3, 1.0)
    if alpha == 1.0:
        bounded(space, "axial_points")
    return uncut(space, star(space, alpha), "axial_points")


def star(space: Space, alpha: float) -> np.ndarray:
    """2 d rows for each centre point, d continuous parameters; shape (run, parameter)."""
    columns = [j for j, p in enumerate(space.parameters) if not p.categorical]
    if not columns:
        raise DesignError("axial points need a parameter with a range; all of these have levels")
    rows = []
    for centre in centers(space, 1):
        for j in columns:
            for end in (-alpha, alpha):
                rows.append(np.where(np.arange(space.size) == j, end, centre))
    return space.snap(rows)
