"""Sparse polynomial chaos: orthonormal polynomials, the few that matter.

Terms are taken one by one by orthogonal least squares (Chen, Billings, Luo 1989), the
one that reduces the residual most. Degree and number of terms are those with the
smallest error on folds for which the terms were chosen anew. The leave-one-out error
with the terms kept (Blatman and Sudret 2011) is in closed form, but as a judge of the
choice it is too kind: on noisy runs it took as many terms as it was allowed.
"""

from __future__ import annotations

from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import linalg
from sklearn.base import BaseEstimator, RegressorMixin
from sklearn.utils.validation import check_is_fitted, validate_data

from surrogate.estimator import Groups
from surrogate.regressors import anova, regression
from surrogate.regressors.orthogonal import Basis, Index, basis, hyperbolic, products
from surrogate.space.space import Space

Array = NDArray[np.float64]

#: Larger sets of candidate terms are not tried.
CANDIDATES = 5000
#: An expansion of more terms is not sparse.
TERMS = 200
#: Degrees tried without a smaller error before the search ends; functions with a symmetry
#: gain only at every other one.
PATIENCE = 4
FOLDS = 5


class PolynomialChaos(RegressorMixin, BaseEstimator):
    """Sparse polynomial chaos expansion on coded inputs.

    max_degree  largest polynomial degree tried
    hyperbolic  0 < q <= 1 of the truncation; smaller means fewer interactions
    seed        of the folds that choose degree and terms
    space       the Space of the inputs, whose laws the polynomials are orthonormal for;
                None for inputs uniform on [-1, 1]

    Fitted: `indices_` (which product each term is), `coef_` (p,), `degree_`,
    `model_` (`regression.LeastSquares` of the chosen terms), `error_` (mean squared error
    on the folds of the choice, a share of the variance).
    """

    def __init__(
        self,
        max_degree: int = 10,
        hyperbolic: float = 0.75,
        seed: int = 0,
        space: Space | None = None,
    ) -> None:
        self.max_degree = max_degree
        self.hyperbolic = hyperbolic
        self.seed = seed
        self.space = space

    def fit(self, X: ArrayLike, y: ArrayLike) -> Self:
        """Fit to coded points X (n, d) and values y (n,)."""
        points, outputs = validate_data(self, X, y, y_numeric=True, ensure_min_samples=3)
        if not (self.max_degree >= 1 and 0.0 < self.hyperbolic <= 1.0):
            raise ValueError(
                f"max_degree {self.max_degree} must be 1 or more and hyperbolic "
                f"{self.hyperbolic} above 0 and at most 1"
            )
        parameters = self.space.parameters if self.space else [None] * points.shape[1]
        self.bases_ = [basis(parameter, self.max_degree) for parameter in parameters]
        self.indices_, self.degree_, self.error_ = self._select(points, outputs)
        names = [self._name(index) for index in self.indices_]
        self.model_ = regression.least_squares(self._matrix(points), outputs, names)
        self.coef_ = self.model_.coefficients
        return self

    def _select(self, X: Array, y: Array) -> tuple[tuple[Index, ...], int, float]:
        """Terms, degree and error of the best expansion, over degrees from 1 up."""
        values = [one.values(X[:, i]) for i, one in enumerate(self.bases_)]
        folds = np.random.default_rng(self.seed).permutation(np.arange(len(y)) % FOLDS)
        best, at = 1.0, 0
        chosen: tuple[Index, ...] = ((),)
        for degree in range(1, self.max_degree + 1):
            indices = hyperbolic(_sizes(self.bases_), degree, self.hyperbolic)
            if len(indices) > CANDIDATES or degree > at + PATIENCE:
                break
            matrix = products(indices, values)
            count, error = best_count(matrix, y, folds)
            if error < best * (1.0 - 1e-9):
                best, at = error, degree
                chosen = tuple(indices[j] for j in sorted(pursue(matrix, y, count)))
        return chosen, at, best

    def _name(self, index: Index) -> str:
        """`1`, `tension`, `tension^2:mu_skin`: the leading power of each polynomial."""
        names = self.space.names if self.space else [f"x{i + 1}" for i in range(len(self.bases_))]
        return ":".join(names[i] + (f"^{q}" if q > 1 else "") for i, q in index) or "1"

    def _matrix(self, X: Array) -> Array:
        return products(self.indices_, [one.values(X[:, i]) for i, one in enumerate(self.bases_)])

    def minimum_runs(self, space: Space) -> int:
        """Runs that a fit needs: three, for a leave-one-out error."""
        return 3

    def predict(self, X: ArrayLike) -> Array:
        """Values (m,) at coded X (m, d)."""
        check_is_fitted(self)
        points = validate_data(self, X, reset=False)
        return np.asarray(self._matrix(points) @ self.coef_)

    def leave_one_out(self) -> Array:
        """Predictions (n,) of each run without it, the choice of terms kept."""
        return self.model_.leave_one_out()

    def sobol_indices(self, groups: Groups | None = None) -> anova.SobolIndices:
        """Sobol' indices: sums of squared coefficients (Sudret 2008, equations 38 to 43).

        Of inputs or groups; an input in no group then counts as one by itself.
        """
        check_is_fitted(self)
        anova.quadratures(self.space, len(self.bases_), 1)  # raises when inputs are correlated
        kept = [[i] for i in range(len(self.bases_))] if groups is None else groups
        grouped = [
            *kept,
            *([i] for i in range(len(self.bases_)) if not any(i in group for group in kept)),
        ]
        of = {i: g for g, group in enumerate(grouped) for i in group}
        size = len(grouped)
        first, total, second = np.zeros(size), np.zeros(size), np.zeros((size, size))
        parts = self.coef_**2
        for index, part in zip(self.indices_, parts, strict=True):
            inputs = list(dict.fromkeys(of[i] for i, _ in index))
            total[inputs] += part
            if len(inputs) == 1:
                first[inputs] += part
            elif len(inputs) == 2:
                second[inputs, inputs[::-1]] += part
        # The constant is always the first of the chosen terms.
        variance = float(parts[1:].sum())
        share = 1.0 / variance if variance > 0.0 else 0.0
        own = slice(len(kept))
        return anova.SobolIndices(
            first[own] * share,
            total[own] * share,
            second[own, own] * share,
            variance,
            float(self.coef_[0]),
        )

    def portable(self) -> dict[str, Any]:
        """JSON-able description; see `surrogate.regressors.portable`."""
        check_is_fitted(self)
        return {
            "kind": "chaos",
            "bases": [_described(one) for one in self.bases_],
            "terms": [
                {"coefficient": float(c), "degrees": [list(part) for part in index]}
                for c, index in zip(self.coef_, self.indices_, strict=True)
            ],
        }


