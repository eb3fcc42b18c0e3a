"""Polynomials of first and second order on coded inputs, by least squares.

`Linear` is the model of Chassagne et al. 2018 (equation 9), `Interactions` adds all
products of two parameters, `Quadratic` the squares as well: the full second-order
response surface of Box and Wilson 1951.
"""

from __future__ import annotations

from itertools import combinations

import numpy as np
import xarray as xr
from sklearn.base import BaseEstimator, RegressorMixin
from sklearn.utils.validation import check_is_fitted, validate_data

from surrogate.regressors import anova, portable, regression
from surrogate.regressors.columns import Column, columns_of, expand

#: A term is a product of powers of columns: ((column number, power), ...); () is the constant.
Term = tuple[tuple[int, int], ...]


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


def design_matrix(terms: list[Term], values: np.ndarray) -> np.ndarray:
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

    Fitted: `terms_`, `columns_`, `coef_` (p,), `model_` (`regression.LeastSquares`).
    Terms that the runs cannot tell apart from lower ones get coefficient 0.
    """

    def __init__(self, space=None):
        self.space = space

    def fit(self, X, y):
        """Fit to coded points X (n, d) and values y (n,)."""
        X, y = validate_data(self, X, y, y_numeric=True)
        self.columns_ = columns_of(self.space, X.shape[1])
        self.points_ = X
        values = expand(X, self.columns_)
        self.terms_ = self.select(values, y)
        names = [term_name(term, self.columns_) for term in self.terms_]
        self.model_ = regression.least_squares(design_matrix(self.terms_, values), y, names)
        self.coef_ = self.model_.coefficients
        return self

    def rows(self, X) -> np.ndarray:
        """Values (m, p) of the terms at coded points (m, d)."""
        check_is_fitted(self)
        X = validate_data(self, X, reset=False)
        return design_matrix(self.terms_, expand(X, self.columns_))

    def predict(self, X):
        """Values (m,) at coded X (m, d)."""
        return self.rows(X) @ self.coef_

    def leave_one_out(self) -> np.ndarray:
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

    def sobol_indices(self, groups: anova.Groups | None = None) -> anova.SobolIndices:
        """Exact Sobol' indices of the polynomial under the space's law, of inputs or groups."""
        check_is_fitted(self)
        of, highest = self.columns_, max((q for term in self.terms_ for _, q in term), default=1)
        rules = anova.quadratures(self.space, self.n_features_in_, highest + 1)
        factors = [self._factor(parameter, nodes, of) for parameter, (nodes, _) in enumerate(rules)]
        return anova.sobol_indices(self.coef_, factors, [weights for _, weights in rules], groups)

    def _factor(self, parameter: int, nodes: np.ndarray, of: tuple[Column, ...]) -> np.ndarray:
        """Part of each term that depends on one parameter, (p, m) at its nodes (m,)."""
        own = [
            tuple((j, q) for j, q in term if of[j].parameter == parameter) for term in self.terms_
        ]
        points = np.zeros((len(nodes), self.n_features_in_))
        points[:, parameter] = nodes
        return design_matrix(own, expand(points, of)).T

    def portable(self) -> dict:
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

    def select(self, values: np.ndarray, y: np.ndarray) -> list[Term]:
        """All terms, without regard to column values (n, c) and y (n,)."""
        return self.choose_terms(self.columns_)

    def minimum_runs(self, space) -> int:
        """Runs that a fit needs: one for each term."""
        return len(self.choose_terms(columns_of(space, space.size)))

    def predict(self, X, return_std=False):
        """Values (m,) at coded X (m, d); with the standard deviation of a new observation."""
        rows = self.rows(X)
        mean = rows @ self.coef_
        return (mean, self.model_.standard_error(rows)) if return_std else mean

    @property
    def interval_freedom(self) -> int:
        """Degrees of freedom of the t distribution of prediction intervals."""
        return self.model_.freedom

    def leave_out(self, folds) -> np.ndarray:
        """Predictions (n,) of each run by the fit without its fold (n,); exact."""
        return self.model_.leave_out(np.asarray(folds))


class Linear(Polynomial):
    """Constant and main effects."""


class Interactions(Polynomial):
    """Constant, main effects and all two-parameter interactions."""

    choose_terms = staticmethod(interaction_terms)


class Quadratic(Polynomial):
    """Full second order: constant, main effects, interactions and squares."""

    choose_terms = staticmethod(quadratic_terms)
