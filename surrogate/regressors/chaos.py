"""Sparse polynomial chaos: orthonormal polynomials, the few that matter.

Terms are taken one by one by orthogonal least squares (Chen, Billings, Luo 1989), the
one that reduces the residual most. Truncation, degree and number of terms are those with
the smallest error on folds for which the terms were chosen anew. The leave-one-out error
with the terms kept (Blatman and Sudret 2011) is in closed form, but as a judge of the
choice it is too kind: on noisy runs it took as many terms as it was allowed.

Above `MANY` runs all of this is done on sums of products, see `moments`: terms are chosen with
`CHOOSING` of the runs, and fitted to all of them; one truncation is tried.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import chain
from typing import Any, NamedTuple, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import linalg
from sklearn.base import BaseEstimator, RegressorMixin
from sklearn.utils.metaestimators import available_if
from sklearn.utils.validation import check_is_fitted, validate_data

from surrogate.estimator import Groups
from surrogate.regressors import anova
from surrogate.regressors.least_squares import LeastSquares, least_squares
from surrogate.regressors.moments import FitOfMany, fit_of_many, moments, path, predicted, total
from surrogate.regressors.moments import best_count as best_count_of_many
from surrogate.regressors.orthogonal import Basis, Index, Rows, basis, hyperbolic, products
from surrogate.regressors.pursuit import TERMS, best_count, pursue
from surrogate.space.space import Space

Array = NDArray[np.float64]

#: Truncations that are tried: few interactions to all of a total degree; and that of many runs.
TRUNCATIONS, OF_MANY = (0.5, 0.75, 1.0), 0.75
#: Larger sets of candidate terms are not tried.
CANDIDATES = 5000
#: Degrees tried without a smaller error before the search ends; functions with a symmetry
#: gain only at every other one.
PATIENCE = 4
FOLDS = 5
#: Above so many runs only sums of products are kept, which cost half of the digits.
MANY = 1000
#: Of many runs so many choose the terms, of this many candidates at most: the time of the sums
#: grows with runs times candidates squared.
CHOOSING, CANDIDATES_OF_MANY = 10_000, 2500


#: Offered by a fit of many runs only.
_of_many: Callable[[Callable[..., Any]], Any] = available_if(
    lambda chaos: isinstance(getattr(chaos, "model_", None), FitOfMany)
)


class Choice(NamedTuple):
    """Terms of an expansion, the truncation and degree that they are of, its error on folds."""

    indices: tuple[Index, ...]
    hyperbolic: float
    degree: int
    error: float


class PolynomialChaos(RegressorMixin, BaseEstimator):
    """Sparse polynomial chaos expansion on coded inputs.

    max_degree  largest polynomial degree tried
    hyperbolic  0 < q <= 1 of the truncation; smaller means fewer interactions; None chooses
    seed        of the folds that choose truncation, degree and terms
    space       the Space of the inputs, whose laws the polynomials are orthonormal for;
                None for inputs uniform on [-1, 1]

    Fitted: `indices_` (which product each term is), `coef_` (p,), `degree_`, `hyperbolic_`,
    `model_` (`LeastSquares` of the chosen terms, of many runs `moments.FitOfMany`),
    `error_` (mean squared error on the folds of the choice, a share of the variance).
    """

    def __init__(
        self,
        max_degree: int = 10,
        hyperbolic: float | None = None,
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
        own = self.hyperbolic
        if not (self.max_degree >= 1 and (own is None or 0.0 < own <= 1.0)):
            raise ValueError(
                f"max_degree {self.max_degree} must be 1 or more and hyperbolic "
                f"{own} above 0 and at most 1"
            )
        parameters = self.space.parameters if self.space else [None] * points.shape[1]
        self.bases_ = [basis(parameter, self.max_degree) for parameter in parameters]
        self.model_: LeastSquares | FitOfMany
        if len(outputs) > MANY:
            chosen = self._select_of_many(points, outputs)
        else:
            chosen = self._select(points, outputs)
        self.indices_, self.hyperbolic_, self.degree_, self.error_ = chosen
        if len(outputs) > MANY:
            self.model_ = fit_of_many(self._rows(self.indices_), points, outputs)
        else:
            names = [self._name(index) for index in self.indices_]
            self.model_ = least_squares(self._matrix(points), outputs, names)
        self.coef_ = self.model_.coefficients
        return self

    def _select(self, X: Array, y: Array) -> Choice:
        """The best expansion, over truncations and degrees from 1 up."""
        values = [one.values(X[:, i]) for i, one in enumerate(self.bases_)]
        folds = np.random.default_rng(self.seed).permutation(np.arange(len(y)) % FOLDS)
        known: dict[tuple[Index, ...], tuple[int, float]] = {}
        best = Choice(((),), self.hyperbolic or TRUNCATIONS[0], 0, 1.0)
        count = 1
        for truncation in TRUNCATIONS if self.hyperbolic is None else (self.hyperbolic,):
            smallest, at = 1.0, 0
            for degree in range(1, self.max_degree + 1):
                indices = self._candidates(degree, truncation)
                if len(indices) > CANDIDATES or degree > at + PATIENCE:
                    break
                if indices not in known:
                    known[indices] = best_count(products(indices, values), y, folds)
                terms, error = known[indices]
                if error < smallest * (1.0 - 1e-9):
                    smallest, at = error, degree
                if error < best.error * (1.0 - 1e-9):
                    best, count = Choice(indices, truncation, degree, error), terms
        order = pursue(products(best.indices, values), y, count)
        return best._replace(indices=tuple(best.indices[j] for j in sorted(order)))

    def _select_of_many(self, X: Array, y: Array) -> Choice:
        """The best expansion of one truncation, on sums of products over some runs."""
        X, y = self._choosing(X, y - y.mean())
        folds = np.random.default_rng(self.seed).permutation(np.arange(len(y)) % FOLDS)
        truncation = self.hyperbolic or OF_MANY
        best, reach = Choice(((),), truncation, 0, 1.0), 0
        for degree in range(1, self.max_degree + 1):
            indices = self._candidates(degree, truncation)
            if len(indices) > CANDIDATES_OF_MANY or degree > best.degree + PATIENCE:
                break
            if degree > reach:
                reach = self._reach(best.degree + PATIENCE, truncation)
                known = self._candidates(reach, truncation)
                sums = moments(self._rows(known), X, y, folds)
                places = {index: place for place, index in enumerate(known)}
            own = [one.of([places[index] for index in indices]) for one in sums]
            count, error = best_count_of_many(own, TERMS)
            if error < best.error * (1.0 - 1e-9):
                order = path(total(own), count).order
                chosen = tuple(indices[j] for j in sorted(order))
                best = Choice(chosen, truncation, degree, error)
        return best

    def _reach(self, degree: int, truncation: float) -> int:
        """The largest degree up to this one that is tried with many runs."""
        degrees = range(1, min(degree, self.max_degree) + 1)
        return max(d for d in degrees if len(self._candidates(d, truncation)) <= CANDIDATES_OF_MANY)

    def _candidates(self, degree: int, truncation: float) -> tuple[Index, ...]:
        return hyperbolic(_sizes(self.bases_), degree, truncation)

    def _choosing(self, *columns: NDArray[Any]) -> list[NDArray[Any]]:
        """The runs that choose the terms, of each array (n, ...)."""
        n = len(columns[0])
        if n <= CHOOSING:
            return list(columns)
        rows = np.random.default_rng(self.seed).permutation(n)[:CHOOSING]
        return [column[rows] for column in columns]

    def _name(self, index: Index) -> str:
        """`1`, `tension`, `tension^2:mu_skin`: the leading power of each polynomial."""
        names = self.space.names if self.space else [f"x{i + 1}" for i in range(len(self.bases_))]
        return ":".join(names[i] + (f"^{q}" if q > 1 else "") for i, q in index) or "1"

    def _rows(self, indices: tuple[Index, ...]) -> Rows:
        return Rows(tuple(self.bases_), indices)

    def _matrix(self, X: Array) -> Array:
        return self._rows(self.indices_)(X)

    def minimum_runs(self, space: Space) -> int:
        """Runs that a fit needs: three, for a leave-one-out error."""
        return 3

    def predict(self, X: ArrayLike) -> Array:
        """Values (m,) at coded X (m, d)."""
        check_is_fitted(self)
        points = validate_data(self, X, reset=False)
        return predicted(self._rows(self.indices_), points, self.coef_)

    def leave_one_out(self) -> Array:
        """Predictions (n,) of each run without it, the choice of terms kept."""
        return self.model_.leave_one_out()

    @_of_many
    def leave_out(self, folds: ArrayLike) -> Array:
        """Predictions (n,) of each run without its fold (n,), for many runs.

        The terms are chosen anew without the fold; degree and number of terms are kept.
        """
        check_is_fitted(self)
        many = self.model_
        assert isinstance(many, FitOfMany)
        X, y = many.points, many.y
        _, numbers = np.unique(np.asarray(folds), return_inverse=True)
        numbers, middle = numbers.ravel(), y.mean()
        candidates = self._candidates(max(self.degree_, 1), self.hyperbolic_)
        sums = moments(self._rows(candidates), *self._choosing(X, y - middle, numbers))
        whole, count = total(sums), len(self.indices_)
        orders = [path(whole.without(one), count).order for one in sums]
        taken = sorted(set(chain.from_iterable(orders)))
        rows = self._rows(tuple(candidates[j] for j in taken))
        places = {term: place for place, term in enumerate(taken)}
        sums = moments(rows, X, y - middle, numbers)
        whole, result = total(sums), np.empty(len(y))
        for fold, (one, order) in enumerate(zip(sums, orders, strict=True)):
            kept = [places[term] for term in order]
            rest, inside = whole.without(one).of(kept), numbers == fold
            coefficients = linalg.solve(rest.products, rest.along, assume_a="pos")
            terms = self._rows(tuple(candidates[j] for j in order))
            result[inside] = middle + predicted(terms, X[inside], coefficients)
        return result

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
