"""Polynomials of first and second order on coded inputs, by least squares.

`Linear` is the model of Chassagne et al. 2018 (equation 9), `Interactions` adds all
products of two parameters, `Quadratic` the squares as well: the full second-order
response surface of Box and Wilson 1951.
"""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from itertools import combinations
from typing import Any, Literal, Self, overload

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray
from sklearn.base import BaseEstimator, RegressorMixin
from sklearn.utils.validation import check_is_fitted, validate_data

from surrogate.estimator import Groups
from surrogate.regressors import anova, portable, regression
from surrogate.regressors.canonical import Canonical, canonical
from surrogate.regressors.columns import Column, Term, columns_of, expand
from surrogate.regressors.least_squares import LeastSquares, least_squares, least_squares_of_many
from surrogate.space.space import Space

Array = NDArray[np.float64]


def linear_terms(of: tuple[Column, ...]) -> list[Term]:
    """The constant and each column."""
    return [(), *(((j, 1),) for j in range(len(of)))]


def interaction_terms(of: tuple[Column, ...]) -> list[Term]:
    """The linear terms and the products of columns of different parameters."""
    pairs = [
        ((i, 1), (j, 1))
        for i, j in combinations(range(len(of)), 2)
        if of[i].parameter != of[j].parameter
    ]
    return linear_terms(of) + pairs


def quadratic_terms(of: tuple[Column, ...]) -> list[Term]:
    """The interaction terms and the squares; categorical columns are never squared."""
    return interaction_terms(of) + [((j, 2),) for j, column in enumerate(of) if not column.levels]


def term_name(term: Term, of: tuple[Column, ...]) -> str:
    """`1`, `tension`, `tension:mu_skin`, `tension^2`, `bandage[biflex_17]`."""
    parts = [of[j].name + (f"^{power}" if power > 1 else "") for j, power in term]
    return ":".join(parts) or "1"


def design_matrix(terms: list[Term], values: Array) -> Array:
    """Values (n, p) of terms at column values (n, c)."""
    matrix = np.ones((len(values), len(terms)))
    for t, term in enumerate(terms):
        for j, power in term:
            matrix[:, t] *= values[:, j] ** power
    return matrix


class TermRegressor(RegressorMixin, BaseEstimator):
    """Least squares on the terms that a subclass's `select` takes of its candidates.

    space  the Space of the inputs (names, categorical columns, laws); None for numeric
           inputs x1, x2, ... uniform on [-1, 1]

    Fitted: `terms_`, `columns_`, `coef_` (p,), `model_` (`LeastSquares`).
    Terms that the runs cannot tell apart from lower ones get coefficient 0.
    """

    def __init__(self, space: Space | None = None) -> None:
        self.space = space

    def fit(self, X: ArrayLike, y: ArrayLike) -> Self:
        """Fit to coded points X (n, d) and values y (n,)."""
        matrix, outputs = self._matrix(X, y)
        self._set(least_squares(matrix, outputs, self._names()))
        return self

    def _matrix(self, X: ArrayLike, y: ArrayLike) -> tuple[Array, Array]:
        """Values (n, p) of the terms that are selected for y (n,), and y."""
        points, outputs = validate_data(self, X, y, y_numeric=True)
        self.columns_ = columns_of(self.space, points.shape[1])
        self.points_ = points
        values = expand(points, self.columns_)
        self.terms_ = self.select(values, outputs)
        return design_matrix(self.terms_, values), outputs

    def select(self, values: Array, y: Array) -> list[Term]:
        """Terms that are fitted, given column values (n, c) and y (n,)."""
        raise NotImplementedError(f"{type(self).__name__} does not say which terms it takes")

    def _names(self) -> list[str]:
        return [term_name(term, self.columns_) for term in self.terms_]

    def _set(self, model: LeastSquares) -> None:
        self.model_, self.coef_ = model, model.coefficients

    def rows(self, X: ArrayLike) -> Array:
        """Values (m, p) of the terms at coded points (m, d)."""
        check_is_fitted(self)
        points = validate_data(self, X, reset=False)
        return design_matrix(self.terms_, expand(points, self.columns_))

    def predict(self, X: ArrayLike) -> Array:
        """Values (m,) at coded X (m, d)."""
        return np.asarray(self.rows(X) @ self.coef_)

    def leave_one_out(self) -> Array:
        """Predictions (n,) of each run by the fit of the same terms without it; exact."""
        return self.model_.leave_one_out()

    def regression_table(
        self, *, confidence: float = 0.95, deterministic: bool = False
    ) -> xr.Dataset:
        """Coefficients with errors, tests and diagnostics: see `regression.table`."""
        check_is_fitted(self)
        return regression.table(
            self.model_, self.points_, confidence=confidence, deterministic=deterministic
        )

    def canonical(self) -> Canonical | None:
        """Stationary point and axes of a full quadratic in numbers; see `regressors.canonical`."""
        check_is_fitted(self)
        return canonical(self.terms_, self.columns_, self.model_)

    def sobol_indices(self, groups: Groups | None = None) -> anova.SobolIndices:
        """Exact Sobol' indices of the polynomial under the space's law, of inputs or groups."""
        check_is_fitted(self)
        of, highest = self.columns_, max((q for term in self.terms_ for _, q in term), default=1)
        rules = anova.quadratures(self.space, self.n_features_in_, highest + 1)
        factors = [self._factor(parameter, nodes, of) for parameter, (nodes, _) in enumerate(rules)]
        return anova.sobol_indices(self.coef_, factors, [weights for _, weights in rules], groups)

    def _factor(self, parameter: int, nodes: Array, of: tuple[Column, ...]) -> Array:
        """Part of each term that depends on one parameter, (p, m) at its nodes (m,)."""
        own = [
            tuple((j, q) for j, q in term if of[j].parameter == parameter) for term in self.terms_
        ]
        points = np.zeros((len(nodes), self.n_features_in_))
        points[:, parameter] = nodes
        return design_matrix(own, expand(points, of)).T

    def portable(self) -> dict[str, Any]:
        """JSON-able description; see `surrogate.regressors.portable`."""
        check_is_fitted(self)
        return {
            "kind": "polynomial",
            "columns": portable.described_columns(self.columns_),
            "terms": [
                {"coefficient": float(c), "powers": [list(part) for part in term]}
                for c, term in zip(self.coef_, self.terms_, strict=True)
                if c != 0.0
            ],
        }


