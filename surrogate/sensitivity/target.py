"""Target sensitivity: which parameters decide whether the output exceeds a limit.

Sobol' indices of the indicator Z = [f(x) > limit], whose variance is p (1 - p) with
p = P(f > limit) (Marrel and Chabridon 2021, doi 10.1016/j.ress.2021.107711). The first-order
index is Var P(f > limit | x_i) / (p (1 - p)): how far knowing the parameter alone decides.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import xarray as xr

from surrogate.errors import StudyError
from surrogate.estimator import Array, Predictor
from surrogate.sensitivity.draws import (
    SAMPLES,
    Functions,
    Measure,
    Values,
    integer_seed,
    spread,
)
from surrogate.sensitivity.independence import needs_independent, require_independent
from surrogate.sensitivity.model import Analysed, Model, Seed, model
from surrogate.sensitivity.pick_freeze import INDICES, pick_freeze
from surrogate.sensitivity.table import Q2_NEEDED, Estimate, Variables, dataset
from surrogate.space.space import Space

#: In the output's unit; of several outputs, by name.
Limit = float | dict[str, float]
#: Pairs of points for each pair that a smooth output takes: an indicator has two values only.
FINER = 4


@needs_independent
def target(
    fit: Analysed,
    space: Space,
    *,
    above: float | dict[str, float] | None = None,
    below: float | dict[str, float] | None = None,
    seed: Seed = 0,
    confidence: float = 0.95,
    samples: int = 2**15,
    scramblings: int = 8,
    draws: int = 50,
    q2: float | None = None,
    q2_needed: float = Q2_NEEDED,
) -> xr.Dataset:
    """First-order, total and second-order indices of whether one output exceeds a limit.

    above  the limit in the output's unit: a number for every output, or output -> number
    below  the limit that the output is to lie under, in place of `above`

    `probability` in the dataset is that of the event, by the surrogate. An output that has no
    limit, or lies on one side of it everywhere, has no indices.
    """
    require_independent(space, "target")
    one = model(fit, space, q2=q2)
    if np.ndim(one.predict(space.sample(2, seed=0))) != 1:
        raise StudyError(
            f"sensitivity method target takes single numbers, but {one.output} is an array; "
            "use method sobol or shapley"
        )
    event = event_of(one.output, above, below)
    measure = Occurring(Measure(space, seed=seed), event)
    share = float(event.of(one.predict(space.sample(samples, seed=integer_seed(seed)))).mean())
    found = pick_freeze(
        lambda coded: event.of(one.predict(coded)),
        space,
        samples=samples,
        scramblings=scramblings,
        confidence=confidence,
        seed=seed,
    )
    spreads = spread(one, measure, draws=draws, confidence=confidence, seed=seed, shares=False)
    undefined = _undefined(one, event, share)
    dims: list[tuple[str, ...]] = [("parameter",), ("parameter",), ("parameter", "parameter_2")]
    variables: Variables = {"probability": (("output",), [share])}
    for name, dim, part in zip(INDICES, dims, spreads, strict=True):
        value = getattr(found, name) * (np.nan if undefined else 1.0)
        estimate = Estimate(value, found.half[name], part.below, part.above)
        variables |= estimate.columns(name, dim, (0.0, 1.0))
    table = dataset(
        one,
        variables,
        method="target",
        confidence=confidence,
        q2_needed=q2_needed,
        computed="sampling",
        surrogate_part=spreads[0].how,
        event=event.text,
    )
    if undefined:
        table["refused"] = (("output",), [undefined])
        table.attrs["refused"] = undefined
    return table


@dataclass(frozen=True)
class Event:
    """An output above or below its limit; NaN when it has none."""

    limit: float
    above: bool

    def of(self, values: Array) -> Array:
        """1 where it happens, else 0; shape of the values."""
        happens = values > self.limit if self.above else values < self.limit
        return np.asarray(happens, dtype=np.float64)

    @property
    def text(self) -> str:
        """`above 250`."""
        return f"{'above' if self.above else 'below'} {self.limit:g}"


@dataclass(frozen=True)
class Occurring:
    """The same measure of the event in place of the output."""

    measure: Measure
    event: Event

    @property
    def closed(self) -> bool:
        """False: there are no closed forms."""
        return False

    def of(self, estimator: Predictor) -> Values:
        """Indices of one estimator, on points common to all."""
        return self.of_functions(lambda coded: estimator.predict(coded)[:, None], SAMPLES)[0]

    def of_functions(self, functions: Functions, pairs: int) -> list[Values]:
        """The same for each column of functions(coded) (run, count)."""
        return self.measure.of_functions(
            lambda coded: self.event.of(functions(coded)), FINER * pairs
        )


def event_of(output: str, above: Limit | None, below: Limit | None) -> Event:
    """The event of one output; raises `StudyError` unless just one of both limits is given."""
    if (above is None) == (below is None):
        raise StudyError("a limit is needed: give above: or below:, not both")
    limit = below if above is None else above
    if isinstance(limit, Mapping):
        limit = limit.get(output, np.nan)
    return Event(float(limit if limit is not None else np.nan), above is not None)


def _undefined(one: Model, event: Event, share: float) -> str:
    """Why the event has no indices; empty when it has."""
    if np.isnan(event.limit):
        return f"No limit is given for {one.output}."
    if share in (0.0, 1.0):
        where = "nowhere" if share == 0.0 else "everywhere"
        return (
            f"{one.output} is {where} {event.text} in the ranges of the study: give another limit."
        )
    return ""
