"""Which level of fidelity to run next, and where: variance removed for a second of solver time.

Le Gratiet and Cannamela 2015, Cokriging-based sequential design strategies using fast
cross-validation techniques for multi-fidelity computer codes, Technometrics 57(3), section 3.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from surrogate.regressors.cokriging import CoKriging


def choose(model: CoKriging, candidates: ArrayLike, seconds: Sequence[float]) -> tuple[int, int]:
    """Number of the best candidate and of the level to run there, the cheapest being 0.

    candidates  coded points (m, d)
    seconds     of a run of each level, cheapest first

    The point is where the truth's variance is largest. A run of a level comes with those of all
    cheaper ones at the point, which keeps designs nested. Each removes what its level adds to
    the variance there, in a region of the size of its lengths.
    """
    if len(seconds) != len(model.levels_) or not all(one > 0.0 for one in seconds):
        raise ValueError(f"seconds {list(seconds)}: give one above 0 for each level")
    parts = model.variance_of_levels(candidates)
    point = int(parts.sum(axis=1).argmax())
    removed = np.cumsum(parts[point] * _regions(model))
    return point, int((removed / np.cumsum(seconds)).argmax())


def _regions(model: CoKriging) -> NDArray[np.float64]:
    """Share of the cube in which a run of each level tells something, (levels,)."""
    shares = [
        np.prod(np.minimum(level.lengths_, 2.0)[level.mask > 0.0] / 2.0) for level in model.levels_
    ]
    return np.array(shares, dtype=float)
