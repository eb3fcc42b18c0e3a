"""Halton sequence: radical inverses in the first primes; it grows without losing runs.

Halton 1960, digits permuted after Owen 2017 (scipy.stats.qmc.Halton). Good up to about ten
parameters; sobol beyond.
"""

from __future__ import annotations

import numpy as np
from scipy.stats import qmc

from surrogate.designs.requirements import affordable, whole
from surrogate.designs.sobol import EDGE
from surrogate.space.space import Space


def halton(space: Space, *, runs: int, seed: int | None = None) -> np.ndarray:
    """`runs` scrambled points, coded (run, parameter), by the joint law of the space.

    With the same seed, the points of a smaller design are the first of a larger one.
    """
    runs = whole("runs", runs, 1)
    affordable(runs, "halton", "lower runs")
    engine = qmc.Halton(space.size, scramble=True, seed=np.random.default_rng(seed))
    return space.quantile(np.clip(engine.random(runs), EDGE, 1.0 - EDGE))
