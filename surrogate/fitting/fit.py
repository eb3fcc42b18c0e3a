"""Fit: one regressor of one output on coded inputs, with what it is worth.

Accuracy is judged by predictions of runs that the fit has not seen:

    Q2 = 1 - sum (y - prediction)^2 / sum (y - mean(y))^2

over all runs (and all places of a field), the mean being that of the runs judged.
Which runs are left out together is in `surrogate.regressors.folds`: each point in turn, or ten
folds, the same for every surrogate of the same runs and seed.
"""

from __future__ import annotations

import inspect
import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal, TypeGuard, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import stats
from sklearn.base import clone
from sklearn.pipeline import Pipeline, make_pipeline
from sklearn.preprocessing import FunctionTransformer

from surrogate.card import Card, Carded
from surrogate.counting import counting
from surrogate.errors import FitError
from surrogate.estimator import Array, HasStd, Regressor, has_minimum, is_portable, leaves_out
from surrogate.regressors import portable
from surrogate.regressors.columns import columns_of, expand
from surrogate.regressors.field import Field
from surrogate.regressors.folds import point_folds
from surrogate.regressors.registered import Registered
from surrogate.space.space import Space

Numbers = NDArray[np.intp]

#: Points predicted at once, so that memory stays bounded for any number of them.
CHUNK = 65_536


@dataclass(frozen=True, eq=False, repr=False)
class Fit(Carded):
    """A fitted surrogate of one output.

    surrogate, output  their names
    estimator          fitted scikit-learn estimator
    coded, values      training points (n, d) and values (n,) or fields (n, ...)
    folds              (n,) which runs were left out together
    left_out           values as predicted by a fit without the run's fold; NaN where
                       the rest of the runs cannot support a fit
    seconds            time of the fit, without cross-validation
    """

    surrogate: str
    output: str
    space: Space
    estimator: Regressor
    coded: Array
    values: Array
    folds: Numbers
    left_out: Array
    seconds: float

    @property
    def _card(self) -> Card:
        shape = " x ".join(map(str, self.values.shape[1:]))
        facts = {
            "Q2": self.q2,
            "RMSE": self.rmse,
            "runs": len(self.values),
            "parameters": self.space.size,
            "field": shape,
            "intervals": "its own" if self.offers_std else "of the left-out errors",
            "seconds": self.seconds,
        }
        return Card("Fit", f"{self.surrogate} of {self.output}", facts)

    @property
    def q2(self) -> float:
        """Q2 of the left-out predictions; NaN when some run cannot be left out."""
        return q2(self.values, self.left_out)

    @property
    def rmse(self) -> float:
        """Root mean square error of the left-out predictions, in the output's unit."""
        return rmse(self.values, self.left_out)

    @property
    def offers_std(self) -> bool:
        """True when the surrogate has a standard deviation of its own at every point."""
        return _offers_std(self.estimator)

    @cached_property
    def _errors(self) -> Array:
        """Sizes of the left-out errors that exist, sorted along runs, shape (k, ...)."""
        errors = np.abs(self.values - self.left_out)
        known = np.isfinite(errors).reshape(len(errors), -1).all(axis=1)
        return np.sort(errors[known], axis=0)

    @overload
    def predict(self, coded: ArrayLike, return_std: Literal[False] = False) -> Array: ...
    @overload
    def predict(self, coded: ArrayLike, return_std: Literal[True]) -> tuple[Array, Array]: ...
    def predict(self, coded: ArrayLike, return_std: bool = False) -> Array | tuple[Array, Array]:
        """Values (m, ...) at coded points (m, d), and their standard deviations if asked.

        Standard deviations are the surrogate's own; for one that has none, the
        root mean square of the left-out errors, the same at every point.
        """
        points, shape, own = _points(coded, self.space), self.values.shape[1:], self.estimator
        if return_std and _offers_std(own):
            both = _chunked(
                lambda x: np.stack(own.predict(x, return_std=True), 1), points, (2, *shape)
            )
            return both[:, 0], both[:, 1]
        mean = _chunked(self.estimator.predict, points, shape)
        if not return_std:
            return mean
        return mean, np.broadcast_to(self._spread(), mean.shape)

    @property
    def error_law(self) -> Any:
        """Law of (solver - prediction) / standard deviation at a new point, a scipy law.

        That of `interval`: Student's t with the surrogate's degrees of freedom or the normal
        law; without a standard deviation of its own, Student's t of the left-out errors.
        """
        if self.offers_std:
            return _law(self.estimator) or stats.t(1)
        k = len(self._errors)
        return stats.t(max(k - 1, 1), scale=math.sqrt(1.0 + 1.0 / max(k, 1)))

    def _spread(self) -> Array:
        if not len(self._errors):
            return np.full(self.values.shape[1:], np.nan)
        return np.asarray(np.sqrt((self._errors**2).mean(axis=0)))

    def interval(self, coded: ArrayLike, confidence: float = 0.95) -> tuple[Array, Array]:
        """Lower and upper ends (m, ...) of prediction intervals at coded points (m, d).

        Own standard deviation: Student's t with the surrogate's degrees of freedom
        (polynomials, our Gaussian process) or the normal law (others). Otherwise the conformal
        quantile of the left-out errors, their ceil(confidence (k + 1))-th smallest of k
        (Vovk 2015, cross-conformal; constant width); when k is too small for that,
        Student's t times their root mean square, times sqrt(1 + 1 / k).
        """
        return self.intervals(coded, (confidence,))[0]

    def intervals(self, coded: ArrayLike, levels: Sequence[float]) -> list[tuple[Array, Array]]:
        """Ends of intervals as `interval` gives them, at several levels of confidence."""
        mean, halves = self.half_widths(coded, levels)
        return [(mean - half, mean + half) for half in halves]

    def half_widths(self, coded: ArrayLike, levels: Sequence[float]) -> tuple[Array, list[Array]]:
        """Predictions (m, ...), the middles of their intervals, and half-widths at each level."""
        if self.offers_std:
            mean, std = self.predict(coded, return_std=True)
            return mean, [std * _quantile(self.estimator, level) for level in levels]
        return self.predict(coded), [self._half_width(level) for level in levels]

    def _half_width(self, confidence: float) -> Array:
        k = len(self._errors)
        rank = math.ceil(confidence * (k + 1))
        if rank <= k:
            return np.asarray(self._errors[rank - 1])
        if k < 2:
            return np.full(self.values.shape[1:], np.nan)
        quantile = stats.t.ppf(0.5 + confidence / 2.0, k - 1)
        return np.asarray(quantile * math.sqrt(1.0 + 1.0 / k) * self._spread())

    def portable(self) -> dict[str, Any]:
        """JSON-able document that evaluates without this package.

        The format is in `surrogate.regressors.portable`. Raises `FitError` for a
        regressor that has no such description.
        """
        single = self.estimator.estimator if isinstance(self.estimator, Field) else self.estimator
        if not (is_portable(single) and is_portable(self.estimator)):
            raise FitError(
                f"surrogate '{self.surrogate}' has no portable form; export a "
                "polynomial, polynomial chaos or Gaussian process"
            )
        model = self.estimator.portable()
        return portable.describe(
            self.space, model, self._error(), surrogate=self.surrogate, output=self.output
        )

    def _error(self) -> dict[str, Any]:
        """The error of predictions as `portable` describes it."""
        if self.offers_std:
            freedom = getattr(self.estimator, "interval_freedom", None)
            quantile = portable.finite(_quantile(self.estimator, 0.95))
            return {"kind": "own", "freedom": freedom, "quantile_95": quantile}
        field = self.values.ndim > 1
        spread, half = self._spread(), self._half_width(0.95)
        return {
            "kind": "left_out",
            "freedom": len(self._errors) - 1,
            "deviation": portable.finite(np.ravel(spread) if field else spread),
            "half_width_95": portable.finite(np.ravel(half) if field else half),
        }


