"""Nested design: points of several levels of fidelity, each level's among the cheaper one's.

The truth has a maximin Latin hypercube, because its runs are few. A cheaper level has the
points of the more expensive one and the next points of a Sobol' sequence. So a study that asks
for more runs of a cheaper level keeps all runs that it has. (Le Gratiet and Garnier 2014,
section 3.3, begin with the truth too; Qian 2009, Nested Latin hypercube designs, needs numbers of
runs that divide each other.)
"""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from surrogate.designs.design import searching
from surrogate.designs.latin_hypercube import checked as checked_hypercube
from surrogate.designs.latin_hypercube import latin_hypercube
from surrogate.designs.requirements import whole
from surrogate.designs.sobol import sobol
from surrogate.errors import DesignError
from surrogate.space.space import Space


def checked(space: Space, *, runs: Mapping[str, int], effort: float = 1.0, **_: object) -> int:
    """Number of rows of `nested` with these options; raises `DesignError`."""
    counts = _counts(runs)
    checked_hypercube(space, runs=counts[-1], effort=effort)
    return sum(counts)


@searching(checked, spread=True)
def nested(
    space: Space, *, runs: Mapping[str, int], effort: float = 1.0, seed: int | None = None
) -> NDArray[np.float64]:
    """Coded points (row, parameter): all of the first level, then all of the second, ...

    runs    level -> number of its points, cheapest first, none smaller than the next
    effort  of the maximin Latin hypercube of the last level
    Every level's points are the last rows of the level before.
    """
    checked(space, runs=runs, effort=effort)
    counts = _counts(runs)
    truth = latin_hypercube(space, runs=counts[-1], effort=effort, seed=seed)
    more = counts[0] - counts[-1]
    fill = sobol(space, runs=more, seed=seed) if more else truth[:0]
    return np.vstack([np.vstack([fill[: count - len(truth)], truth]) for count in counts])


def _counts(runs: Mapping[str, int]) -> list[int]:
    """Number of points of each level; raises `DesignError` when they cannot be nested."""
    if not isinstance(runs, Mapping) or len(runs) < 2:
        raise DesignError(
            f"runs: {runs} must give a number of runs for each level, such as "
            "{cheap: 120, true: 15}"
        )
    counts = [whole(f"runs of {level}", count, 1) for level, count in runs.items()]
    wrong = [
        f"runs of {level}: {count} must be {following} or more, as {above} has; "
        f"the points of {above} are among those of {level}"
        for (level, count), (above, following) in pairwise(zip(runs, counts, strict=True))
        if count < following
    ]
    if wrong:
        raise DesignError(*wrong)
    return counts
