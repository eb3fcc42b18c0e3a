"""Sobol' sequence: even coverage at every size, and it grows without losing runs.

Sobol' 1967, direction numbers of Joe and Kuo 2008, scrambled after Owen 1995 / Matousek 1998
(scipy.stats.qmc.Sobol). Sizes that are powers of two are the most even.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.stats import qmc

from surrogate.designs.different import different, feasible
from surrogate.designs.requirements import affordable, whole
from surrogate.space.space import Space

#: Keeps unbounded parameters away from probability 0 and 1.
EDGE = 2.0**-32


def sobol(space: Space, *, runs: int, seed: int | None = None) -> NDArray[np.float64]:
    """`runs` scrambled points, coded (run, parameter), by the joint law of the space.

    With the same seed, the points of a smaller design are the first of a larger one. Where all
    parameters are integers, listed values or levels, points that stood before are left out;
    so are points that break a constraint.
    """
    runs = whole("runs", runs, 1)
    affordable(runs, "sobol", "lower runs")
    generator = np.random.default_rng(seed)

    def draw(points: int) -> NDArray[np.float64]:
        engine = qmc.Sobol(space.size, scramble=True, seed=generator)
        if space.region is not None:
            return feasible(space, lambda n: _inside(engine.random(n)), points, "sobol")
        # Drawn to the next power of two: the engine warns about other sizes.
        u = engine.random_base2((points - 1).bit_length())[:points]
        return space.quantile(_inside(u))

    return different(space, draw, runs)


def _inside(u: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.clip(u, EDGE, 1.0 - EDGE)
