"""Columns of numbers that stand for coded parameters in a regression.

A numeric parameter is one column, its coded value. A categorical one with k levels
is k - 1 effect-coded columns, one for each level but the first: 1 at that level,
-1 at the first, 0 elsewhere. With two levels this is the coded value itself, so a number
with two allowed values is such a column too: its square is the constant.

A component of a mixture, or another parameter that follows from the others by an equality, has
no column: with it the constant and the columns would depend on each other. What is left is the
slack-variable model, which spans the same polynomials as Scheffe's canonical one without
constant (Scheffe 1958; Cornell 2002, "Experiments with Mixtures"), so that predictions are the
same, and keeps the usual meaning of R2, F and coefficients.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import ndtri

from surrogate.space.space import Parameter, Space

Array = NDArray[np.float64]

#: A product of powers of columns: ((column number, power), ...); () is the constant.
Term = tuple[tuple[int, int], ...]

#: Probabilities keep this far from 0.
TINY = 1e-17


@dataclass(frozen=True)
class Column:
    """One numeric column: of parameter number `parameter`, of `level` out of `levels`.

    `levels` is 0 for a numeric parameter. score: its normal score in place of its coded value.
    """

    parameter: int
    name: str
    level: int = 0
    levels: int = 0
    score: bool = False

    def values(self, coded: Array) -> Array:
        """Column values (n,) of this parameter's coded values (n,)."""
        if not self.levels:
            return normal_scores(coded) if self.score else coded
        last = self.levels - 1
        index = np.clip(np.rint((coded + 1.0) / 2.0 * last), 0, last)
        return np.asarray((index == self.level) * 1.0 - (index == 0))


def normal_scores(coded: Array) -> Array:
    """Phi^-1((x + 1) / 2) / 2 of coded values x of any shape: +-1 lies two deviations away.

    A coded value of an unbounded parameter is a probability, in which the far ends of the law are
    one point; the score is linear in a normal parameter, and in the logarithm of a lognormal one.
    """
    below = np.clip(0.5 * (1.0 + coded), TINY, 1.0)
    above = np.clip(0.5 * (1.0 - coded), TINY, 1.0)
    return np.asarray(0.5 * np.where(coded < 0.0, ndtri(below), -ndtri(above)))


def scored(of: tuple[Column, ...], space: Space | None) -> tuple[Column, ...]:
    """The columns, those of unbounded parameters by their normal scores."""
    if space is None:
        return of
    return tuple(
        replace(one, score=not (one.levels or space.parameters[one.parameter].bounded))
        for one in of
    )


def columns_of(space: Space | None, size: int) -> tuple[Column, ...]:
    """Columns of a space; without one, of `size` numeric parameters called x1, x2, ..."""
    if space is None:
        return tuple(Column(j, f"x{j + 1}") for j in range(size))
    follows = space.region.dependent if space.region is not None else ()
    return tuple(
        column
        for j, parameter in enumerate(space.parameters)
        if j not in follows
        for column in _of_parameter(j, parameter)
    )


def _of_parameter(j: int, parameter: Parameter) -> list[Column]:
    if not parameter.categorical:
        allowed = parameter.allowed
        two = allowed is not None and len(allowed) == 2
        return [Column(j, parameter.name, level=1, levels=2) if two else Column(j, parameter.name)]
    return [
        Column(j, f"{parameter.name}[{level}]", index, len(parameter.levels))
        for index, level in enumerate(parameter.levels)
        if index
    ]


def expand(coded: ArrayLike, of: tuple[Column, ...]) -> Array:
    """Numeric columns (n, c) of coded points (n, d)."""
    points = np.asarray(coded, dtype=float)
    return np.column_stack([column.values(points[:, column.parameter]) for column in of])