def _sizes(bases: list[Basis]) -> tuple[tuple[int, ...], ...]:
    return tuple(tuple(one.degree(number) for number in range(1, len(one))) for one in bases)


def _described(one: Basis) -> dict[str, Any]:
    if one.contrasts is not None:
        return {"levels": len(one.contrasts), "values": one.contrasts.tolist()}
    return {"alpha": one.alpha.tolist(), "beta": one.beta.tolist()}


def pursue(matrix: Array, y: Array, steps: int) -> list[int]:
    """Columns of matrix (n, p) in the order of orthogonal least squares, the first one first.

    Squared norms and products with y of all columns, less their parts along those taken,
    are kept up to date by one matrix-vector product a step, O(n p). Of columns that gain the
    same but for rounding, as aliased terms do, the first one is taken.
    """
    squares, along = (matrix**2).sum(axis=0), y @ matrix
    floor = 1e-10 * squares + 1e-300
    taken, basis = [], np.empty((len(y), steps))
    for k in range(steps):
        gains = np.where(squares > floor, along**2 / np.maximum(squares, floor), -1.0)
        column = int(np.argmax(gains >= (1.0 - 1e-9) * gains.max())) if k else 0
        if gains[column] <= 0.0 and k:
            break
        direction = matrix[:, column].copy()
        for _ in range(2):
            direction -= basis[:, :k] @ (basis[:, :k].T @ direction)
        basis[:, k] = direction / np.linalg.norm(direction)
        shadow = basis[:, k] @ matrix
        squares, along = squares - shadow**2, along - (basis[:, k] @ y) * shadow
        squares[column] = 0.0
        taken.append(column)
    return taken


def best_count(matrix: Array, y: Array, folds: NDArray[np.intp]) -> tuple[int, float]:
    """Number of terms with the smallest mean squared error on folds (n,), and that error.

    The error is a share of the variance. For each fold the terms are chosen without it.
    """
    steps = min(
        int(np.min([(folds != k).sum() for k in np.unique(folds)])) - 1, matrix.shape[1], TERMS
    )
    squares = np.zeros(max(steps, 1))
    for fold in np.unique(folds):
        inside = folds == fold
        order = pursue(matrix[~inside], y[~inside], len(squares))
        errors = _path_errors(matrix[:, order], y, inside)
        squares[: len(order)] += errors
        squares[len(order) :] += errors[-1]
    count = int(squares.argmin()) + 1
    total = float(((y - y.mean()) ** 2).sum())
    varies = total > 1e-28 * float(y @ y)  # by more than rounding
    return count, float(squares[count - 1]) / total if varies else 1.0


def _path_errors(matrix: Array, y: Array, inside: NDArray[np.bool_]) -> Array:
    """Squared error (k,) on the fold `inside` of fits by the first 1, 2, ... k columns."""
    basis, upper = np.linalg.qr(matrix[~inside])
    rotated = linalg.solve_triangular(upper, matrix[inside].T, trans="T").T
    predicted = np.cumsum(rotated * (basis.T @ y[~inside]), axis=1)
    return np.asarray(((y[inside, None] - predicted) ** 2).sum(axis=0))
