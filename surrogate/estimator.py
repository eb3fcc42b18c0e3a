"""What the estimator of a surrogate offers: a regressor of scikit-learn's kind on coded inputs.

`Regressor` is what each one has. The contracts below it are optional; a function `..._of` or
`has_...` asks for each at the time of use, because what a field offers depends on the regressor
of its modes.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol, TypeGuard

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: Lists of input numbers that count as one input each; they share no input.
Groups = Sequence[Sequence[int]]


class Predictor(Protocol):
    """Values (m,) or fields (m, ...) at coded points (m, d)."""

    def predict(self, X: Array, /) -> Array: ...


class Regressor(Predictor, Protocol):
    """An estimator that `sklearn.base.clone` can copy.

    `predict(X, return_std=True)` may give values and standard deviations.
    """

    def fit(self, X: Array, y: Array, /) -> Any: ...

    def get_params(self, deep: bool = True) -> dict[str, Any]: ...

    def set_params(self, **params: Any) -> Any: ...


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


def has_indices(estimator: object) -> TypeGuard[HasIndices]:
    """True when the estimator knows its Sobol' indices."""
    return hasattr(estimator, "sobol_indices")


def has_draws(estimator: object) -> TypeGuard[HasDraws]:
    """True when the estimator draws from its posterior."""
    return hasattr(estimator, "posterior_draws")


def has_samples(estimator: object) -> TypeGuard[HasSamples]:
    """True when the estimator draws values at points."""
    return hasattr(estimator, "sample_y")


def is_path(draw: object) -> TypeGuard[Path]:
    """True when the drawn function knows those drawn with it."""
    return hasattr(draw, "paths")
