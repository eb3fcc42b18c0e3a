"""Derivative-based global sensitivity measures of Sobol' and Kucherenko 2009, by SALib."""

from __future__ import annotations

import numpy as np
import xarray as xr
from SALib.analyze import dgsm as analysis

from surrogate.errors import StudyError
from surrogate.estimator import Array
from surrogate.sensitivity.independence import needs_independent
from surrogate.sensitivity.model import Analysed, Model, Seed, model, require_at_least, rests
from surrogate.sensitivity.table import Q2_NEEDED
from surrogate.sensitivity.unit_cube import Measures, Method, even, measured, problem
from surrogate.space.space import Space

#: Step of the finite differences, in probability.
STEP = 1e-5


@needs_independent
def dgsm(
    fit: Analysed,
    space: Space,
    *,
    seed: Seed = 0,
    confidence: float = 0.95,
    samples: int = 512,
    replicates: int = 8,
    draws: int = 20,
    q2: float | None = None,
    q2_needed: float = Q2_NEEDED,
) -> xr.Dataset:
    """`nu` = E[(df/du)^2] and `total_bound` = nu / (pi^2 Var f) of one output.

    u is a parameter's probability, so nu is in the square of the output's unit, over the
    parameter's whole range. The total index is at most `total_bound`: Poincare's inequality
    for the uniform law (doi 10.1016/j.matcom.2009.01.023). Raises `StudyError` for
    categorical and discrete parameters and for surrogates with steps, which have no derivative.
    """
    one = model(fit, space, q2=q2)
    require_at_least(8, samples=samples)
    _require_derivatives(one)
    cube = problem(space)

    def sample(seed: int) -> Array:
        return _star(even(space, samples, seed), STEP).reshape(-1, space.size)

    def analyse(u: Array, values: Array, seed: int) -> Measures:
        # Intervals come from replicates, so SALib's bootstrap is kept as short as it goes.
        found = analysis.analyze(cube, u, values, num_resamples=2)
        return {"nu": found["vi"], "total_bound": found["dgsm"]}

    method = Method("dgsm", sample, analyse, {"nu": (0.0, np.inf), "total_bound": (0.0, np.inf)})
    return measured(
        one,
        method,
        seed=seed,
        confidence=confidence,
        replicates=replicates,
        draws=draws,
        q2_needed=q2_needed,
    )


def _star(u: Array, step: float) -> Array:
    """Each point (d,) followed by the d points a step away, inwards; shape (run, d + 1, d)."""
    d = u.shape[1]
    star = np.repeat(u[:, None], d + 1, axis=1)
    for j in range(d):
        star[:, j + 1, j] += np.where(u[:, j] < 0.5, step, -step)
    return star


def _require_derivatives(one: Model) -> None:
    """Refuse levels and steps: there the slope over a step does not settle as it shrinks."""
    for parameter in one.space.parameters:
        if not parameter.continuous:
            kind = "categorical" if parameter.categorical else f"discrete ({parameter.law})"
            raise StudyError(
                f"sensitivity method dgsm needs derivatives, and {parameter.name} "
                f"is {kind}; use method sobol or shapley"
            )
    u = even(one.space, 256, 0)
    slopes = []
    for step in (STEP, 100.0 * STEP):
        star = _star(u, step)
        values = one.predict(one.space.quantile(star.reshape(-1, one.space.size)))
        if rests(values):
            return
        values = np.asarray(values).reshape(*star.shape[:2], -1)
        slopes.append(np.abs(values[:, 1:] - values[:, :1]).sum() / step)
    if not 0.5 * slopes[1] <= slopes[0] <= 2.0 * slopes[1]:
        raise StudyError(
            f"surrogate {one.surrogate} has no derivative (its slope over a step does "
            "not settle as the step shrinks, as of a forest); use method sobol, or "
            "a smooth surrogate"
        )