def fit(
    space: Space,
    coded: ArrayLike,
    values: ArrayLike,
    estimator: Regressor,
    *,
    surrogate: str = "surrogate",
    output: str = "output",
    seed: int = 0,
) -> Fit:
    """Fit a clone of `estimator` to values (n,) or fields (n, ...) at coded points (n, d).

    The estimator is given the space if it has a parameter of that name; otherwise
    categorical parameters reach it as effect-coded columns. `seed` fixes the folds
    and every `random_state` that the estimator leaves open. Failed runs must be left
    out. Raises `FitError` for too few runs or what the estimator cannot digest.
    """
    points, outputs = _points(coded, space), np.asarray(values, dtype=float)
    prepared = prepare(estimator, space, seed=seed, field=outputs.ndim > 1)
    _check(space, points, outputs, prepared, surrogate, output)
    groups = point_folds(points, seed=seed)
    closed = leaves_out(prepared)
    with counting(2 if closed else 1 + int(groups.max()) + 1) as begin:
        begin("")
        start = time.perf_counter()
        try:
            fitted = clone(prepared).fit(points, outputs)
        except (ValueError, np.linalg.LinAlgError) as error:
            raise FitError(
                f"surrogate '{surrogate}' cannot be fitted to '{output}': {error}"
            ) from error
        seconds = time.perf_counter() - start
        left_out = _left_out(fitted, prepared, points, outputs, groups, begin)
    return Fit(surrogate, output, space, fitted, points, outputs, groups, left_out, seconds)


