"""Whether goals and limits are met, by draws of the surrogates or by runs of the solver."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from surrogate.solving.problem import Problem
from surrogate.space.constraints import Relation

Array = NDArray[np.float64]
Truth = NDArray[np.bool_]


def met(
    problem: Problem,
    ends: Mapping[str, tuple[float, float]],
    columns: Mapping[str, Any],
    values: Mapping[str, Array],
) -> Truth:
    """Where goals and limits are met, the shape of the values of the outputs.

    ends     output -> where its target ends
    columns  physical inputs that limits name, of a shape that fits to `values`
    """
    kept = np.ones(next(iter(values.values())).shape, dtype=bool)
    for output, (low, high) in ends.items():
        kept &= (values[output] >= low) & (values[output] <= high)
    for desire in problem.desires:
        kept &= desire.acceptable(values[desire.output])
    for limit in problem.limits:
        kept &= limit.holds(compared(problem, limit, columns, values))
    return kept


def compared(
    problem: Problem,
    limit: Relation,
    columns: Mapping[str, Any],
    values: Mapping[str, Array],
) -> dict[str, Array]:
    """What a limit compares, by name, all of one shape."""
    given = {**problem.fixed, **columns, **values}
    found = {name: np.asarray(given[name], dtype=float) for name in limit.names}
    shape = np.broadcast_shapes(*(one.shape for one in found.values()))
    return {name: np.broadcast_to(one, shape) for name, one in found.items()}


@dataclass(frozen=True)
class Verified:
    """What the solver says at a candidate.

    values  output -> value of each run that has an answer
    met     of these runs, those that meet goal and limits
    failed  runs without an answer
    """

    values: Mapping[str, tuple[float, ...]]
    met: int
    failed: int = 0

    @property
    def runs(self) -> int:
        """Runs that have an answer."""
        return len(next(iter(self.values.values()), ()))

    @property
    def share(self) -> tuple[float, float, float]:
        """Share of the runs that meet goal and limits, with its 95 % interval.

        The interval is that of Clopper and Pearson (1934, Biometrika 26, 404).
        """
        from scipy import stats  # not for those who only read solutions

        found = stats.binomtest(self.met, self.runs).proportion_ci(method="exact")
        return self.met / self.runs, float(found.low), float(found.high)
