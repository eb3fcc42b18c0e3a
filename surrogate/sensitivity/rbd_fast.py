"""RBD-FAST: first-order indices from the frequencies of a reordered sample, by SALib."""

from __future__ import annotations

from functools import partial

import numpy as np
import xarray as xr
from SALib.analyze import rbd_fast as analysis

from surrogate.estimator import Array
from surrogate.sensitivity.independence import needs_independent
from surrogate.sensitivity.model import Analysed, Seed, model, require_at_least
from surrogate.sensitivity.table import Q2_NEEDED
from surrogate.sensitivity.unit_cube import Measures, Method, even, measured, problem
from surrogate.space.space import Space


@needs_independent
def rbd_fast(
    fit: Analysed,
    space: Space,
    *,
    seed: Seed = 0,
    confidence: float = 0.95,
    samples: int = 2**11,
    harmonics: int = 10,
    replicates: int = 8,
    draws: int = 20,
    q2: float | None = None,
    q2_needed: float = Q2_NEEDED,
) -> xr.Dataset:
    """`first_order_rbd` of one output: all first-order indices from one sample.

    harmonics  frequencies that count, the first so many

    The runs are put in the order of a parameter, and the share of the first harmonics
    in the spectrum of the outputs is its index (Tarantola, Gatelli and Mara 2006,
    doi 10.1016/j.ress.2005.06.003; bias corrected as by Tissot and Prieur 2012,
    doi 10.1016/j.ress.2012.06.010).
    """
    require_at_least(1, harmonics=harmonics)
    require_at_least(8 * harmonics, samples=samples)
    cube = problem(space)

    def analyse(u: Array, values: Array, seed: int) -> Measures:
        # Intervals come from replicates, so SALib's bootstrap is kept as short as it goes.
        found = analysis.analyze(cube, u, values, M=harmonics, num_resamples=2, seed=seed)
        return {"first_order_rbd": np.asarray(found["S1"])}

    method = Method(
        "rbd_fast", partial(even, space, samples), analyse, {"first_order_rbd": (0.0, 1.0)}
    )
    return measured(
        model(fit, space, q2=q2),
        method,
        seed=seed,
        confidence=confidence,
        replicates=replicates,
        draws=draws,
        q2_needed=q2_needed,
    )