def prepare(estimator: Regressor, space: Space, *, seed: int = 0, field: bool = False) -> Regressor:
    """The estimator as `fit` uses it: unfitted, knowing space and seed, for scalars or fields."""
    ready: Regressor = clone(estimator)
    options = ready.get_params(deep=True)
    ready.set_params(
        **{
            name: seed
            for name, value in options.items()
            if name.split("__")[-1] == "random_state" and value is None
        }
    )
    if "space" in ready.get_params(deep=False):
        ready.set_params(space=space)
    elif any(parameter.categorical for parameter in space.parameters):
        of = columns_of(space, space.size)
        ready = make_pipeline(FunctionTransformer(expand, kw_args={"of": of}), ready)
    if not field:
        return ready
    return Registered(ready) if getattr(ready, "registration", False) else Field(ready)


def minimum_runs(estimator: Regressor, space: Space) -> int:
    """Fewest runs that the estimator can be fitted to in this space."""
    return int(estimator.minimum_runs(space)) if has_minimum(estimator) else 2


def q2(values: ArrayLike, predictions: ArrayLike) -> float:
    """1 - sum of squared errors / sum of squares about the mean; at most 1.

    For values that do not vary: 1 when predicted exactly, NaN otherwise.
    """
    truth = np.asarray(values, dtype=float)
    errors = truth - np.asarray(predictions, dtype=float)
    total = float(((truth - truth.mean(axis=0)) ** 2).sum())
    wrong = float((errors**2).sum())
    negligible = 1e-24 * float((truth**2).sum())
    if total <= negligible:
        return 1.0 if wrong <= negligible else np.nan
    return 1.0 - wrong / total


def rmse(values: ArrayLike, predictions: ArrayLike) -> float:
    """Root mean square of values - predictions."""
    errors = np.asarray(values, dtype=float) - np.asarray(predictions, dtype=float)
    return float(np.sqrt(np.mean(errors**2)))


def _left_out(
    fitted: Regressor,
    prepared: Regressor,
    coded: Array,
    values: Array,
    groups: Numbers,
    begin: Callable[[str], None],
) -> Array:
    """Predictions by fits without each fold: the estimator's closed form, or refits.

    begin: told which fold is at hand, see `counting`
    """
    if leaves_out(fitted):
        begin("")
        return np.asarray(fitted.leave_out(groups))
    refit = fitted.refitted if isinstance(fitted, Field) else None
    result = np.full(values.shape, np.nan)
    numbers = np.unique(groups)
    for number, group in enumerate(numbers, start=1):
        begin(f"fold {number} of {len(numbers)}")
        inside = groups == group
        try:
            rest = (refit or clone(prepared).fit)(coded[~inside], values[~inside])
        except (ValueError, np.linalg.LinAlgError, FitError):
            continue  # too few runs are left: stays NaN, which Fit.q2 reports
        result[inside] = rest.predict(coded[inside])
    return result


def _check(
    space: Space, coded: Array, values: Array, estimator: Regressor, surrogate: str, output: str
) -> None:
    if len(coded) != len(values):
        raise FitError(f"{len(coded)} points but {len(values)} values of '{output}'")
    bad = int((~np.isfinite(values).all(axis=tuple(range(1, values.ndim)))).sum())
    if bad:
        raise FitError(
            f"{bad} of {len(values)} values of '{output}' are not finite; leave failed "
            "runs out before fitting"
        )
    needed = minimum_runs(estimator, space)
    if len(coded) < needed:
        raise FitError(
            f"surrogate '{surrogate}' needs at least {needed} runs in {space.size} "
            f"parameters but '{output}' has {len(coded)}; add runs or choose a "
            "surrogate with fewer terms"
        )


def _points(coded: ArrayLike, space: Space) -> Array:
    points = np.atleast_2d(np.asarray(coded, dtype=float))
    if points.ndim != 2 or points.shape[1] != space.size:
        raise FitError(
            f"points of shape {points.shape} do not fit {space.size} parameters; give "
            f"coded points (run, parameter) in the order {', '.join(space.names)}"
        )
    return points


def _offers_std(estimator: Regressor) -> TypeGuard[HasStd]:
    if isinstance(estimator, Pipeline):
        return _offers_std(estimator[-1])
    if isinstance(estimator, Field):
        return _offers_std(estimator.estimator)
    return "return_std" in inspect.signature(estimator.predict).parameters


def _law(estimator: Regressor) -> Any:
    """Law of standardised errors; None without degrees of freedom."""
    freedom = getattr(estimator, "interval_freedom", None)
    return stats.norm() if freedom is None else stats.t(freedom) if freedom else None


def _quantile(estimator: Regressor, confidence: float) -> float:
    law = _law(estimator)
    return float(law.ppf(0.5 + confidence / 2.0)) if law else np.nan


def _chunked(function: Callable[[Array], Array], coded: Array, shape: tuple[int, ...]) -> Array:
    """function(coded) of shape (m, *shape), computed for about `CHUNK` numbers at a time."""
    result = np.empty((len(coded), *shape))
    step = max(CHUNK // math.prod(shape), 256)
    for start in range(0, len(coded), step):
        part = slice(start, start + step)
        result[part] = function(coded[part])
    return result
