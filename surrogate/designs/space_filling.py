"""Points that fill the gaps between those that are there."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from surrogate.designs.design import searching
from surrogate.designs.requirements import affordable, whole
from surrogate.designs.scattered import scattered
from surrogate.space.space import Space


def checked(space: Space, coded: ArrayLike, *, runs: int, **_: object) -> int:
    """Number of points that are added; raises `DesignError`."""
    affordable(whole("runs", runs, 1), "space_filling", "lower runs")
    return runs


@searching(checked, spread=True)
def space_filling(
    space: Space, coded: ArrayLike, *, runs: int, seed: int | None = None
) -> NDArray[np.float64]:
    """Rows to add: `runs` points, each far from the others and from all points of `coded`.

    For a design of any kind, stored runs of a table included. How they are found is in
    `surrogate.designs.scattered`.
    """
    checked(space, coded, runs=runs)
    there = np.atleast_2d(np.asarray(coded, dtype=float))
    return scattered(space, runs, np.random.default_rng(seed), kept=there)
