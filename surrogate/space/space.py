"""The space that parameters span: the only place where points are coded.

`physical` values carry units (or are the names of levels); `coded` values lie in
[-1, 1]; `surrogate.space.parameter` says how. Dependent parameters are joined by a Gaussian
copula, or by constraints that cut the box.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import special

from surrogate.card import Card, Rows
from surrogate.errors import StudyError, nearest
from surrogate.space.constraints import Relation
from surrogate.space.parameter import Parameter
from surrogate.space.region import Region

__all__ = ["Parameter", "Space"]

Numbers = NDArray[np.float64]


@dataclass(frozen=True)
class Space:
    """Parameters in order, the correlation matrix of their Gaussian copula (or None), constraints.

    fixed  (name, value) of the constants that the constraints name, in their units
    """

    parameters: tuple[Parameter, ...]
    correlation: tuple[tuple[float, ...], ...] | None = None
    constraints: tuple[Relation, ...] = ()
    fixed: tuple[tuple[str, float], ...] = ()

    def _repr_html_(self) -> str:
        rows = [(p.name, p.unit, p.described) for p in self.parameters]
        facts = {
            "constraints": "; ".join(one.text for one in self.constraints),
            "correlation": "Gaussian copula" if self.correlation is not None else "",
        }
        table = Rows("parameters", ("name", "unit", "values"), rows)
        return Card("Space", f"of {self.size} parameters", facts, (table,)).html()

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
        if self.region is not None and self.region.found and self.region.equalities:
            if self.correlation is not None:
                raise StudyError(
                    "correlation: and an equality among constraints: do not go together; drop one"
                )

    @cached_property
    def region(self) -> Region | None:
        """What the constraints leave of the box; None without constraints."""
        if not self.constraints:
            return None
        return Region(self.parameters, self.constraints, dict(self.fixed), self._quantile)

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
        """True when no parameters are correlated and no constraint joins them."""
        return not self.constraints and not self._correlated

    @property
    def _correlated(self) -> bool:
        return self.correlation is not None and not np.allclose(self.correlation, np.eye(self.size))

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
        random and low-discrepancy numbers become designs and samples. Constraints are left
        aside: of these points `region` keeps some.
        """
        return self._quantile(self._points(u))

    def _quantile(self, u: Numbers) -> Numbers:
        if self._correlated:
            normal = special.ndtri(np.clip(u, 1e-16, 1.0 - 1e-16))
            u = special.ndtr(normal @ np.linalg.cholesky(np.asarray(self.correlation)).T)
        return np.column_stack([p.quantile(u[:, j]) for j, p in enumerate(self.parameters)])

    def sample(self, runs: int, *, seed: int | None = None) -> Numbers:
        """Random coded points (run, parameter) from the joint law, constraints kept."""
        if self.region is not None:
            return self.region.sample(runs, np.random.default_rng(seed))
        return self.quantile(np.random.default_rng(seed).random((runs, self.size)))

    def contains(self, coded: ArrayLike) -> NDArray[np.bool_]:
        """Which coded points (run, parameter) the space allows, shape (run,).

        They lie in [-1, 1] throughout, integers and listed values are allowed ones, and all
        constraints hold.
        """
        coded = self._points(coded)
        inside = np.abs(coded) <= 1.0 + 1e-9
        kept = np.asarray((inside & (np.abs(coded - self.snap(coded)) <= 1e-9)).all(axis=1))
        return kept if self.region is None else kept & self.region.holds(coded)

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