class Polynomial(TermRegressor):
    """Least squares on all terms that `choose_terms` names, whatever the runs say."""

    @staticmethod
    def choose_terms(of: tuple[Column, ...]) -> list[Term]:
        """Terms of the model on these columns."""
        return linear_terms(of)

    def select(self, values: Array, y: Array) -> list[Term]:
        """All terms, without regard to column values (n, c) and y (n,)."""
        return self.choose_terms(self.columns_)

    def minimum_runs(self, space: Space) -> int:
        """Runs that a fit needs: one for each term."""
        return len(self.choose_terms(columns_of(space, space.size)))

    def fit_many(self, X: ArrayLike, Y: ArrayLike) -> list[Self]:
        """Fits of outputs Y (n, k) at the same points X (n, d), which share their algebra."""
        Y = np.asarray(Y, dtype=float)
        matrix, _ = self._matrix(X, Y[:, 0])
        models = [copy(self) for _ in Y.T]
        fits = least_squares_of_many(matrix, Y, self._names())
        for model, own in zip(models, fits, strict=True):
            model._set(own)
        return models

    @overload
    def predict(self, X: ArrayLike, return_std: Literal[False] = False) -> Array: ...
    @overload
    def predict(self, X: ArrayLike, return_std: Literal[True]) -> tuple[Array, Array]: ...
    def predict(self, X: ArrayLike, return_std: bool = False) -> Array | tuple[Array, Array]:
        """Values (m,) at coded X (m, d); with the standard deviation of a new observation."""
        rows = self.rows(X)
        mean: Array = rows @ self.coef_
        return (mean, self.model_.standard_error(rows)) if return_std else mean

    def predict_many(
        self, models: Sequence[Self], X: ArrayLike, return_std: bool = False
    ) -> Array | tuple[Array, Array]:
        """Values (m, k) of fits made by one `fit_many`; with standard deviations (m, k)."""
        rows = self.rows(X)
        mean: Array = rows @ np.column_stack([model.coef_ for model in models])
        if not return_std:
            return mean
        deviations = np.array([model.model_.residual_sd for model in models])
        return mean, self.model_.spread(rows)[:, None] * deviations

    def predict_joint(self, X: ArrayLike) -> tuple[Array, Array]:
        """Means (m, n) and covariances (m, n, n) of new runs at m sets of n coded points."""
        points = np.asarray(X, dtype=float)
        flat = expand(points.reshape(-1, points.shape[2]), self.columns_)
        rows = design_matrix(self.terms_, flat)
        shape = points.shape[:2]
        mean: Array = rows @ self.coef_
        return mean.reshape(shape), self.model_.covariance(rows.reshape(*shape, -1))

    @property
    def interval_freedom(self) -> int:
        """Degrees of freedom of the t distribution of prediction intervals."""
        return self.model_.freedom

    def leave_out(self, folds: ArrayLike) -> Array:
        """Predictions (n,) of each run by the fit without its fold (n,); exact."""
        return self.model_.leave_out(np.asarray(folds))

    def portable(self) -> dict[str, Any]:
        """JSON-able description; see `surrogate.regressors.portable`."""
        kept = [t for t, kept in zip(self.terms_, self.model_.kept, strict=True) if kept]
        deviation = {
            "residual_sd": portable.finite(self.model_.residual_sd),
            "points": self.points_.tolist(),
            "terms": [[list(part) for part in term] for term in kept],
        }
        return super().portable() | {"deviation": deviation}


class Linear(Polynomial):
    """Constant and main effects."""


class Interactions(Polynomial):
    """Constant, main effects and all two-parameter interactions."""

    choose_terms = staticmethod(interaction_terms)


class Quadratic(Polynomial):
    """Full second order: constant, main effects, interactions and squares."""

    choose_terms = staticmethod(quadratic_terms)
