"""Gaussian process regression (kriging) with a product Matern 5/2 kernel.

The trend's coefficients and the process variance are integrated out (universal
kriging); lengths and nugget maximise restricted likelihood times prior. Santner, Williams,
Notz, The Design and Analysis of Computer Experiments (2nd ed. 2018), chapters 3, 4.
"""

from __future__ import annotations

from itertools import product

import numpy as np
from scipy import linalg, optimize
from sklearn.base import BaseEstimator, RegressorMixin
from sklearn.utils.validation import check_is_fitted, validate_data

from surrogate.errors import nearest
from surrogate.regressors import anova, paths, portable
from surrogate.regressors.columns import columns_of, expand
from surrogate.regressors.matern import Posterior, condition, correlation, weighted_sum
from surrogate.regressors.polynomial import design_matrix, linear_terms

#: Coded inputs span 2: below the lower bound neighbouring runs of any affordable design are
#: unrelated, above the upper one an input is a straight line or plays no part.
LENGTHS = (0.05, 50.0)
#: Nugget as a share of the process variance: from what rounding allows (smaller ones make
#: weights that lose ten digits) to as much noise as signal.
NUGGETS = (1e-8, 1.0)
TRENDS = ("constant", "linear")
#: Above this number of runs the starts are tried on a part of the runs.
SUBSET = 300
#: Up to this number of runs a left-out fold has its own lengths and nugget.
REFIT = 200
#: Relative change of the deviance at which a search ends: of the fit, and of a refit to
#: most of the runs, whose lengths need fewer digits.
FINE, ROUGH = 2e-9, 1e-6
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
    squared, `trend_` (q,), `state_` (`matern.Conditioned`, of standardised values).
    """

    def __init__(self, trend="constant", nugget="estimate", starts=3, seed=0, space=None):
        self.trend = trend
        self.nugget = nugget
        self.starts = starts
        self.seed = seed
        self.space = space

    def fit(self, X, y):
        """Fit to coded points X (n, d) and values y (n,)."""
        self._take(X, y)
        self._set(self._search(self._starts()))
        return self

    def refitted(self, X, y) -> GaussianProcess:
        """A process fitted to other runs of nearly the same function.

        One search, from this one's lengths and nugget; above `REFIT` runs they are kept.
        """
        check_is_fitted(self)
        other = GaussianProcess(**self.get_params(deep=False))
        other._take(X, y)
        few = len(other.points_) <= REFIT
        other._set(other._search(self.logs_[None], ROUGH) if few else self.logs_)
        return other

    def _take(self, X, y) -> None:
        """Runs in numeric columns and standardised values."""
        X, y = validate_data(self, X, y, y_numeric=True, ensure_min_samples=2)
        self._check(X)
        self.columns_ = columns_of(self.space, X.shape[1])
        self.points_ = expand(X, self.columns_)
        self.offset_, self.scale_ = float(y.mean()), float(y.std())
        if self.scale_ <= 1e-14 * np.abs(y).max():
            self.scale_ = 0.0
        self.standard_ = (y - self.offset_) / (self.scale_ or 1.0)

    def _check(self, X) -> None:
        if self.trend not in TRENDS:
            raise ValueError(f"trend '{self.trend}': {nearest(self.trend, TRENDS)}")
        if self.nugget != "estimate" and not (np.isreal(self.nugget) and self.nugget > 0):
            raise ValueError(
                f"nugget {self.nugget}: give 'estimate' or a number above 0, such as 1e-8"
            )

    def trend_columns(self, points: np.ndarray) -> np.ndarray:
        """F (n, q): ones, and the columns for a linear trend."""
        return design_matrix(self._trend_terms(), points)

    def _checked_trend(self, points: np.ndarray) -> np.ndarray:
        """F (n, q) of training points, which must determine the trend."""
        F = self.trend_columns(points)
        if len(F) <= F.shape[1] or np.linalg.matrix_rank(F) < F.shape[1]:
            raise ValueError(
                f"{len(F)} runs cannot determine a {self.trend} trend with "
                f"{F.shape[1]} coefficients; add runs or use trend: constant"
            )
        return F

    def _trend_terms(self) -> list:
        return linear_terms(self.columns_) if self.trend == "linear" else [()]

    def minimum_runs(self, space) -> int:
        """Runs that a fit needs: two more than the trend has coefficients."""
        return 2 + (
            len(linear_terms(columns_of(space, space.size))) if self.trend == "linear" else 1
        )

    def _bounds(self) -> np.ndarray:
        """Bounds of log lengths and log nugget, (c + 1, 2)."""
        nugget = NUGGETS if self.nugget == "estimate" else (self.nugget, self.nugget)
        return np.log([LENGTHS] * self.points_.shape[1] + [nugget])

    def _starts(self) -> np.ndarray:
        """First guesses (starts, c + 1): a middling one, then random ones."""
        rng = np.random.default_rng(self.seed)
        count, bounds = self.points_.shape[1], self._bounds()
        guesses = np.log(rng.uniform(0.3, 5.0, (max(self.starts, 1), count + 1)))
        guesses[0] = np.log(2.0)
        guesses[:, -1] = rng.uniform(np.log(1e-7), np.log(1e-2), len(guesses))
        guesses[0, -1] = np.log(1e-4)
        return np.clip(guesses, *bounds.T)

    def _search(self, starts: np.ndarray, end: float = FINE) -> np.ndarray:
        """Most probable log lengths and log nugget found."""
        if self.scale_ == 0.0:
            return starts[0]
        n = len(self.points_)
        if n > SUBSET:
            chosen = np.random.default_rng(self.seed).permutation(n)[:SUBSET]
            starts = self._local(chosen, starts, end)[None]
        return self._local(np.arange(n), starts, end)

    def _local(self, chosen: np.ndarray, starts: np.ndarray, end: float) -> np.ndarray:
        """Best end (c + 1,) of local searches on some runs from each start."""
        points = self.points_[chosen]
        posterior = Posterior(points, self._checked_trend(points), self.standard_[chosen])
        found = [
            optimize.minimize(
                posterior,
                start,
                jac=True,
                method="L-BFGS-B",
                bounds=self._bounds(),
                options={"maxiter": 200, "ftol": end},
            )
            for start in starts
        ]
        return min(found, key=lambda one: one.fun).x

    def _set(self, logs: np.ndarray) -> None:
        self.lengths_, self.nugget_ = np.exp(logs[:-1]), float(np.exp(logs[-1]))
        matrix = correlation(self.points_, self.points_, self.lengths_)
        np.fill_diagonal(matrix, 1.0 + self.nugget_)
        self.state_ = condition(matrix, self._checked_trend(self.points_), self.standard_)
        self.variance_ = self.scale_**2 * self.state_.variance
        self.trend_ = self.state_.trend
        self.logs_ = logs

    @property
    def interval_freedom(self) -> int:
        """Degrees of freedom n - q of the t distribution of predictions (variance unknown)."""
        return len(self.points_) - len(self.trend_)

    def predict(self, X, return_std=False):
        """Values (m,) at coded X (m, d); with the standard deviation of a new run."""
        check_is_fitted(self)
        points = self.expanded(X)
        F = self.trend_columns(points)
        mean = F @ self.trend_ + weighted_sum(
            points, self.points_, self.lengths_, self.state_.weights
        )
        mean = self.offset_ + self.scale_ * mean
        return (mean, self._std(points, F)) if return_std else mean

    def expanded(self, X) -> np.ndarray:
        """Numeric columns (m, c) of coded points (m, d)."""
        return expand(validate_data(self, X, reset=False), self.columns_)

    def _std(self, points: np.ndarray, F: np.ndarray) -> np.ndarray:
        """Standard deviation of a new run (Santner et al. 2018, equation 3.2.8), in blocks."""
        variance, step = np.empty(len(points)), 2048
        solved = linalg.cho_solve((self.state_.factor, True), self.trend_columns(self.points_))
        for start in range(0, len(points), step):
            part = slice(start, start + step)
            cross = correlation(points[part], self.points_, self.lengths_)
            explained = linalg.solve_triangular(self.state_.factor, cross.T, lower=True)
            rest = F[part] - cross @ solved
            variance[part] = (
                1.0
                + self.nugget_
                - (explained**2).sum(axis=0)
                + ((rest @ self.state_.gain) * rest).sum(axis=1)
            )
        return np.sqrt(self.variance_ * np.maximum(variance, self.nugget_))

    def leave_one_out(self) -> np.ndarray:
        """Predictions (n,) of each run without it, lengths and nugget kept (Dubrule 1983)."""
        return self._closed(np.arange(len(self.points_)))

    def leave_out(self, folds) -> np.ndarray:
        """Predictions (n,) of each run without its fold (n,).

        Up to `REFIT` runs lengths and nugget are estimated anew without the fold, from
        those of all runs; above, where a fold hardly moves them, they are kept.
        """
        folds = np.asarray(folds)
        if self.scale_ == 0.0 or len(self.points_) > REFIT:
            return self._closed(folds)
        result = np.full(len(folds), np.nan)
        for fold in np.unique(folds):
            inside = folds == fold
            try:
                result[inside] = self._without(inside)
            except ValueError:
                continue  # the rest cannot support the trend: stays NaN
        return result

    def _without(self, inside: np.ndarray) -> np.ndarray:
        """Predictions (k,) of the runs `inside` by a process fitted to the others."""
        other = GaussianProcess(**self.get_params(deep=False))
        other.columns_, other.points_ = self.columns_, self.points_[~inside]
        other.standard_, other.scale_ = self.standard_[~inside], self.scale_
        other._set(other._search(self.logs_[None], ROUGH))
        points = self.points_[inside]
        return self.offset_ + self.scale_ * (
            other.trend_columns(points) @ other.trend_
            + weighted_sum(points, other.points_, other.lengths_, other.state_.weights)
        )

    def _closed(self, folds: np.ndarray) -> np.ndarray:
        """Block form of Dubrule 1983: the error of a fold B is (Q_BB)^-1 (Q y)_B."""
        error = np.empty(len(folds))
        for fold in np.unique(folds):
            inside = np.flatnonzero(folds == fold)
            block = self.state_.projected[np.ix_(inside, inside)]
            error[inside] = np.linalg.solve(block, self.state_.weights[inside])
        return self.offset_ + self.scale_ * (self.standard_ - error)

    def posterior_draws(self, size: int, seed=None) -> list[paths.Draw]:
        """Functions that are as plausible as the mean, given the runs.

        Each offers `predict(X)` and `sobol_indices()`; see `surrogate.regressors.paths`.
        """
        check_is_fitted(self)
        drawn = paths.draw(self, size, seed)
        return [paths.Draw(drawn, number) for number in range(size)]

    def sobol_indices(self, groups: anova.Groups | None = None) -> anova.SobolIndices:
        """Sobol' indices of the mean under the space's law, of inputs or groups; exact.

        Rounding grows with the weights: 1e-11 for a hundred smooth runs, 1e-5 for five hundred.
        """
        check_is_fitted(self)
        rules = anova.quadratures(self.space, self.n_features_in_, QUADRATURE)
        factors = [self.factor(j, nodes) for j, (nodes, _) in enumerate(rules)]
        coefficients = self.scale_ * np.append(self.state_.weights, self.trend_)
        weights = [w for _, w in rules]
        return anova.shifted(
            anova.sobol_indices(coefficients, factors, weights, groups), self.offset_
        )

    def own_columns(self, parameter: int, nodes: np.ndarray) -> tuple[list[int], np.ndarray]:
        """Numbers of one parameter's columns, and their values (m, own) at its nodes (m,)."""
        own = [j for j, column in enumerate(self.columns_) if column.parameter == parameter]
        return own, np.column_stack([self.columns_[j].values(nodes) for j in own])

    def factor(self, parameter: int, nodes: np.ndarray) -> np.ndarray:
        """Part of each term (n kernels, then q trend terms) that depends on one parameter."""
        own, values = self.own_columns(parameter, nodes)
        kernels = correlation(self.points_[:, own], values, self.lengths_[own])
        trend = np.ones((len(self.trend_), len(nodes)))
        for t, term in enumerate(self._trend_terms()):
            for (j, _), (k, column) in product(term, enumerate(own)):
                if column == j:
                    trend[t] = values[:, k]
        return np.vstack([kernels, trend])

    def portable(self) -> dict:
        """JSON-able description; see `surrogate.regressors.portable`."""
        check_is_fitted(self)
        return {
            "kind": "gaussian_process",
            "columns": portable.described_columns(self.columns_),
            "offset": self.offset_,
            "scale": self.scale_,
            "lengths": self.lengths_.tolist(),
            "points": self.points_.tolist(),
            "weights": self.state_.weights.tolist(),
            "trend": [
                {"coefficient": float(c), "powers": [list(part) for part in term]}
                for c, term in zip(self.trend_, self._trend_terms(), strict=True)
            ],
        }
