"""What a Gaussian process says, given its runs, lengths and nugget.

The trend's coefficients and the process variance are integrated out (universal kriging).
Santner, Williams, Notz, The Design and Analysis of Computer Experiments (2nd ed. 2018),
sections 3.2 and 4.1. How lengths and nugget are found: `gaussian_process`.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from typing import Any, Literal, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import linalg
from sklearn.base import BaseEstimator, RegressorMixin
from sklearn.utils.validation import check_is_fitted, validate_data

from surrogate.estimator import Groups
from surrogate.regressors import anova, paths, portable
from surrogate.regressors.columns import Column, Term, expand
from surrogate.regressors.joint import joint
from surrogate.regressors.kriging import Factored, factored
from surrogate.regressors.matern import blocks, correlation, weighted_sum
from surrogate.regressors.polynomial import design_matrix, linear_terms
from surrogate.space.space import Space

Array = NDArray[np.float64]

QUADRATURE = 96


class FittedProcess(RegressorMixin, BaseEstimator):
    """Predictions, draws and indices of a process.

    columns_, points_ (n, c)       of its runs
    standard_, offset_, scale_     values (n,) = offset_ + scale_ * standard_
    lengths_ (c,), nugget_         in coded units; `logs_` (c + 1,) are the logarithms of both
    noise_ (n,)                    variance of each run about the process, in nuggets: 1 unless
                                   noise depends on the place
    weights_ (n,), trend_ (q,)     of standardised values;  factors_  `kriging.Factored`
    variance_                      of the process, in the output's unit squared
    widening_                      factor of deviations, 1 or more, see `gaussian_process`
    """

    trend: str
    space: Space | None
    n_features_in_: int
    columns_: tuple[Column, ...]
    points_: Array
    standard_: Array
    offset_: float
    scale_: float
    widening_: float
    noise_: Array

    def noise_at(self, points: Array) -> Array:
        """Variance (m,) of new runs about the process at numeric columns (m, c), in nuggets."""
        return np.ones(len(points))

    def trend_columns(self, points: Array) -> Array:
        """F (n, q): ones, and the columns for a linear trend."""
        return design_matrix(self._trend_terms(), points)

    def _checked_trend(self, points: Array) -> Array:
        """F (n, q) of training points, which must determine the trend."""
        F = self._trend_of_runs(points)
        if len(F) <= F.shape[1] or np.linalg.matrix_rank(F) < F.shape[1]:
            raise ValueError(f"{len(F)} runs cannot determine {self._undetermined(F.shape[1])}")
        return F

    def _trend_of_runs(self, points: Array) -> Array:
        """F (n, q) of training points."""
        return self.trend_columns(points)

    def _undetermined(self, size: int) -> str:
        """What too few runs cannot determine, and the cure."""
        return f"a {self.trend} trend with {size} coefficients; add runs or use trend: constant"

    def _trend_terms(self) -> list[Term]:
        return linear_terms(self.columns_) if self.trend == "linear" else [()]

    def _factored(self, logs: Array) -> Factored:
        matrix = correlation(self.points_, self.points_, np.exp(logs[:-1]))
        np.fill_diagonal(matrix, 1.0 + np.exp(logs[-1]) * self.noise_)
        return factored(matrix, self._checked_trend(self.points_))

    def _set(self, logs: Array, factors: Factored) -> None:
        self.logs_, self.factors_ = logs, factors
        self.found_: dict[Any, anova.SobolIndices] = {}
        self.lengths_, self.nugget_ = np.exp(logs[:-1]), float(np.exp(logs[-1]))
        self.weights_ = factors.weights(self.standard_)
        self.trend_ = factors.trend(self.standard_)
        self.variance_ = self.scale_**2 * float(factors.variance(self.standard_, self.weights_))
        self.widening_ = 1.0

    @property
    def predictive_variance(self) -> float:
        """Variance of the process that deviations, draws and documents go by."""
        return self.variance_ * self.widening_**2

    @property
    def interval_freedom(self) -> int:
        """Degrees of freedom n - q of the t distribution of predictions (variance unknown)."""
        return len(self.points_) - len(self.trend_)

    @overload
    def predict(self, X: ArrayLike, return_std: Literal[False] = False) -> Array: ...
    @overload
    def predict(self, X: ArrayLike, return_std: Literal[True]) -> tuple[Array, Array]: ...
    def predict(self, X: ArrayLike, return_std: bool = False) -> Array | tuple[Array, Array]:
        """Values (m,) at coded X (m, d); with the standard deviation of a new run."""
        found = self.predict_many([self], X, return_std)
        return (found[0][:, 0], found[1][:, 0]) if isinstance(found, tuple) else found[:, 0]

    def predict_many(
        self, models: Sequence[FittedProcess], X: ArrayLike, return_std: bool = False
    ) -> Array | tuple[Array, Array]:
        """Values (m, k) of processes of the same runs; with standard deviations (m, k)."""
        check_is_fitted(self)
        return predicted(models, self.expanded(X), return_std)

    def predict_joint(self, X: ArrayLike) -> tuple[Array, Array]:
        """Means (m, n) and covariances (m, n, n) of new runs at m sets of n coded points."""
        check_is_fitted(self)
        return joint(self, np.asarray(X, dtype=float))

    def expanded(self, X: ArrayLike) -> Array:
        """Numeric columns (m, c) of coded points (m, d)."""
        return expand(validate_data(self, X, reset=False), self.columns_)

    def unscaled(self, standard: Array) -> Array:
        """Values of standardised ones, of any shape."""
        return self.offset_ + self.scale_ * standard

    def _sums_and_variance(self, points: Array, weights: Array) -> tuple[Array, Array]:
        """Weighted sums (m, k) of correlations, and a new run's variance (m,), process's 1.

        Santner et al. 2018, equation 3.2.8: the correlations r with the runs explain r' R^-1 r.
        """
        one, unit = self.factors_, 3.0 ** len(self.lengths_)
        sums, variance = np.empty((len(points), weights.shape[1])), np.empty(len(points))
        for part, block in blocks(points, self.points_, self.lengths_):
            block /= unit
            sums[part] = block @ weights
            rest = self.trend_columns(points[part]) - block @ one.solved
            explained = linalg.blas.dtrsm(1.0, one.factor, block.T, lower=1, overwrite_b=1).T
            variance[part] = np.einsum("ij,jk,ik->i", rest, one.gain, rest)
            variance[part] -= np.einsum("ij,ij->i", explained, explained)
        nuggets = self.nugget_ * self.noise_at(points)
        variance += 1.0 + nuggets
        return sums, np.maximum(variance, nuggets)

    def posterior_draws(self, size: int, seed: int | None = None) -> list[paths.Draw]:
        """Functions that are as plausible as the mean, given the runs.

        Each offers `predict(X)` and `sobol_indices()`; see `surrogate.regressors.paths`.
        """
        check_is_fitted(self)
        return paths.draws([self], size, seed)

    def sobol_indices(self, groups: Groups | None = None) -> anova.SobolIndices:
        """Sobol' indices of the mean under the space's law, of inputs or groups; exact.

        Rounding grows with the weights: 1e-11 for a hundred smooth runs, 1e-5 for five hundred.
        """
        return self.sobol_indices_of_many([self], groups)[0]

    def sobol_indices_of_many(
        self, models: Sequence[FittedProcess], groups: Groups | None = None
    ) -> list[anova.SobolIndices]:
        """Those of processes of the same runs, each found once; equal lengths are no more work."""
        check_is_fitted(self)
        asked = None if groups is None else tuple(map(tuple, groups))
        left = [model for model in models if asked not in model.found_]
        for own in _alike(left):
            some = [left[k] for k in own]
            for model, found in zip(some, some[0]._indices(some, asked), strict=True):
                model.found_[asked] = found
        return [model.found_[asked] for model in models]

    def _indices(
        self, models: Sequence[FittedProcess], groups: Groups | None
    ) -> list[anova.SobolIndices]:
        """Indices of processes of the same lengths as this one."""
        rules = anova.quadratures(self.space, self.n_features_in_, QUADRATURE)
        factors = [self.factor(j, nodes) for j, (nodes, _) in enumerate(rules)]
        coefficients = [model.scale_ * np.append(model.weights_, model.trend_) for model in models]
        found = anova.sobol_indices_of_many(
            np.column_stack(coefficients), factors, [w for _, w in rules], groups
        )
        return [
            anova.shifted(*pair) for pair in zip(found, (m.offset_ for m in models), strict=True)
        ]

    def own_columns(self, parameter: int, nodes: Array) -> tuple[list[int], Array]:
        """Numbers of one parameter's columns, and their values (m, own) at its nodes (m,)."""
        own = [j for j, column in enumerate(self.columns_) if column.parameter == parameter]
        none = np.empty((len(nodes), 0))  # of a parameter that follows from the others
        return own, np.column_stack([none, *(self.columns_[j].values(nodes) for j in own)])

    def factor(self, parameter: int, nodes: Array) -> Array:
        """Part of each term (n kernels, then q trend terms) that depends on one parameter."""
        own, values = self.own_columns(parameter, nodes)
        kernels = correlation(self.points_[:, own], values, self.lengths_[own])
        trend = np.ones((len(self.trend_), len(nodes)))
        for t, term in enumerate(self._trend_terms()):
            for (j, _), (k, column) in product(term, enumerate(own)):
                if column == j:
                    trend[t] = values[:, k]
        return np.vstack([kernels, trend])

    def portable(self) -> dict[str, Any]:
        """JSON-able description; see `surrogate.regressors.portable`."""
        check_is_fitted(self)
        return {
            "kind": "gaussian_process",
            "columns": portable.described_columns(self.columns_),
            "offset": self.offset_,
            "scale": self.scale_,
            "variance": self.predictive_variance,
            "nugget": self.nugget_,
            "lengths": self.lengths_.tolist(),
            "points": self.points_.tolist(),
            "weights": self.weights_.tolist(),
            "trend": [
                {"coefficient": float(c), "powers": [list(part) for part in term]}
                for c, term in zip(self.trend_, self._trend_terms(), strict=True)
            ],
        }


