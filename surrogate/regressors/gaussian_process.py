"""Gaussian process regression (kriging) with a product Matern 5/2 kernel.

The trend's coefficients and the process variance are integrated out (universal
kriging); lengths and nugget maximise restricted likelihood times prior. Santner, Williams,
Notz, The Design and Analysis of Computer Experiments (2nd ed. 2018), chapters 3, 4.
"""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from itertools import product
from typing import Any, Literal, Self, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import linalg
from sklearn.base import BaseEstimator, RegressorMixin
from sklearn.utils.validation import check_is_fitted, validate_data

from surrogate.counting import counted
from surrogate.errors import nearest
from surrogate.estimator import Groups
from surrogate.regressors import anova, paths, portable
from surrogate.regressors.columns import columns_of, expand
from surrogate.regressors.joint import joint
from surrogate.regressors.kriging import Factored, factored, left_out_errors
from surrogate.regressors.length_search import Search, guesses
from surrogate.regressors.likelihood import Posterior
from surrogate.regressors.matern import blocks, correlation, weighted_sum
from surrogate.regressors.polynomial import Term, design_matrix, linear_terms
from surrogate.space.space import Space

Array = NDArray[np.float64]

#: Coded inputs span 2: below the lower bound neighbouring runs of any affordable design are
#: unrelated, above the upper one an input is a straight line or plays no part.
LENGTHS = (0.05, 50.0)
#: Nugget as a share of the process variance: from what rounding allows (smaller ones make
#: weights that lose ten digits) to as much noise as signal.
NUGGETS = (1e-8, 1.0)
TRENDS = ("constant", "linear")
#: Above this number of runs guesses are tried on a part of the runs.
SUBSET = 300
#: Up to this number of runs a left-out fold has its own lengths and nugget.
REFIT = 200
#: Relative change of the deviance at which a search ends: of the fit, and of a refit to
#: most of the runs, whose lengths need fewer digits.
FINE, ROUGH = 2e-9, 1e-6
#: The same for one of many outputs: a thousandth of -2 log posterior.
FINE_OF_MANY, ROUGH_OF_MANY = 1e-5, 1e-4
#: The same above `SUBSET` runs, whose deviance is a number in the thousands.
FINE_OF_LARGE = 1e-7
#: Of many outputs those that hold this share of the variance, and at least so many, are searched
#: for one by one, of the fit and of a refit; the others take the most probable lengths seen.
LEADING, LEADING_AGAIN = (0.98, 20), (0.9, 5)
QUADRATURE = 96


