"""Gaussian process regression (kriging) with a product Matern 5/2 kernel.

Lengths and nugget maximise restricted likelihood times prior. Santner, Williams, Notz, The
Design and Analysis of Computer Experiments (2nd ed. 2018), chapters 3, 4. What a process with
given lengths predicts: `fitted_process`.

Deviations that take estimated lengths as known are too small when runs are few. So folds of runs
are left out, lengths estimated anew without them, and z is a left-out error over its deviation:
the variance of the process by cross-validation is mean(z^2) times that by likelihood (Cressie
1993, section 2.6.4; Bachoc 2013, doi 10.1016/j.csda.2013.03.016, who shows that it is the safer
one where the kernel is not that of the function). Deviations are wider by

    max(1, sqrt(mean(z^2) (n + 1) / (n - 1))),

n - 1 and n + 1 being for a scale that is estimated from n errors and used for one more.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from copy import copy
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import linalg
from sklearn.utils.validation import check_is_fitted, validate_data

from surrogate.counting import counted
from surrogate.errors import FitError, nearest
from surrogate.regressors import paths
from surrogate.regressors.columns import columns_of, expand, scored
from surrogate.regressors.fitted_process import FittedProcess, predicted
from surrogate.regressors.folds import point_folds
from surrogate.regressors.kriging import Factored, left_out_errors
from surrogate.regressors.length_search import Search, guesses
from surrogate.regressors.likelihood import NORMAL, LengthPrior, Posterior
from surrogate.regressors.log_noise import log_variances
from surrogate.regressors.nearest_runs import ManyRuns, NearestRuns
from surrogate.regressors.polynomial import linear_terms
from surrogate.regressors.uncertain_lengths import plausible
from surrogate.space.space import Space

Array = NDArray[np.float64]

#: Nugget as a share of the process variance: from what rounding allows (smaller ones make
#: weights that lose ten digits) to next to no signal.
NUGGETS = (1e-8, 100.0)
TRENDS = ("constant", "linear")
#: Noise of all runs alike, or as their replicates show it.
EQUAL, REPLICATES = "equal", "replicates"
#: Above `MANY` runs lengths are those of a core of `CORE` runs, and a point is predicted from the
#: core and the runs that are nearest to it, see `nearest_runs`.
MANY, CORE = 2000, 1000
#: Above this number of runs guesses are tried on a part of the runs.
SUBSET = 300
#: Up to this number of runs a left-out fold has its own lengths and nugget.
REFIT = 200
#: Sets of lengths and nugget that draws of one output come from.
SETS = 10
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
#: Deviations of standardised outputs below this are rounding, as where the trend is exact.
ROUNDING = 1e-10


class GaussianProcess(FittedProcess):
    """Kriging on coded inputs.

    trend   "constant" or "linear"
    nugget  variance of a run about the process, as a share of the process variance:
            "estimate", or a number (a tiny one, 1e-8, makes it interpolate)
    starts  local searches for the posterior's maximum
    seed    of the starts
    space   the Space of the inputs; None for numeric inputs uniform on [-1, 1]
    normal_scores  unbounded inputs enter by their normal scores, not by their probabilities: for
            the far ends of a law, where a limit is rarely exceeded
    noise   "equal" at all places, or "replicates": the scatter at repeated points says how the
            variance of a run about the process depends on the place, see `log_noise`
    registration  True: fields whose pattern moves are aligned first, see `registered`

    Fitted: what `FittedProcess` lists; by `fit` alone `folds_` (n,) and `left_out_`, standardised
    predictions (n,) of each run without its fold and their deviations. `widening_` is 1 for
    processes of many outputs and of given lengths.
    """

    length_prior: ClassVar[LengthPrior] = NORMAL
    folds_: NDArray[np.intp] | None
    many_: ManyRuns | None = None
    near_: NearestRuns | None = None
    left_out_: tuple[Array, Array]

    def __init__(
        self,
        trend: str = "constant",
        nugget: str | float = "estimate",
        starts: int = 3,
        seed: int = 0,
        space: Space | None = None,
        normal_scores: bool = False,
        noise: str = EQUAL,
        registration: bool = False,
    ) -> None:
        self.trend = trend
        self.nugget = nugget
        self.starts = starts
        self.seed = seed
        self.space = space
        self.normal_scores = normal_scores
        self.noise = noise
        self.registration = registration

    def fit(self, X: ArrayLike, y: ArrayLike) -> Self:
        """Fit to coded points X (n, d) and values y (n,)."""
        self._take(X, y)
        self.folds_ = point_folds(self.points_, seed=self.seed)
        if len(self.points_) > MANY and self.noise == EQUAL and self.scale_ > 0.0:
            self.many_ = self._divided()
        self._find()
        if self.many_ is not None:
            self.near_ = self._near(self, self.many_)
        self.left_out_ = self._left_out(self.folds_)
        values = self.standard_ if self.many_ is None else self.many_.standard
        self.widening_ = _widening(values, *self.left_out_) if self.scale_ > 0.0 else 1.0
        return self

    def _most_probable(self, X: ArrayLike, y: ArrayLike) -> None:
        """The process of runs with the most probable lengths and nugget found; not widened."""
        self._take(X, y)
        self._find()

    def _find(self) -> None:
        """The most probable lengths and nugget of the runs taken."""
        logs = guesses(self._bounds(), self.seed)
        if self.scale_ > 0.0:
            logs = self._search(self.standard_[:, None], logs, 1, max(self.starts, 1), FINE)
        self._set(logs[0], self._factored(logs[0]))

    def _divided(self) -> ManyRuns:
        """All runs; those of a core, drawn at random, stay as the runs of this process."""
        core = np.zeros(len(self.points_), dtype=bool)
        core[np.random.default_rng(self.seed).permutation(len(core))[:CORE]] = True
        every = ManyRuns(self.points_, self.standard_, core)
        self.points_, self.standard_ = self.points_[core], self.standard_[core]
        self.noise_ = self.noise_[core]
        return every

    @staticmethod
    def _near(
        core: GaussianProcess, every: ManyRuns, chosen: NDArray[np.bool_] | None = None
    ) -> NearestRuns:
        """The runs beside the core, those `chosen` of them."""
        beside = ~every.core if chosen is None else ~every.core & chosen
        return NearestRuns.beside(copy(core), every.points[beside], every.standard[beside])

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
        if self.noise != EQUAL:
            raise ValueError(f"noise: {self.noise} is for single numbers; take noise: {EQUAL}")
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
        if self.normal_scores:
            self.columns_ = scored(self.columns_, self.space)
        self.folds_, self.many_, self.near_ = None, None, None  # known after `fit`
        self.points_ = expand(points, self.columns_)
        self._standardise(outputs)
        self._take_noise()

    def _standardise(self, y: Array) -> None:
        self.offset_, self.scale_ = float(y.mean()), float(y.std())
        if self.scale_ <= 1e-14 * np.abs(y).max():
            self.scale_ = 0.0
        self.standard_ = (y - self.offset_) / (self.scale_ or 1.0)

    def _take_noise(self) -> None:
        """How the noise depends on the place."""
        self.log_noise_: GaussianProcess | None = None
        if self.noise == REPLICATES:
            points, logs = log_variances(self.points_, self.standard_)
            self.log_noise_ = GaussianProcess(starts=self.starts, seed=self.seed)
            self.log_noise_._most_probable(points, logs)
            self.log_noise_.offset_ -= float(np.log(self.noise_at(self.points_)).mean())
        self.noise_ = self.noise_at(self.points_)

    def noise_at(self, points: Array) -> Array:
        """Variance (m,) of new runs about the process at numeric columns (m, c), in nuggets."""
        if self.log_noise_ is None:
            return super().noise_at(points)
        logs = np.asarray(predicted([self.log_noise_], points))
        return np.exp(logs[:, 0])

    def _check(self) -> None:
        if self.trend not in TRENDS:
            raise ValueError(f"trend '{self.trend}': {nearest(self.trend, TRENDS)}")
        if self.noise not in (EQUAL, REPLICATES):
            raise ValueError(f"noise '{self.noise}': {nearest(self.noise, (EQUAL, REPLICATES))}")
        if self.nugget != "estimate" and (isinstance(self.nugget, str) or not self.nugget > 0):
            raise ValueError(
                f"nugget {self.nugget}: give 'estimate' or a number above 0, such as 1e-8"
            )

    def minimum_runs(self, space: Space) -> int:
        """Runs that a fit needs: two more than the trend has coefficients."""
        return 2 + (
            len(linear_terms(columns_of(space, space.size))) if self.trend == "linear" else 1
        )

    def _bounds(self) -> Array:
        """Bounds of log lengths and log nugget, (c + 1, 2)."""
        nugget = NUGGETS if self.nugget == "estimate" else (self.nugget, self.nugget)
        return np.log([self.length_prior.bounds] * self.points_.shape[1] + [nugget])

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
        trend, noise = self._checked_trend(points), self.noise_[chosen]
        posterior = Posterior(points, trend, y[chosen], noise, self.length_prior)
        search = Search(posterior, self._bounds())
        search.judge(start)
        for output in counted("mode", range(leading)):
            search.descend(output, starts, end)
        return search.found()

    def predict_many(
        self, models: Sequence[FittedProcess], X: ArrayLike, return_std: bool = False
    ) -> Array | tuple[Array, Array]:
        """Values (m, k) of processes of the same runs; of many runs, by the nearest ones too."""
        check_is_fitted(self)
        if self.near_ is None:
            return super().predict_many(models, X, return_std)
        mean, variance = self.near_.predict(self.expanded(X))
        values = self.unscaled(mean)[:, None]
        return (
            (values, np.sqrt(self.predictive_variance * variance)[:, None])
            if return_std
            else values
        )

    @property
    def approximation(self) -> str:
        """What a process of many runs leaves out, in words; "" up to `MANY` runs."""
        if self.many_ is None or self.near_ is None:
            return ""
        return (
            f"lengths and indices come from {len(self.points_)} of the "
            f"{len(self.many_.standard)} runs, each prediction from these and the "
            f"{self.near_.nearest} other runs nearest to it"
        )

    def leave_one_out(self) -> Array:
        """Predictions (n,) of each run without it, lengths and nugget kept (Dubrule 1983).

        Of more than `MANY` runs without its fold.
        """
        if self.near_ is not None:
            return self.unscaled(self.left_out_[0])
        return self.unscaled(self._closed(np.arange(len(self.points_)))[0])

    def leave_out(self, folds: ArrayLike) -> Array:
        """Predictions (n,) of each run without its fold (n,).

        Up to `REFIT` runs lengths and nugget are estimated anew without the fold, from
        those of all runs; above, where a fold hardly moves them, they are kept.
        """
        folds = np.asarray(folds)
        known = self.folds_ is not None and np.array_equal(folds, self.folds_)
        return self.unscaled((self.left_out_ if known else self._left_out(folds))[0])

    def posterior_draws(self, size: int, seed: int | None = None) -> list[paths.Draw]:
        """Functions that are as plausible as the mean, given the runs.

        Up to `REFIT` runs of one output they come from `SETS` sets of lengths and nugget. Each
        offers `predict(X)` and `sobol_indices()`; see `surrogate.regressors.paths`.
        """
        check_is_fitted(self)
        if self.scale_ == 0.0 or len(self.points_) > REFIT or self.folds_ is None:
            return super().posterior_draws(size, seed)
        rng = np.random.default_rng(seed)
        return paths.draws(self._plausible(min(SETS, size), rng), size, rng)

    def _plausible(self, count: int, rng: np.random.Generator) -> list[GaussianProcess]:
        """Processes of the same runs whose lengths and nugget are drawn from their posterior."""
        trend, standard = self.trend_columns(self.points_), self.standard_[:, None]
        posterior = Posterior(self.points_, trend, standard, self.noise_, self.length_prior)
        found = []
        for logs in plausible(posterior, self.logs_, self._bounds(), count, rng):
            other = copy(self)
            try:
                other._set(logs, other._factored(logs))
            except linalg.LinAlgError:  # singular to rounding
                other._set(self.logs_, self.factors_)
            other.widening_ = self.widening_
            found.append(other)
        return found

    def portable(self) -> dict[str, Any]:
        """JSON-able description; `FitError` where noise depends on the place, or of many runs."""
        if self.near_ is not None:
            raise FitError(
                f"a Gaussian process of more than {MANY} runs has no portable form, because each "
                "point is predicted from other runs; export polynomial chaos, or fit fewer runs"
            )
        if self.noise != EQUAL:
            raise FitError(
                f"a Gaussian process with noise: {self.noise} has no portable form, for its "
                f"deviation depends on the place; add one with noise: {EQUAL}"
            )
        return super().portable()

    def _left_out(self, folds: NDArray[np.intp]) -> tuple[Array, Array]:
        """Standardised predictions (n,) of each run without its fold, and their deviations."""
        if self.many_ is not None:
            return self._left_out_of_many(folds, self.many_)
        if self.scale_ == 0.0 or len(self.points_) > REFIT:
            return self._closed(folds)
        mean, std = np.full((2, len(folds)), np.nan)
        for fold in counted("fold", np.unique(folds).tolist()):
            inside = folds == fold
            try:
                mean[inside], std[inside] = self._without(inside)
            except ValueError:
                continue  # the rest cannot support the trend: stays NaN
        return mean, std

    def _left_out_of_many(self, folds: NDArray[np.intp], every: ManyRuns) -> tuple[Array, Array]:
        """The same of all runs, lengths, nugget and variance kept: folds leave the core too."""
        mean, std = np.empty((2, len(folds)))
        share = self.variance_ / self.scale_**2
        for fold in counted("fold", np.unique(folds).tolist()):
            rest = folds != fold
            other = copy(self)
            other.points_ = every.points[every.core & rest]
            other.standard_ = every.standard[every.core & rest]
            other.noise_ = np.ones(len(other.points_))
            other._set(self.logs_, other._factored(self.logs_))
            mean[~rest], variance = self._near(other, every, rest).predict(every.points[~rest])
            std[~rest] = np.sqrt(share * variance)
        return mean, std

    def _without(self, inside: NDArray[np.bool_]) -> tuple[Array, Array]:
        """Standardised predictions (k,) of the runs `inside` by the others, and deviations."""
        other = type(self)(**self.get_params(deep=False))
        other.columns_, other.points_ = self.columns_, self.points_[~inside]
        other.standard_, other.offset_, other.scale_ = self.standard_[~inside], 0.0, 1.0
        other.log_noise_, other.noise_ = self.log_noise_, self.noise_[~inside]
        logs = other._search(other.standard_[:, None], self.logs_[None], 1, 1, ROUGH)[0]
        other._set(logs, other._factored(logs))
        return other.new_runs(self.points_[inside])

    def new_runs(self, points: Array) -> tuple[Array, Array]:
        """Values (m,) at numeric columns (m, c) and the deviations of new runs."""
        mean, std = predicted([self], points, return_std=True)
        return mean[:, 0], std[:, 0]

    def _closed(self, folds: NDArray[np.intp]) -> tuple[Array, Array]:
        """The same with lengths, nugget and variance of all runs, in closed form."""
        errors, variances = left_out_errors(self.factors_, self.weights_, folds)
        share = float(self.factors_.variance(self.standard_, self.weights_))
        return self.standard_ - errors, np.sqrt(share * variances)


def _widening(values: Array, mean: Array, std: Array) -> float:
    """Factor of the deviations of values (n,) from what runs without them predict."""
    z = ((values - mean) / np.maximum(std, ROUNDING))[np.isfinite(mean)]
    n = len(z)
    return max(1.0, math.sqrt(float(z @ z) / n * (n + 1) / (n - 1))) if n > 1 else 1.0


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