def predicted(
    models: Sequence[FittedProcess], points: Array, return_std: bool = False
) -> Array | tuple[Array, Array]:
    """Values (m, k) of processes of the same runs at column values (m, c); with deviations."""
    F, mean = models[0].trend_columns(points), np.empty((len(points), len(models)))
    std = np.empty_like(mean) if return_std else mean
    for own in _alike(models):
        some, first = [models[k] for k in own], models[own[0]]
        weights = np.column_stack([model.weights_ for model in some])
        if return_std:
            sums, variance = first._sums_and_variance(points, weights)
            std[:, own] = np.sqrt(np.outer(variance, [model.predictive_variance for model in some]))
        else:
            sums = weighted_sum(points, first.points_, first.lengths_, weights)
        sums += F @ np.column_stack([model.trend_ for model in some])
        offsets, scales = np.array([(model.offset_, model.scale_) for model in some]).T
        mean[:, own] = offsets + scales * sums
    return (mean, std) if return_std else mean


def _alike(models: Sequence[FittedProcess]) -> list[list[int]]:
    """Numbers of the processes that share factors: they have the same runs, lengths and nugget."""
    alike: dict[int, list[int]] = {}
    for k, model in enumerate(models):
        alike.setdefault(id(model.factors_), []).append(k)
    return list(alike.values())
