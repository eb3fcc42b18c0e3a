"""Functions of one coded input, which all terms of a surrogate are products of.

A formula lists its factors in an order in which each needs earlier ones only. Number 0 is
the constant 1.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True)
class Coordinate:
    """The coded input t."""

    input: int


@dataclass(frozen=True)
class Contrast:
    """values[l] at level l of a coded input, evenly from -1 to 1: effects, Helmert's contrasts."""

    input: int
    values: tuple[float, ...]


@dataclass(frozen=True)
class Product:
    """Product of two earlier factors."""

    a: int
    b: int


@dataclass(frozen=True)
class Recurrence:
    """((t - alpha) now - beta before) / gamma: the next orthonormal polynomial of an input."""

    input: int
    alpha: float
    beta: float
    gamma: float
    now: int
    before: int


Factor = Coordinate | Contrast | Product | Recurrence


@dataclass
class Factors:
    """Collects the factors that terms need; equal ones stand once."""

    found: dict[Factor, int] = field(default_factory=dict)

    def number(self, factor: Factor) -> int:
        """The number of a factor, from 1."""
        return self.found.setdefault(factor, len(self.found) + 1)

    def column(self, column: Mapping[str, Any]) -> int:
        """The factor that a column of the document is."""
        levels = column.get("levels", 0)
        if not levels:
            return self.number(Coordinate(column["input"]))
        effect = [0.0] * levels
        effect[0], effect[column["level"]] = -1.0, 1.0
        return self.number(Contrast(column["input"], tuple(effect)))

    def power(self, column: Mapping[str, Any], exponent: int) -> int:
        """A column to a power above 0."""
        once = self.column(column)
        found = once
        for _ in range(exponent - 1):
            found = self.number(Product(found, once))
        return found

    def orthonormal(self, number: int, base: Mapping[str, Any], degree: int) -> int:
        """The function P_degree of input `number`, degree above 0."""
        if "levels" in base:
            return self.number(Contrast(number, tuple(base["values"][degree])))
        before, now = 0, 0
        for k in range(degree):
            coefficients = (base["alpha"][k], base["beta"][k] if k else 0.0, base["beta"][k + 1])
            before, now = now, self.number(Recurrence(number, *coefficients, now, before))
        return now

    def powers(
        self, columns: Sequence[Mapping[str, Any]], term: Sequence[Sequence[int]]
    ) -> tuple[int, ...]:
        """Factors of a polynomial's term [[column, power], ...]."""
        return tuple(self.power(columns[j], q) for j, q in term)

    def degrees(
        self, bases: Sequence[Mapping[str, Any]], term: Sequence[Sequence[int]]
    ) -> tuple[int, ...]:
        """Factors of a chaos' term [[input, degree], ...]."""
        return tuple(self.orthonormal(i, bases[i], q) for i, q in term)

    @property
    def listed(self) -> tuple[Factor, ...]:
        """All factors in order; number 1 is the first."""
        return tuple(self.found)
