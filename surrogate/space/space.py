"""Parameters and the space they span: the only place where values are coded.

`physical` values carry units (or are the names of levels); `coded` values lie in
[-1, 1]. A bounded parameter is coded by Chassagne et al. 2018, equation 8,

    x* = 2 (x - min) / (max - min) - 1,

an unbounded one by the probability transform x* = 2 F(x) - 1, and k levels lie
evenly from -1 to 1. Integers and listed values are coded by equation 8 too, so that a
linear model means what it says, and decoded to the nearest allowed value. Dependent
parameters are joined by a Gaussian copula.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import special

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


@dataclass(frozen=True)
class Space:
    """Parameters in order, and the correlation matrix of their Gaussian copula (or None)."""

    parameters: tuple[Parameter, ...]
    correlation: tuple[tuple[float, ...], ...] | None = None

    def __deepcopy__(self, memo: dict[int, Any]) -> Space:
        """Itself: nothing in it changes, and scikit-learn copies it with every regressor."""
        return self

    def __post_init__(self) -> None:
        if not self.parameters:
            raise StudyError("a space needs at least one parameter")
        if len(set(self.names)) < len(self.names):
            raise StudyError(f"parameter names {list(self.names)} must all differ")
        if self.correlation is not None:
            _check_correlation(np.asarray(self.correlation), len(self.parameters))

    @property
    def names(self) -> tuple[str, ...]:
        """Parameter names in order."""
        return tuple(parameter.name for parameter in self.parameters)

    @property
    def size(self) -> int:
        """Number of parameters."""
        return len(self.parameters)

    @property
    def independent(self) -> bool:
        """True when no parameters are correlated."""
        return self.correlation is None or np.allclose(self.correlation, np.eye(self.size))

    def __getitem__(self, name: str) -> Parameter:
        for parameter in self.parameters:
            if parameter.name == name:
                return parameter
        raise StudyError(f"parameter '{name}' is unknown; {nearest(name, self.names)}")

    def encode(self, physical: Mapping[str, Any]) -> Numbers:
        """Coded values (run, parameter) of columns of physical ones, name -> (run,)."""
        missing = [name for name in self.names if name not in physical]
        if missing:
            raise StudyError(f"no value for {', '.join(missing)}")
        columns = [np.atleast_1d(p.encode(physical[p.name])) for p in self.parameters]
        return np.column_stack(columns)

    def decode(self, coded: ArrayLike) -> dict[str, NDArray[Any]]:
        """Columns of physical values, name -> (run,), of coded ones (run, parameter)."""
        coded = self._points(coded)
        return {p.name: p.decode(coded[:, j]) for j, p in enumerate(self.parameters)}

    def snap(self, coded: ArrayLike) -> Numbers:
        """Coded points (run, parameter) of the nearest allowed values.

        Only integers and listed values move.
        """
        coded = self._points(coded)
        return np.column_stack([p.snap(coded[:, j]) for j, p in enumerate(self.parameters)])

    def quantile(self, u: ArrayLike) -> Numbers:
        """Coded points (run, parameter) of independent uniform numbers in (0, 1).

        The joint law of the result is the space's own, copula included: this is how
        random and low-discrepancy numbers become designs and samples.
        """
        u = self._points(u)
        if not self.independent:
            normal = special.ndtri(np.clip(u, 1e-16, 1.0 - 1e-16))
            u = special.ndtr(normal @ np.linalg.cholesky(np.asarray(self.correlation)).T)
        return np.column_stack([p.quantile(u[:, j]) for j, p in enumerate(self.parameters)])

    def sample(self, runs: int, *, seed: int | None = None) -> Numbers:
        """Random coded points (run, parameter) from the joint law."""
        return self.quantile(np.random.default_rng(seed).random((runs, self.size)))

    def contains(self, coded: ArrayLike) -> NDArray[np.bool_]:
        """Which coded points (run, parameter) the space allows, shape (run,).

        They lie in [-1, 1] throughout, and integers and listed values are allowed ones.
        """
        coded = self._points(coded)
        inside = np.abs(coded) <= 1.0 + 1e-9
        return np.asarray((inside & (np.abs(coded - self.snap(coded)) <= 1e-9)).all(axis=1))

    def _points(self, values: ArrayLike) -> Numbers:
        values = np.atleast_2d(np.asarray(values, dtype=float))
        if values.shape[1] != self.size:
            raise StudyError(
                f"points have {values.shape[1]} columns but the space has "
                f"{self.size} parameters: {', '.join(self.names)}"
            )
        return values


def _check_correlation(matrix: Numbers, size: int) -> None:
    if matrix.shape != (size, size):
        raise StudyError(f"the correlation matrix is {matrix.shape}; it must be ({size}, {size})")
    if not np.allclose(matrix, matrix.T) or not np.allclose(np.diag(matrix), 1.0):
        raise StudyError("the correlation matrix must be symmetric with ones on its diagonal")
    smallest = np.linalg.eigvalsh(matrix)[0]
    if smallest <= 1e-10:
        raise StudyError(
            f"the correlation matrix is not positive definite (smallest eigenvalue "
            f"{smallest:.3g}); no set of quantities has these correlations"
        )
