"""PAWN: how much a parameter moves the whole distribution of the output, by SALib."""

from __future__ import annotations

from functools import partial

import xarray as xr
from SALib.analyze import pawn as analysis

from surrogate.estimator import Array
from surrogate.sensitivity.independence import needs_independent
from surrogate.sensitivity.model import Analysed, Seed, model, require_at_least
from surrogate.sensitivity.table import Q2_NEEDED
from surrogate.sensitivity.unit_cube import Measures, Method, even, measured, problem
from surrogate.space.space import Space


@needs_independent
def pawn(
    fit: Analysed,
    space: Space,
    *,
    seed: Seed = 0,
    confidence: float = 0.95,
    samples: int = 2**12,
    slices: int = 16,
    replicates: int = 8,
    draws: int = 20,
    q2: float | None = None,
    q2_needed: float = Q2_NEEDED,
) -> xr.Dataset:
    """`median`, `mean` and `maximum` over slices of a parameter's range, for one output.

    In each slice the Kolmogorov-Smirnov distance between the output's distribution there and
    its whole distribution (Pianosi and Wagener 2018, doi 10.1016/j.envsoft.2018.07.019). A
    parameter without effect has a small value, not 0: a slice holds samples / slices points.
    """
    require_at_least(2, slices=slices)
    require_at_least(8 * slices, samples=samples)
    cube = problem(space)

    def analyse(u: Array, values: Array, seed: int) -> Measures:
        found: Measures = analysis.analyze(cube, u, values, S=slices)
        return found

    method = Method(
        "pawn",
        partial(even, space, samples),
        analyse,
        {name: (0.0, 1.0) for name in ("median", "mean", "maximum")},
    )
    return measured(
        model(fit, space, q2=q2),
        method,
        seed=seed,
        confidence=confidence,
        replicates=replicates,
        draws=draws,
        q2_needed=q2_needed,
        slices=slices,
    )
