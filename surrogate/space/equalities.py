"""Linear equalities between parameters, such as the mixture a + b + c = 1.

Each is solved for one of its parameters, the dependent one: the longest range, of equals the
last. The others are free; a point is in the region when the dependent ones lie in their
ranges. As the equalities are linear and the laws uniform, free parameters drawn at random and
rejected when a dependent one leaves its range are uniform on what is left of the box.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from surrogate.errors import StudyError
from surrogate.space.constraints import Relation
from surrogate.space.parameter import Parameter

Numbers = NDArray[np.float64]

#: Coefficients below this share of the largest are rounding.
SMALL = 1e-9


@dataclass(frozen=True, eq=False)
class Equalities:
    """rows @ coded = right; rows (m, d), right (m,)."""

    rows: Numbers
    right: Numbers

    @property
    def dependent(self) -> tuple[int, ...]:
        """Numbers of the parameters that follow from the others."""
        return self._solved(range(self.rows.shape[1]))[2]

    @property
    def reduced(self) -> list[tuple[int, float, Numbers]]:
        """(number j, right side, coefficients (d,), 1 at j) of each dependent parameter."""
        rows, right, dependent = self._solved(range(self.rows.shape[1]))
        return [
            (j, float(value), row) for row, value, j in zip(rows, right, dependent, strict=True)
        ]

    def solve(self, coded: Numbers, inside: Collection[int] | None = None) -> Numbers:
        """Points (run, d) with dependent parameters set so that all equalities hold.

        inside: the parameters that may move; default all. An equality of the others alone is
        taken to hold.
        """
        allowed = range(self.rows.shape[1]) if inside is None else inside
        rows, right, dependent = self._solved(allowed)
        found = coded.copy()
        for row, value, j in zip(rows, right, dependent, strict=True):
            rest = row.copy()
            rest[j] = 0.0
            found[:, j] = value - coded @ rest
        return found

    def _solved(self, allowed: Collection[int]) -> tuple[Numbers, Numbers, tuple[int, ...]]:
        """Reduced rows with coefficient 1 at a parameter of its own each (Gauss and Jordan)."""
        system = np.column_stack([self.rows, self.right])
        candidates = sorted(allowed)
        taken: list[int] = []
        done: list[int] = []
        for i in range(len(system)):
            left = np.abs(system[i, candidates]) if candidates else np.zeros(0)
            if not left.size or left.max() <= SMALL * np.abs(self.rows).max():
                continue
            j = candidates[int(np.flatnonzero(left >= (1.0 - SMALL) * left.max())[-1])]
            system[i] /= system[i, j]
            for other in range(len(system)):
                if other != i:
                    system[other] -= system[other, j] * system[i]
            candidates.remove(j)
            taken.append(j)
            done.append(i)
        return system[done, :-1], system[done, -1], tuple(taken)


def equalities(
    constraints: Sequence[Relation], parameters: Sequence[Parameter], fixed: dict[str, float]
) -> Equalities | None:
    """The equalities among the constraints, in coded values; None when there are none.

    Raises `StudyError` for one that is not linear, or whose parameters are not uniform on a
    range.
    """
    found = [one for one in constraints if one.is_equality]
    if not found:
        return None
    lines = [_line(one, parameters, fixed) for one in found]
    return Equalities(np.stack([row for row, _ in lines]), np.array([value for _, value in lines]))


def _line(
    one: Relation, parameters: Sequence[Parameter], fixed: dict[str, float]
) -> tuple[Numbers, float]:
    """Coefficients (d,) and right side of an equality in coded values."""
    for p in parameters:
        law = p.distribution
        if p.name in one.names and (law is None or not p.continuous or not law.is_uniform):
            raise StudyError(
                f"constraint '{one.text}': {p.name} is {law or 'categorical'}, but parameters "
                "of an equality must be uniform on a range; leave out the one that follows "
                "from the others"
            )
    d = len(parameters)
    rng = np.random.default_rng(0)
    probes = np.vstack([np.zeros(d), np.eye(d), rng.uniform(-1.0, 1.0, (5, d))])
    columns = {p.name: p.decode(probes[:, j]) for j, p in enumerate(parameters)}
    values = one.difference({**columns, **{k: np.full(len(probes), v) for k, v in fixed.items()}})
    row = values[1 : d + 1] - values[0]
    bent = np.abs(values[d + 1 :] - values[0] - probes[d + 1 :] @ row).max()
    if not bent <= SMALL * max(np.abs(values).max(), np.abs(row).max()):
        raise StudyError(
            f"constraint '{one.text}': an equality must be linear in the parameters, such as "
            "a + b + c = 1; leave out the parameter that follows from the others, and compute "
            "it in the solver"
        )
    return row, -float(values[0])
