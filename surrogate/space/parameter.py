"""One parameter: its law or its levels, coded and physical values.

A bounded number is coded by Chassagne et al. 2018, equation 8,

    x* = 2 (x - min) / (max - min) - 1,

an unbounded one by the probability transform x* = 2 F(x) - 1, and k levels lie
evenly from -1 to 1. Integers and listed values are coded by equation 8 too, so that a
linear model means what it says, and decoded to the nearest allowed value.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from surrogate.errors import StudyError, nearest
from surrogate.space import quadrature
from surrogate.space.discrete import DiscreteLaw
from surrogate.space.distributions import Distribution

Numbers = NDArray[np.float64]

#: Sums run over all values of a discrete parameter up to this many, else over a Gauss rule.
ALL_VALUES = 200


@dataclass(frozen=True)
class Parameter:
    """One thing that varies: either a `distribution` in `unit`, or named `levels`.

    A `DiscreteLaw` allows some values only: integers, or those of a list.
    """

    name: str
    distribution: Distribution | DiscreteLaw | None = None
    levels: tuple[str, ...] = ()
    unit: str = ""
    description: str = ""

    def __post_init__(self) -> None:
        if (self.distribution is None) == (not self.levels):
            raise StudyError(f"{self.name}: give either a distribution or levels, not both")
        if self.levels and (len(self.levels) < 2 or len(set(self.levels)) < len(self.levels)):
            raise StudyError(
                f"{self.name}: levels {list(self.levels)} must be two or more different names"
            )

    @property
    def categorical(self) -> bool:
        """True for named levels."""
        return bool(self.levels)

    @property
    def described(self) -> str:
        """Its law or its levels in words."""
        return ", ".join(self.levels) if self.categorical else str(self.distribution)

    @property
    def allowed(self) -> Numbers | None:
        """Coded allowed values, rising, (k,), of integers and listed values; else None."""
        law = self.distribution
        return self.encode(law.values) if isinstance(law, DiscreteLaw) else None

    @property
    def continuous(self) -> bool:
        """True when every value between the ends is allowed."""
        return isinstance(self.distribution, Distribution)

    def snap(self, coded: ArrayLike) -> Numbers:
        """Coded values, same shape, of the allowed values nearest to `coded`.

        A parameter that is not discrete keeps them.
        """
        t = np.asarray(coded, dtype=float)
        law = self.distribution
        if not isinstance(law, DiscreteLaw):
            return t
        lower, upper = law.support
        index = law.nearest(lower + 0.5 * (t + 1.0) * (upper - lower))
        return self.encode(law.values)[index]

    @property
    def bounded(self) -> bool:
        """True when coded -1 and 1 stand for finite values."""
        return self.categorical or self.law.bounded

    @property
    def law(self) -> Distribution | DiscreteLaw:
        """The distribution of a number; `StudyError` for named levels, which have none."""
        if self.distribution is None:
            raise StudyError(f"{self.name}: levels have no distribution")
        return self.distribution

    @property
    def coded_levels(self) -> Numbers:
        """Coded values of the levels, shape (k,): evenly from -1 to 1."""
        return np.linspace(-1.0, 1.0, len(self.levels))

    def encode(self, physical: ArrayLike) -> Numbers:
        """Coded values of physical ones, same shape; level names for a categorical one."""
        if self.categorical:
            return self._encode_levels(physical)
        x, law = np.asarray(physical, dtype=float), self.law
        if isinstance(law, DiscreteLaw) or self.bounded:
            lower, upper = law.support
            return 2.0 * (x - lower) / (upper - lower) - 1.0
        below = 2.0 * law.cdf(x) - 1.0
        return np.where(below < 0.0, below, 1.0 - 2.0 * law.sf(x))

    def _encode_levels(self, physical: ArrayLike) -> Numbers:
        names = np.asarray(physical).astype(str)
        unknown = sorted(set(names.ravel()) - set(self.levels))
        if unknown:
            raise StudyError(
                f"{self.name}: level '{unknown[0]}' is unknown; {nearest(unknown[0], self.levels)}"
            )
        order = {level: code for level, code in zip(self.levels, self.coded_levels, strict=True)}
        coded: Numbers = np.vectorize(order.__getitem__, otypes=[float])(names)
        return coded

    def decode(self, coded: ArrayLike) -> NDArray[Any]:
        """Physical values of coded ones, same shape; the nearest level or allowed value."""
        t = np.asarray(coded, dtype=float)
        if self.categorical:
            last = len(self.levels) - 1
            index = np.clip(np.rint((t + 1.0) / 2.0 * last), 0, last).astype(int)
            names: NDArray[Any] = np.asarray(self.levels)[index]
            return names
        law = self.law
        if isinstance(law, DiscreteLaw):
            lower, upper = law.support
            return np.asarray(law.values[law.nearest(lower + 0.5 * (t + 1.0) * (upper - lower))])
        if self.bounded:
            # Written about the nearer end so that -1 and 1 give the bounds to the last digit.
            lower, upper = law.support
            return np.where(
                t < 0.0,
                lower + 0.5 * (t + 1.0) * (upper - lower),
                upper - 0.5 * (1.0 - t) * (upper - lower),
            )
        return np.where(
            t < 0.0,
            law.ppf(np.clip((1.0 + t) / 2.0, 0.0, 1.0)),
            law.isf(np.clip((1.0 - t) / 2.0, 0.0, 1.0)),
        )

    def probability(self, coded: ArrayLike) -> Numbers:
        """Where coded values lie in their law, from 0 to 1, same shape; levels lie evenly."""
        t = np.asarray(coded, dtype=float)
        law = self.distribution
        if isinstance(law, Distribution) and law.bounded and not law.is_uniform:
            return law.cdf(self.decode(t))
        return np.asarray((t + 1.0) / 2.0)

    def quantile(self, u: ArrayLike) -> Numbers:
        """Coded value below which the probability is u, for u in (0, 1); same shape."""
        u = np.asarray(u, dtype=float)
        if self.categorical:
            index = np.minimum((u * len(self.levels)).astype(int), len(self.levels) - 1)
            return np.asarray(self.coded_levels[index], dtype=float)
        if not self.bounded or self.law.is_uniform:
            return 2.0 * u - 1.0
        return self.encode(self.law.ppf(u))

    def quadrature(self, order: int) -> tuple[Numbers, Numbers]:
        """Nodes (m,) in coded values and weights (m,) that sum to 1, for this parameter's law.

        Sums over the levels when categorical, and over the allowed values of a discrete
        parameter; Gauss-Legendre in the coded value where that is uniform and the Gauss
        rule of the law elsewhere, both exact to polynomial degree 2 `order` - 1.
        """
        if self.categorical:
            return self.coded_levels, np.full(len(self.levels), 1.0 / len(self.levels))
        law = self.law
        if isinstance(law, DiscreteLaw):
            if len(law.values) > max(order, ALL_VALUES):
                return quadrature.gauss_rule(self.encode(law.values), law.probabilities, order)
            return self.encode(law.values), law.probabilities
        nodes, weights = quadrature.legendre(order)
        if not self.bounded or law.is_uniform:
            return nodes, weights / 2.0
        return quadrature.of_law(law, order)
