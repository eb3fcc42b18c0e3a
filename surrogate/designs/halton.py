"""Halton sequence: radical inverses in the first primes; it grows without losing runs.

Halton 1960, digits permuted after Owen 2017 (scipy.stats.qmc.Halton). Good up to about ten
parameters; sobol beyond.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.stats import qmc

from surrogate.designs.different import different, feasible
from surrogate.designs.requirements import affordable, whole
from surrogate.designs.sobol import EDGE
from surrogate.space.space import Space


def halton(space: Space, *, runs: int, seed: int | None = None) -> NDArray[np.float64]:
    """`runs` scrambled points, coded (run, parameter), by the joint law of the space.

    With the same seed, the points of a smaller design are the first of a larger one. Where all
    parameters are integers, listed values or levels, points that stood before are left out;
    so are points that break a constraint.
    """
    runs = whole("runs", runs, 1)
    affordable(runs, "halton", "lower runs")
    engine = qmc.Halton(space.size, scramble=True, seed=np.random.default_rng(seed))

    def uniform(points: int) -> NDArray[np.float64]:
        return np.clip(engine.random(points), EDGE, 1.0 - EDGE)

    def draw(points: int) -> NDArray[np.float64]:
        if space.region is not None:
            return feasible(space, uniform, points, "halton")
        return space.quantile(uniform(points))

    return different(space, draw, runs)
