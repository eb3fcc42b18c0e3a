"""Halton sequence: radical inverses in the first primes; it grows without losing runs.

Halton 1960, digits permuted after Owen 2017 (scipy.stats.qmc.Halton). Good up to about ten
parameters; sobol beyond.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.stats import qmc

from surrogate.designs.different import different
from surrogate.designs.requirements import affordable, whole
from surrogate.designs.sobol import EDGE
from surrogate.space.space import Space


def halton(space: Space, *, runs: int, seed: int | None = None) -> NDArray[np.float64]:
    """`runs` scrambled points, coded (run, parameter), by the joint law of the space.

    With the same seed, the points of a smaller design are the first of a larger one. Where all
    parameters are integers, listed values or levels, points that stood before are left out.
    """
    runs = whole("runs", runs, 1)
    affordable(runs, "halton", "lower runs")
    engine = qmc.Halton(space.size, scramble=True, seed=np.random.default_rng(seed))
    return different(
        space, lambda n: space.quantile(np.clip(engine.random(n), EDGE, 1.0 - EDGE)), runs
    )
