"""SALib's methods on a surrogate, with inputs as probabilities in the unit cube.

A point u of the unit cube stands for the coded point `Space.quantile(u)`, so that every law
and every list of levels has bounds [0, 1]. The sample is drawn anew `replicates` times; the
scatter gives the sampling part of the interval (Student's t).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from scipy import stats

from surrogate.errors import StudyError
from surrogate.estimator import Array, Predictor
from surrogate.sensitivity.draws import Functions, Values, spread
from surrogate.sensitivity.independence import require_independent
from surrogate.sensitivity.model import Model, Seed, require_at_least, rests
from surrogate.sensitivity.pick_freeze import unit_blocks
from surrogate.sensitivity.table import Estimate, Variables, dataset
from surrogate.space.space import Space

#: Name -> measure (parameter,).
Measures = dict[str, Array]


@dataclass(frozen=True)
class Method:
    """One of SALib's methods with its options.

    sample   seed -> points u (run, parameter)
    analyse  (u, values (run,), seed) -> name -> (parameter,)
    ends     name -> smallest and largest value that the measure can take; also which
             measures are reported, in order
    """

    name: str
    sample: Callable[[int], Array]
    analyse: Callable[[Array, Array, int], Measures]
    ends: dict[str, tuple[float, float]]


@dataclass(frozen=True)
class Measure:
    """The method's measures of any surrogate on points common to all; zero for a constant one."""

    method: Method
    space: Space
    seed: int

    @property
    def closed(self) -> bool:
        """False: there are no closed forms."""
        return False

    def of(self, estimator: Predictor) -> Values:
        """Measures of one estimator, each (d,)."""
        return self.of_functions(lambda coded: estimator.predict(coded)[:, None])[0]

    def of_functions(self, functions: Functions, pairs: int | None = None) -> list[Values]:
        """The same for each column of functions(coded) (run, count); `pairs` plays no part."""
        u = self.method.sample(self.seed)
        columns = functions(self.space.quantile(np.clip(u, 1e-12, 1.0 - 1e-12))).T
        return [self._read(u, column) for column in columns]

    def _read(self, u: Array, values: Array) -> Values:
        if rests(values):  # SALib would divide by no variance, or measure rounding
            return tuple(np.zeros(self.space.size) for _ in self.method.ends)
        with global_seed(self.seed):
            found = self.method.analyse(u, values, self.seed)
        return tuple(np.asarray(found[name], dtype=float) for name in self.method.ends)


def measured(
    one: Model,
    method: Method,
    *,
    seed: Seed,
    confidence: float,
    replicates: int,
    draws: int,
    q2_needed: float,
    **attributes: Any,
) -> xr.Dataset:
    """Dataset of a method's measures: mean of the replicates, with both parts of the error."""
    require_independent(one.space, method.name)
    if np.ndim(one.predict(one.space.sample(2, seed=0))) != 1:
        raise StudyError(
            f"sensitivity method {method.name} takes single numbers, but "
            f"{one.output} is an array; use method sobol or shapley"
        )
    require_at_least(4, replicates=replicates)
    seeds = np.random.default_rng(seed).integers(1, 2**31, replicates).tolist()
    sets = [Measure(method, one.space, s).of(one) for s in seeds]
    quantile = stats.t.ppf(0.5 + 0.5 * confidence, replicates - 1) / np.sqrt(replicates)
    spreads = spread(
        one,
        Measure(method, one.space, seeds[0]),
        draws=draws,
        confidence=confidence,
        seed=seed,
        shares=False,
    )
    variables: Variables = {}
    for parts, (name, ends), part in zip(
        zip(*sets, strict=True), method.ends.items(), spreads, strict=True
    ):
        stack = np.stack(parts)
        estimate = Estimate(
            stack.mean(axis=0), quantile * stack.std(axis=0, ddof=1), part.below, part.above
        )
        variables |= estimate.columns(name, ("parameter",), ends)
    return dataset(
        one,
        variables,
        method=method.name,
        confidence=confidence,
        q2_needed=q2_needed,
        surrogate_part=spreads[0].how,
        **attributes,
    )


def even(space: Space, samples: int, seed: int) -> Array:
    """At least `samples` points u (run, parameter), a power of two, of a scrambled sequence."""
    runs = 2 ** int(np.ceil(np.log2(samples)))
    return next(unit_blocks(space.size, runs, runs, np.random.default_rng(seed)))


def problem(space: Space) -> dict[str, Any]:
    """SALib's description of the unit cube."""
    return {"num_vars": space.size, "names": list(space.names), "bounds": [[0.0, 1.0]] * space.size}


@contextmanager
def global_seed(seed: int) -> Iterator[None]:
    """NumPy's global state seeded inside and untouched outside: some of SALib draws from it."""
    state = np.random.get_state()  # noqa: NPY002
    np.random.seed(seed)  # noqa: NPY002
    try:
        yield
    finally:
        np.random.set_state(state)  # noqa: NPY002
