"""Goal-oriented indices: which parameter sets a quantile of the output.

With the pinball loss psi_a(t) = t (a - [t < 0]), whose expectation is least at the quantile a,

    S_i = 1 - E[min_q E[psi_a(Y - q) | x_i]] / min_q E[psi_a(Y - q)]

is the share of the loss that knowing x_i saves (Fort, Klein and Rachdi 2016,
doi 10.1080/03610926.2013.867363). It is 0 for a parameter without effect and 1 for one that
alone determines the output. Slices of the parameter's range stand for its values.
"""

from __future__ import annotations

from functools import partial

import numpy as np
import xarray as xr

from surrogate.errors import StudyError
from surrogate.estimator import Array
from surrogate.sensitivity.independence import needs_independent
from surrogate.sensitivity.model import Analysed, Seed, model, require_at_least
from surrogate.sensitivity.table import Q2_NEEDED
from surrogate.sensitivity.unit_cube import Measures, Method, even, measured
from surrogate.space.space import Space

#: Points that a slice holds at least: the loss within is too small by about 1 / points.
POINTS = 50


@needs_independent
def quantile(
    fit: Analysed,
    space: Space,
    *,
    probability: float = 0.95,
    seed: Seed = 0,
    confidence: float = 0.95,
    samples: int = 2**13,
    slices: int = 32,
    replicates: int = 8,
    draws: int = 20,
    q2: float | None = None,
    q2_needed: float = Q2_NEEDED,
) -> xr.Dataset:
    """`quantile_share` of one output: share of the loss at its quantile that a parameter explains.

    probability: of the quantile, such as 0.95 for a large value that is rarely exceeded.
    """
    if not 0.0 < probability < 1.0:
        raise StudyError(f"probability: {probability:g} must lie between 0 and 1, such as 0.95")
    require_at_least(2, slices=slices)
    rare = min(probability, 1.0 - probability)
    require_at_least(int(np.ceil(slices * max(POINTS, 5.0 / rare))), samples=samples)

    def analyse(u: Array, values: Array, seed: int) -> Measures:
        whole = _loss(values[None], probability)
        within = [_loss(_sliced(column, values, slices), probability) for column in u.T]
        return {"quantile_share": 1.0 - np.array(within) / whole}

    return measured(
        model(fit, space, q2=q2),
        Method("quantile", partial(even, space, samples), analyse, {"quantile_share": (0.0, 1.0)}),
        seed=seed,
        confidence=confidence,
        replicates=replicates,
        draws=draws,
        q2_needed=q2_needed,
        probability=probability,
    )


def _sliced(column: Array, values: Array, slices: int) -> Array:
    """Values (slice, point) in the order of one parameter's probabilities, all equally many."""
    most = len(values) // slices * slices
    return np.asarray(values[np.argsort(column, kind="stable")][:most].reshape(slices, -1))


def _loss(values: Array, probability: float) -> float:
    """Mean pinball loss of values (slice, point) about the quantile of their slice."""
    away = values - np.quantile(values, probability, axis=1, keepdims=True)
    return float(np.mean(away * (probability - (away < 0.0))))
