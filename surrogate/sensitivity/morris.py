"""Elementary effects of Morris 1991, by SALib, for many parameters and few evaluations."""

from __future__ import annotations

import numpy as np
import xarray as xr
from SALib.analyze import morris as analysis
from SALib.sample import morris as sampling

from surrogate.errors import StudyError
from surrogate.estimator import Array
from surrogate.sensitivity.independence import needs_independent
from surrogate.sensitivity.model import Analysed, Seed, model, require_at_least
from surrogate.sensitivity.table import Q2_NEEDED
from surrogate.sensitivity.unit_cube import Measures, Method, measured, problem
from surrogate.space.space import Space


@needs_independent
def morris(
    fit: Analysed,
    space: Space,
    *,
    seed: Seed = 0,
    confidence: float = 0.95,
    trajectories: int = 64,
    levels: int = 8,
    replicates: int = 8,
    draws: int = 20,
    q2: float | None = None,
    q2_needed: float = Q2_NEEDED,
) -> xr.Dataset:
    """`mu_star`, `mu`, `sigma` of one output: mean size, mean, spread of elementary effects.

    An elementary effect is the change of the output over the change of one parameter's
    probability, others fixed: in the output's unit, over the parameter's whole range. mu_star
    (Campolongo, Cariboni and Saltelli 2007, doi 10.1016/j.envsoft.2006.10.004) ranks; a large
    sigma tells of curvature or interaction.
    """
    require_at_least(2, trajectories=trajectories, levels=levels)
    if levels % 2:
        raise StudyError(
            f"levels: {levels} must be even, so that all levels are equally likely; "
            f"take {levels + 1}"
        )
    cube = problem(space)

    def sample(seed: int) -> Array:
        u: Array = sampling.sample(cube, trajectories, num_levels=levels, seed=seed)
        return u

    def analyse(u: Array, values: Array, seed: int) -> Measures:
        # Intervals come from replicates, so SALib's bootstrap is kept as short as it goes.
        found: Measures = analysis.analyze(
            cube, u, values, num_resamples=2, num_levels=levels, seed=seed
        )
        return found

    method = Method(
        "morris",
        sample,
        analyse,
        {"mu_star": (0.0, np.inf), "mu": (-np.inf, np.inf), "sigma": (0.0, np.inf)},
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