class GaussianProcess(RegressorMixin, BaseEstimator):
    """Kriging on coded inputs.

    trend   "constant" or "linear"
    nugget  variance of a run about the process, as a share of the process variance:
            "estimate", or a number (a tiny one, 1e-8, makes it interpolate)
    starts  local searches for the posterior's maximum
    seed    of the starts
    space   the Space of the inputs; None for numeric inputs uniform on [-1, 1]

    Fitted: `lengths_` (c,) in coded units, `nugget_`, `variance_` in the output's unit
    squared, `trend_` (q,), `weights_` (n,) of standardised values, `factors_` (`kriging.Factored`).
    """

    def __init__(
        self,
        trend: str = "constant",
        nugget: str | float = "estimate",
        starts: int = 3,
        seed: int = 0,
        space: Space | None = None,
    ) -> None:
        self.trend = trend
        self.nugget = nugget
        self.starts = starts
        self.seed = seed
        self.space = space

    def fit(self, X: ArrayLike, y: ArrayLike) -> Self:
        """Fit to coded points X (n, d) and values y (n,)."""
        self._take(X, y)
        logs = guesses(self._bounds(), self.seed)
        if self.scale_ > 0.0:
            logs = self._search(self.standard_[:, None], logs, 1, max(self.starts, 1), FINE)
        self._set(logs[0], self._factored(logs[0]))
        return self

    def condition(self, X: ArrayLike, y: ArrayLike, logs: Array) -> Self:
        """Fit to points X (n, d) and values y (n,) with log lengths and log nugget (c + 1,).

        No search: `logs_` of a process that was fitted to nearly the same runs.
        """
        self._take(X, y)
        self._set(np.asarray(logs, dtype=float), self._factored(logs))
        return self

    def fit_many(self, X: ArrayLike, Y: ArrayLike) -> list[GaussianProcess]:
        """Processes of outputs Y (n, k) of the same runs X (n, d), whose searches share places."""
        models = self._taken(X, np.asarray(Y))
        Y = np.column_stack([model.standard_ for model in models])
        leading, first = _leading(models, *LEADING), models[0]
        start = guesses(first._bounds(), self.seed)
        return _settled(models, first._search(Y, start, leading, 1, FINE_OF_MANY))

    def refit_many(
        self, near: list[GaussianProcess], X: ArrayLike, Y: ArrayLike
    ) -> list[GaussianProcess]:
        """Processes of outputs Y (n, k) of other runs of nearly the same functions.

        near  fitted processes, k of them or fewer

        Each takes the most probable of their lengths and nuggets, and those of leading outputs
        are searched for from there; above `REFIT` runs they are kept, output by output.
        """
        models = self._taken(X, np.asarray(Y))
        places = np.array([model.logs_ for model in near])
        if len(models[0].points_) > REFIT:
            return _settled(models, places[np.minimum(np.arange(len(models)), len(near) - 1)])
        Y = np.column_stack([model.standard_ for model in models])
        leading = _leading(models, *LEADING_AGAIN)
        return _settled(
            models, models[0]._search(Y, np.unique(places, axis=0), leading, 1, ROUGH_OF_MANY)
        )

    def _taken(self, X: ArrayLike, Y: Array) -> list[GaussianProcess]:
        """A process for each output, with runs but without lengths."""
        self._take(X, Y[:, 0])
        models = [copy(self) for _ in Y.T]
        for model, y in zip(models, Y.T, strict=True):
            model._standardise(y)
        return models

    def _take(self, X: ArrayLike, y: ArrayLike) -> None:
        """Runs in numeric columns and standardised values."""
        points, outputs = validate_data(self, X, y, y_numeric=True, ensure_min_samples=2)
        self._check()
        self.columns_ = columns_of(self.space, points.shape[1])
        self.points_ = expand(points, self.columns_)
        self._standardise(outputs)

    def _standardise(self, y: Array) -> None:
        self.offset_, self.scale_ = float(y.mean()), float(y.std())
        if self.scale_ <= 1e-14 * np.abs(y).max():
            self.scale_ = 0.0
        self.standard_ = (y - self.offset_) / (self.scale_ or 1.0)

    def _check(self) -> None:
        if self.trend not in TRENDS:
            raise ValueError(f"trend '{self.trend}': {nearest(self.trend, TRENDS)}")
        if self.nugget != "estimate" and (isinstance(self.nugget, str) or not self.nugget > 0):
            raise ValueError(
                f"nugget {self.nugget}: give 'estimate' or a number above 0, such as 1e-8"
            )

    def trend_columns(self, points: Array) -> Array:
        """F (n, q): ones, and the columns for a linear trend."""
        return design_matrix(self._trend_terms(), points)

    def _checked_trend(self, points: Array) -> Array:
        """F (n, q) of training points, which must determine the trend."""
        F = self.trend_columns(points)
        if len(F) <= F.shape[1] or np.linalg.matrix_rank(F) < F.shape[1]:
            raise ValueError(
                f"{len(F)} runs cannot determine a {self.trend} trend with "
                f"{F.shape[1]} coefficients; add runs or use trend: constant"
            )
        return F

    def _trend_terms(self) -> list[Term]:
        return linear_terms(self.columns_) if self.trend == "linear" else [()]

    def minimum_runs(self, space: Space) -> int:
        """Runs that a fit needs: two more than the trend has coefficients."""
        return 2 + (
            len(linear_terms(columns_of(space, space.size))) if self.trend == "linear" else 1
        )

    def _bounds(self) -> Array:
        """Bounds of log lengths and log nugget, (c + 1, 2)."""
        nugget = NUGGETS if self.nugget == "estimate" else (self.nugget, self.nugget)
        return np.log([LENGTHS] * self.points_.shape[1] + [nugget])

    def _search(self, y: Array, start: Array, leading: int, starts: int, end: float) -> Array:
        """Most probable log lengths and log nugget found of each output of y (n, outputs)."""
        n = len(self.points_)
        if n > SUBSET:
            chosen = np.random.default_rng(self.seed).permutation(n)[:SUBSET]
            found = self._local(chosen, y, start, leading, starts, end)
            start, starts, end = np.unique(found, axis=0), 1, max(end, FINE_OF_LARGE)
        return self._local(np.arange(n), y, start, leading, starts, end)

    def _local(
        self,
        chosen: NDArray[np.intp],
        y: Array,
        start: Array,
        leading: int,
        starts: int,
        end: float,
    ) -> Array:
        points = self.points_[chosen]
        posterior = Posterior(points, self._checked_trend(points), y[chosen])
        search = Search(posterior, self._bounds())
        search.judge(start)
        for output in counted("mode", range(leading)):
            search.descend(output, starts, end)
        return search.found()

    def _factored(self, logs: Array) -> Factored:
        matrix = correlation(self.points_, self.points_, np.exp(logs[:-1]))
        np.fill_diagonal(matrix, 1.0 + np.exp(logs[-1]))
        return factored(matrix, self._checked_trend(self.points_))

    def _set(self, logs: Array, factors: Factored) -> None:
        self.logs_, self.factors_ = logs, factors
        self.found_: dict[Any, anova.SobolIndices] = {}
        self.lengths_, self.nugget_ = np.exp(logs[:-1]), float(np.exp(logs[-1]))
        self.weights_ = factors.weights(self.standard_)
        self.trend_ = factors.trend(self.standard_)
        self.variance_ = self.scale_**2 * float(factors.variance(self.standard_, self.weights_))

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
        self, models: Sequence[GaussianProcess], X: ArrayLike, return_std: bool = False
    ) -> Array | tuple[Array, Array]:
        """Values (m, k) of processes of the same runs; with standard deviations (m, k)."""
        check_is_fitted(self)
        points = self.expanded(X)
        F, mean = self.trend_columns(points), np.empty((len(points), len(models)))
        std = np.empty_like(mean) if return_std else mean
        for own in _alike(models):
            some, first = [models[k] for k in own], models[own[0]]
            weights = np.column_stack([model.weights_ for model in some])
            if return_std:
                sums, variance = first._sums_and_variance(points, weights)
                std[:, own] = np.sqrt(np.outer(variance, [model.variance_ for model in some]))
            else:
                sums = weighted_sum(points, first.points_, first.lengths_, weights)
            sums += F @ np.column_stack([model.trend_ for model in some])
            offsets, scales = np.array([(model.offset_, model.scale_) for model in some]).T
            mean[:, own] = offsets + scales * sums
        return (mean, std) if return_std else mean

    def predict_joint(self, X: ArrayLike) -> tuple[Array, Array]:
        """Means (m, n) and covariances (m, n, n) of new runs at m sets of n coded points."""
        check_is_fitted(self)
        return joint(self, np.asarray(X, dtype=float))

    def expanded(self, X: ArrayLike) -> Array:
        """Numeric columns (m, c) of coded points (m, d)."""
        return expand(validate_data(self, X, reset=False), self.columns_)

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
        variance += 1.0 + self.nugget_
        return sums, np.maximum(variance, self.nugget_)

    def leave_one_out(self) -> Array:
        """Predictions (n,) of each run without it, lengths and nugget kept (Dubrule 1983)."""
        return self._closed(np.arange(len(self.points_)))

    def leave_out(self, folds: ArrayLike) -> Array:
        """Predictions (n,) of each run without its fold (n,).

        Up to `REFIT` runs lengths and nugget are estimated anew without the fold, from
        those of all runs; above, where a fold hardly moves them, they are kept.
        """
        folds = np.asarray(folds)
        if self.scale_ == 0.0 or len(self.points_) > REFIT:
            return self._closed(folds)
        result = np.full(len(folds), np.nan)
        for fold in counted("fold", np.unique(folds).tolist()):
            inside = folds == fold
            try:
                result[inside] = self._without(inside)
            except ValueError:
                continue  # the rest cannot support the trend: stays NaN
        return result

    def _without(self, inside: NDArray[np.bool_]) -> Array:
        """Predictions (k,) of the runs `inside` by a process fitted to the others."""
        other = type(self)(**self.get_params(deep=False))
        other.columns_, other.points_ = self.columns_, self.points_[~inside]
        other.standard_, other.scale_ = self.standard_[~inside], self.scale_
        logs = other._search(other.standard_[:, None], self.logs_[None], 1, 1, ROUGH)[0]
        other._set(logs, other._factored(logs))
        points = self.points_[inside]
        return self.offset_ + self.scale_ * (
            other.trend_columns(points) @ other.trend_
            + weighted_sum(points, other.points_, other.lengths_, other.weights_)
        )

    def _closed(self, folds: NDArray[np.intp]) -> Array:
        errors = left_out_errors(self.factors_, self.weights_, folds)
        return self.offset_ + self.scale_ * (self.standard_ - errors)

    def posterior_draws(self, size: int, seed: int | None = None) -> list[paths.Draw]:
        """Functions that are as plausible as the mean, given the runs.

        Each offers `predict(X)` and `sobol_indices()`; see `surrogate.regressors.paths`.
        """
        check_is_fitted(self)
        drawn = paths.draw(self, size, seed)
        return [paths.Draw(drawn, number) for number in range(size)]

    def sobol_indices(self, groups: Groups | None = None) -> anova.SobolIndices:
        """Sobol' indices of the mean under the space's law, of inputs or groups; exact.

        Rounding grows with the weights: 1e-11 for a hundred smooth runs, 1e-5 for five hundred.
        """
        return self.sobol_indices_of_many([self], groups)[0]

    def sobol_indices_of_many(
        self, models: Sequence[GaussianProcess], groups: Groups | None = None
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
        self, models: Sequence[GaussianProcess], groups: Groups | None
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
            "variance": self.variance_,
            "nugget": self.nugget_,
            "lengths": self.lengths_.tolist(),
            "points": self.points_.tolist(),
            "weights": self.weights_.tolist(),
            "trend": [
                {"coefficient": float(c), "powers": [list(part) for part in term]}
                for c, term in zip(self.trend_, self._trend_terms(), strict=True)
            ],
        }


def _alike(models: Sequence[GaussianProcess]) -> list[list[int]]:
    """Numbers of the processes that share factors: they have the same runs, lengths and nugget."""
    alike: dict[int, list[int]] = {}
    for k, model in enumerate(models):
        alike.setdefault(id(model.factors_), []).append(k)
    return list(alike.values())


def _leading(models: list[GaussianProcess], share: float, least: int) -> int:
    """How many outputs, in their order, hold this share of the variance of all."""
    held = np.cumsum([model.scale_**2 for model in models])
    return min(max(int(np.searchsorted(held, share * held[-1])) + 1, least), len(models))


def _settled(models: list[GaussianProcess], places: Array) -> list[GaussianProcess]:
    """Processes with their log lengths and log nuggets (k, c + 1); equal ones share factors."""
    known: dict[bytes, Factored] = {}
    for model, logs in zip(models, places, strict=True):
        if (key := logs.tobytes()) not in known:
            known[key] = model._factored(logs)
        model._set(logs, known[key])
    return models
