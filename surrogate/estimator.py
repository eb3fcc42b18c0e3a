"""What the estimator of a surrogate offers: a regressor of scikit-learn's kind on coded inputs.

`Regressor` is what each one has. The contracts below it are optional; each has a
function that asks for it when it is used, because what a field offers depends on the regressor of
its modes.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal, Protocol, TypeGuard, overload

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from surrogate.space.space import Space

Array = NDArray[np.float64]

#: Lists of input numbers that count as one input each; they share no input.
Groups = Sequence[Sequence[int]]


class Predictor(Protocol):
    """Values (m,) or fields (m, ...) at coded points (m, d)."""

    def predict(self, X: Array, /) -> Array: ...


class Regressor(Predictor, Protocol):
    """An estimator that `sklearn.base.clone` can copy.

    A study sets its parameters `space` and `random_state`, where it has them. An attribute
    `interval_freedom` gives the degrees of freedom of prediction intervals (Student's t),
    `approximation` what it leaves out for speed, in words.
    """

    def fit(self, X: Array, y: Array, /) -> Any: ...

    def get_params(self, deep: bool = True) -> dict[str, Any]: ...

    def set_params(self, **params: Any) -> Any: ...


class HasStd(Protocol):
    """Knows standard deviations: (values, standard deviations) of new runs at coded X (m, d)."""

    def predict(self, X: Array, /, *, return_std: Literal[True]) -> tuple[Array, Array]: ...


class HasJoint(Protocol):
    """Knows the joint law of new runs at m sets of n coded points X (m, n, d).

    Means (m, n) and covariances (m, n, n); runs at the same point are one run.
    """

    def predict_joint(self, X: Array, /) -> tuple[Array, Array]: ...


class HasMinimum(Protocol):
    """Knows the fewest runs that it can be fitted to in a space; two for all others."""

    def minimum_runs(self, space: Space, /) -> int: ...


class LeavesOut(Protocol):
    """Knows its predictions (n, ...) of each run without the run's fold (n,), without refits."""

    def leave_out(self, folds: NDArray[np.intp], /) -> Array: ...


class FitsMany(Protocol):
    """Fits outputs Y (n, k) of the same runs X (n, d) together: a fitted regressor of each."""

    def fit_many(self, X: Array, Y: Array, /) -> list[Regressor]: ...


class RefitsMany(Protocol):
    """The same for some of the runs, from regressors that were fitted to all of them."""

    def refit_many(self, near: list[Regressor], X: Array, Y: Array, /) -> list[Regressor]: ...


class PredictsMany(Protocol):
    """Predicts by regressors of one `fit_many`: values (m, k), as `predict` those of one."""

    @overload
    def predict_many(self, models: Sequence[Regressor], X: Array, /) -> Array: ...
    @overload
    def predict_many(
        self, models: Sequence[Regressor], X: Array, /, *, return_std: Literal[True]
    ) -> tuple[Array, Array]: ...


class HasTable(Protocol):
    """Has a regression table; see `surrogate.regressors.regression.table`."""

    def regression_table(self, *, deterministic: bool) -> xr.Dataset: ...


class Portable(Protocol):
    """Has a description as JSON data; see `surrogate.regressors.portable`."""

    def portable(self) -> dict[str, Any]: ...


class Indices(Protocol):
    """Sobol' indices: first_order and total (d,), second_order (d, d) symmetric."""

    @property
    def first_order(self) -> Array: ...

    @property
    def total(self) -> Array: ...

    @property
    def second_order(self) -> Array: ...


class HasIndices(Predictor, Protocol):
    """Knows its Sobol' indices in closed form, of inputs; of groups if it has that argument."""

    def sobol_indices(self, groups: Groups | None = None, /) -> Indices: ...


class HasIndicesOfMany(Protocol):
    """Knows the indices of all regressors of one `fit_many`, found together."""

    def sobol_indices_of_many(
        self, models: Sequence[Any], groups: Groups | None = None, /
    ) -> list[Any]: ...


class HasDraws(Predictor, Protocol):
    """Draws functions that are as plausible as its mean, given the runs."""

    def posterior_draws(self, size: int, *, seed: Any = None) -> Sequence[Predictor]: ...


class Paths(Protocol):
    """Functions drawn together: values (m, k) of those that a slice takes, at X (m, d)."""

    def predict(self, X: Array, which: slice, /) -> Array: ...


class Path(Predictor, Protocol):
    """A drawn function that knows those drawn with it, which are faster to predict together."""

    @property
    def paths(self) -> Paths: ...


class HasSamples(Predictor, Protocol):
    """Draws values (m, n_samples) at points, as scikit-learn's Gaussian process does."""

    def sample_y(self, X: Array, n_samples: int, random_state: int) -> Array: ...


def approximation(estimator: object) -> str:
    """What an estimator leaves out for speed, in words; "" for one that is exact."""
    return str(getattr(estimator, "approximation", ""))


def has_minimum(estimator: object) -> TypeGuard[HasMinimum]:
    """True when the estimator knows how many runs it needs."""
    return hasattr(estimator, "minimum_runs")


def has_joint(estimator: object) -> TypeGuard[HasJoint]:
    """True when the estimator knows the joint law of new runs."""
    return hasattr(estimator, "predict_joint")


def leaves_out(estimator: object) -> TypeGuard[LeavesOut]:
    """True when the estimator leaves folds out by itself."""
    return hasattr(estimator, "leave_out")


def fits_many(estimator: object) -> TypeGuard[FitsMany]:
    """True when the estimator fits several outputs together."""
    return hasattr(estimator, "fit_many")


def refits_many(estimator: object) -> TypeGuard[RefitsMany]:
    """True when the estimator fits several outputs anew from fits of more runs."""
    return hasattr(estimator, "refit_many")


def predicts_many(estimator: object) -> TypeGuard[PredictsMany]:
    """True when the estimator predicts several outputs together."""
    return hasattr(estimator, "predict_many")


def has_table(estimator: object) -> TypeGuard[HasTable]:
    """True when the estimator has a regression table."""
    return hasattr(estimator, "regression_table")


def is_portable(estimator: object) -> TypeGuard[Portable]:
    """True when the estimator can be described as JSON data."""
    return hasattr(estimator, "portable")


def has_indices(estimator: object) -> TypeGuard[HasIndices]:
    """True when the estimator knows its Sobol' indices."""
    return hasattr(estimator, "sobol_indices")


def has_indices_of_many(estimator: object) -> TypeGuard[HasIndicesOfMany]:
    """True when the estimator finds the indices of several outputs together."""
    return hasattr(estimator, "sobol_indices_of_many")


def has_draws(estimator: object) -> TypeGuard[HasDraws]:
    """True when the estimator draws from its posterior."""
    return hasattr(estimator, "posterior_draws")


def has_samples(estimator: object) -> TypeGuard[HasSamples]:
    """True when the estimator draws values at points."""
    return hasattr(estimator, "sample_y")


def is_path(draw: object) -> TypeGuard[Path]:
    """True when the drawn function knows those drawn with it."""
    return hasattr(draw, "paths")
