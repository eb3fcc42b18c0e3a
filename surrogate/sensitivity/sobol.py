"""Sobol' indices of a surrogate, with the sampling and the surrogate part of their error."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr

from surrogate.estimator import Array, has_indices
from surrogate.sensitivity.draws import JointMeasure, Measure, Values, spread
from surrogate.sensitivity.groups import Named, knows_groups, numbers
from surrogate.sensitivity.independence import needs_independent, require_independent
from surrogate.sensitivity.missed import largest
from surrogate.sensitivity.model import Analysed, Model, Seed, model
from surrogate.sensitivity.pick_freeze import INDICES, pick_freeze
from surrogate.sensitivity.table import Q2_NEEDED, Estimate, Variables, dataset
from surrogate.space.space import Space

SHARE = (0.0, 1.0)


@needs_independent
def sobol(
    fit: Analysed,
    space: Space,
    *,
    groups: Named | None = None,
    seed: Seed = 0,
    confidence: float = 0.95,
    samples: int = 2**14,
    scramblings: int = 8,
    draws: int = 100,
    exact: bool = True,
    q2: float | None = None,
    q2_needed: float = Q2_NEEDED,
) -> xr.Dataset:
    """First-order, total and second-order Sobol' indices of one output.

    fit          a `Fit`, or a function of coded points (then there is no surrogate part)
    groups       name -> parameters whose share is asked for as a whole
    samples      pairs of points, when there is no closed form; see `pick_freeze`
    draws        how many equally plausible surrogates show the surrogate's part; 0 for none
    exact        False to sample even where the estimator knows `sobol_indices()`
    q2           the surrogate's Q2 when known better than by the fit
    q2_needed    below this the dataset carries a refusal

    Returns the dataset of `sensitivity.nc`: each index with `_low`, `_high` (whole
    interval), `_sampling`, `_surrogate` (half-widths), and `total_worst`, the largest total
    index that the solver can have if everything the surrogate misses belongs to that
    parameter. With groups besides, over dimension `group`: `group_first_order`, the share that
    a group explains without the other parameters (its closed index), and `group_total`.
    Raises `StudyError` for correlated parameters and for groups that overlap.
    """
    require_independent(space, "sobol")
    one = model(fit, space, q2=q2)
    exact = exact and has_indices(one.estimator)
    measures = [Measure(space, closed=exact, seed=seed)]
    if grouped := numbers(space, groups):
        measures.append(Measure(space, grouped, exact and knows_groups(one.estimator), seed))
    values: list[Array] = []
    half: list[Array] = []
    for measure in measures:
        found = (
            _closed(one, measure)
            if measure.closed
            else _sampled(one, measure, confidence, samples, scramblings)
        )
        values += found[0]
        half += found[1]
    spreads = spread(
        one, JointMeasure(tuple(measures)), draws=draws, confidence=confidence, seed=seed
    )
    variables: Variables = {}
    for (name, dims), value, width, part in zip(_named(values), values, half, spreads, strict=True):
        estimate = Estimate(value, width, part.below, part.above)
        variables |= estimate.columns(name, dims, SHARE) if dims else {}
    variables["total_worst"] = (("output", "parameter"), [worst_case(values[1], one.q2)])
    return dataset(
        one,
        variables,
        method="sobol",
        confidence=confidence,
        q2_needed=q2_needed,
        groups=groups,
        computed="closed form" if exact else "sampling",
        surrogate_part=spreads[0].how,
    )


def _named(values: Sequence[Array]) -> list[tuple[str, tuple[str, ...]]]:
    """Name and dimensions of each index; no dimensions for what is not reported."""
    named = [
        ("first_order", ("parameter",)),
        ("total", ("parameter",)),
        ("second_order", ("parameter", "parameter_2")),
        ("group_first_order", ("group",)),
        ("group_total", ("group",)),
        ("", ()),
    ]
    return named[: len(values)]


def _closed(one: Model, measure: Measure) -> tuple[Values, Values]:
    """Indices in closed form, with no sampling error."""
    values = measure.of(one.predictor)
    return values, tuple(np.zeros_like(value) for value in values)


def _sampled(
    one: Model, measure: Measure, confidence: float, samples: int, scramblings: int
) -> tuple[Values, Values]:
    sampled = pick_freeze(
        one.predict,
        one.space,
        groups=measure.groups,
        samples=samples,
        scramblings=scramblings,
        confidence=confidence,
        seed=measure.seed,
    )
    values = tuple(getattr(sampled, name) for name in INDICES)
    return values, tuple(sampled.half[name] for name in INDICES)


def worst_case(total: Array, q2: float | None) -> Array:
    """Largest total index of the solver, when its surrogate has this total index and Q2.

    See `surrogate.sensitivity.missed`. NaN when Q2 is not known; at most 1.
    """
    return np.full_like(total, np.nan) if q2 is None else largest(total, 1.0 - q2)
