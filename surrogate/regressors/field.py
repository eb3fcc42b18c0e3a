"""Fields by proper orthogonal decomposition: one regressor for each mode.

With the singular value decomposition Y - mean = U S V' of the training fields
(Sirovich 1987), a field is mean + sum_k a_k(x) V_k; the amplitudes a_k = U_k S_k are
learnt one by one (Guo and Hesthaven 2018, non-intrusive reduced basis).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from dataclasses import field as dataclass_field
from typing import Any, Literal, Self, overload

import numpy as np
from numpy.typing import ArrayLike
from sklearn.base import BaseEstimator, RegressorMixin, clone
from sklearn.utils.metaestimators import available_if
from sklearn.utils.validation import check_is_fitted

from surrogate.counting import counted
from surrogate.estimator import (
    Array,
    Groups,
    Regressor,
    fits_many,
    has_indices_of_many,
    has_minimum,
    predicts_many,
    refits_many,
)
from surrogate.regressors import portable
from surrogate.regressors.anova import SobolIndices
from surrogate.space.space import Space

#: Draws of a field differ in the indices of the modes that hold this share of its variance;
#: the many modes beyond could not move an index of the field by more than the rest, and move it
#: by far less, because they are independent.
DRAWN = 0.99
#: Smallest share of the first mode's variance at which products give a mode to ten digits.
RESOLVED = 1e-6


def _offered(name: str) -> Callable[[Callable[..., Any]], Any]:
    """Available when the regressor of a mode offers the method `name`."""
    offers: Callable[[Callable[..., Any]], Any] = available_if(
        lambda field: hasattr(field.estimator, name)
    )
    return offers


class Field(RegressorMixin, BaseEstimator):
    """One clone of `estimator` for each mode of the field.

    estimator  a regressor of scalars on coded inputs
    explained  share of the training variance that the modes must hold

    Fitted: `shape_` of a field, `mean_` (size,), `modes_` (k, size) orthonormal,
    `estimators_` (k), `truncation_error_` (RMS of what the modes leave out, relative to the
    RMS of the fluctuations; 0 for a constant field), `left_out_` (size,) its RMS by place,
    `leading_` how many modes hold the share `DRAWN` of the variance.
    """

    def __init__(self, estimator: Regressor, explained: float = 0.9999) -> None:
        self.estimator = estimator
        self.explained = explained

    def fit(self, X: ArrayLike, y: ArrayLike) -> Self:
        """Fit to coded points X (n, d) and fields y (n, ...)."""
        amplitudes = self._decompose(y)
        if fits_many(self.estimator) and amplitudes.size:
            self.estimators_ = clone(self.estimator).fit_many(X, amplitudes)
        else:
            self.estimators_ = [
                clone(self.estimator).fit(X, own) for own in counted("mode", list(amplitudes.T))
            ]
        self.n_features_in_ = np.shape(X)[1]
        return self

    def refitted(self, X: ArrayLike, y: ArrayLike) -> Field:
        """A field fitted to some of the runs: modes of its own, regressors near these.

        A regressor that offers `refit_many` is given those of this field's modes to start from.
        """
        check_is_fitted(self)
        if not (refits_many(self.estimator) and self.estimators_):
            return Field(clone(self.estimator), self.explained).fit(X, y)
        other = Field(clone(self.estimator), self.explained)
        amplitudes = other._decompose(y)
        other.estimators_ = []
        if amplitudes.size:
            other.estimators_ = clone(self.estimator).refit_many(self.estimators_, X, amplitudes)
        other.n_features_in_ = np.shape(X)[1]
        return other

    def _decompose(self, y: ArrayLike) -> Array:
        """Mean and modes of fields y (n, ...); returns the amplitudes (n, k)."""
        fields = np.asarray(y, dtype=float)
        flat = fields.reshape(len(fields), -1)
        self.shape_ = fields.shape[1:]
        self.mean_ = flat.mean(axis=0)
        u, s, vt = _decomposed(flat - self.mean_, self.explained)
        energy = np.cumsum(s**2)
        # Differences within rounding of the values themselves are no mode.
        if energy[-1] <= 1e-28 * (flat**2).sum():
            count, self.truncation_error_ = 0, 0.0
        else:
            count = min(int(np.searchsorted(energy, self.explained * energy[-1])) + 1, len(s))
            self.truncation_error_ = float(np.sqrt(max(1.0 - energy[count - 1] / energy[-1], 0.0)))
        self.modes_ = vt[:count]
        self.found_: dict[Any, list[SobolIndices]] = {}
        self.leading_ = min(int(np.searchsorted(energy, DRAWN * energy[-1])) + 1, count)
        left = (u[:, count:] * s[count:]) @ vt[count:]
        self.left_out_ = np.sqrt((left**2).mean(axis=0))
        return np.asarray(u[:, :count] * s[:count])

    def minimum_runs(self, space: Space) -> int:
        """Runs that the regressor of one mode needs."""
        return self.estimator.minimum_runs(space) if has_minimum(self.estimator) else 2

    @property
    def interval_freedom(self) -> int | None:
        """Degrees of freedom of the modes' intervals; None where they have none of their own."""
        return min(
            (
                freedom
                for model in self.estimators_
                if (freedom := getattr(model, "interval_freedom", None)) is not None
            ),
            default=None,
        )

    @overload
    def predict(self, X: ArrayLike, return_std: Literal[False] = False) -> Array: ...
    @overload
    def predict(self, X: ArrayLike, return_std: Literal[True]) -> tuple[Array, Array]: ...
    def predict(self, X: ArrayLike, return_std: bool = False) -> Array | tuple[Array, Array]:
        """Fields (m, ...) at coded X (m, d).

        With `return_std` (when the modes' regressor offers it) their standard deviations,
        modes taken as independent and what they leave out included.
        """
        check_is_fitted(self)
        amplitudes, spread = self._amplitudes(np.asarray(X), return_std)
        fields: Array = (self.mean_ + amplitudes @ self.modes_).reshape(-1, *self.shape_)
        if not return_std:
            return fields
        variance = spread**2 @ self.modes_**2 + self.left_out_**2
        return fields, np.sqrt(variance).reshape(fields.shape)

    def _amplitudes(self, X: Array, return_std: bool) -> tuple[Array, Array]:
        """Amplitudes (m, k) of the modes and, if asked for, their standard deviations."""
        models, none = self.estimators_, np.zeros((len(X), 0))
        if not models:
            return none, none
        first = models[0]
        if predicts_many(first):
            if return_std:
                return first.predict_many(models, X, return_std=True)
            return first.predict_many(models, X), none
        if not return_std:
            return np.column_stack([model.predict(X) for model in models]), none
        answers = [model.predict(X, return_std=True) for model in models]
        mean, std = (np.column_stack(part) for part in zip(*answers, strict=True))
        return mean, std

    @_offered("sobol_indices")
    def sobol_indices(self, groups: Groups | None = None) -> SobolIndices:
        """Indices of the field's variance summed over its places, exact where the modes' are.

        The modes are orthonormal, so variances of amplitudes add: S_i = sum_k V_k S_ki / sum_k
        V_k (Lamboni, Monod and Makowski 2011, generalised sensitivity indices).
        """
        check_is_fitted(self)
        return self._summed(self._of_modes(groups), groups)

    def _of_modes(self, groups: Groups | None) -> list[SobolIndices]:
        """Indices of each mode's amplitude, computed once for the groups asked for."""
        asked = None if groups is None else tuple(map(tuple, groups))
        if asked not in self.found_:
            given = () if asked is None else (asked,)  # a regressor need not know groups
            models = self.estimators_
            if models and has_indices_of_many(models[0]):
                self.found_[asked] = models[0].sobol_indices_of_many(models, *given)
            else:
                self.found_[asked] = [
                    model.sobol_indices(*given) for model in counted("mode", models)
                ]
        return self.found_[asked]

    def _summed(self, modes: Sequence[SobolIndices], groups: Groups | None) -> SobolIndices:
        """Indices of a sum over orthonormal modes; all zero for a field that does not vary."""
        size = self.n_features_in_ if groups is None else len(groups)
        variances = np.array([mode.variance for mode in modes])
        total = float(variances.sum())
        weights = variances / total if total > 0.0 else np.zeros_like(variances)

        def share(name: str, *shape: int) -> Array:
            parts = np.array([getattr(mode, name) for mode in modes]).reshape(-1, *shape)
            return np.tensordot(weights, parts, axes=1)

        return SobolIndices(
            share("first_order", size),
            share("total", size),
            share("second_order", size, size),
            total,
            float(self.mean_.mean()),
        )

    @_offered("posterior_draws")
    def posterior_draws(self, size: int, seed: int | None = None) -> list[FieldDraw]:
        """Fields that are as plausible as the mean, given the runs; modes independent."""
        check_is_fitted(self)
        drawn = ModeDraws(self, size, np.random.SeedSequence(seed).spawn(len(self.estimators_)))
        return [FieldDraw(drawn, number) for number in range(size)]

    def portable(self) -> dict[str, Any]:
        """JSON-able description; see `surrogate.regressors.portable`."""
        check_is_fitted(self)
        common, amplitudes = portable.parted([model.portable() for model in self.estimators_])
        return {
            "kind": "field",
            "shape": list(self.shape_),
            "mean": self.mean_.tolist(),
            "modes": self.modes_.tolist(),
            "left_out": self.left_out_.tolist(),
            "common": common,
            "amplitudes": amplitudes,
        }


def _decomposed(fluctuations: Array, explained: float) -> tuple[Array, Array, Array]:
    """Singular value decomposition of fluctuations (n, size).

    From the eigenvalues of their products (Sirovich's method of snapshots), five times faster,
    where there are more places than runs and the modes that are kept lose no digits by it.
    """
    n, size = fluctuations.shape
    if n < size:
        squares, u = np.linalg.eigh(fluctuations @ fluctuations.T)
        squares, u = np.maximum(squares[::-1], 0.0), u[:, ::-1]
        energy = np.cumsum(squares)
        kept = squares[: int(np.searchsorted(energy, explained * energy[-1])) + 1]
        if kept[-1] > RESOLVED * squares[0]:
            s = np.sqrt(squares)
            return u, s, (u.T @ fluctuations) / np.maximum(s, 1e-8 * s[0])[:, None]
    u, s, vt = np.linalg.svd(fluctuations, full_matrices=False)
    return u, s, vt


@dataclass(frozen=True, eq=False)
class ModeDraws:
    """Draws of the modes' amplitudes of `field`, made when a mode is first asked for."""

    field: Field
    size: int
    seeds: Sequence[np.random.SeedSequence]
    made: dict[int, Sequence[Any]] = dataclass_field(default_factory=dict, repr=False)

    def of(self, mode: int, number: int) -> Any:
        """Draw `number` of the amplitude of a mode."""
        if mode not in self.made:
            model = self.field.estimators_[mode]
            self.made[mode] = model.posterior_draws(self.size, seed=self.seeds[mode])
        return self.made[mode][number]


@dataclass(frozen=True)
class FieldDraw:
    """A plausible field: draw `number` of the amplitude of each mode."""

    drawn: ModeDraws
    number: int

    def predict(self, X: ArrayLike) -> Array:
        """Fields (m, ...) at coded X (m, d)."""
        field = self.drawn.field
        draws = [self.drawn.of(k, self.number) for k in range(len(field.modes_))]
        values = np.array([draw.predict(X) for draw in draws]).reshape(len(draws), -1).T
        if not draws:
            values = np.zeros((len(np.asarray(X)), 0))
        return np.asarray(field.mean_ + values @ field.modes_).reshape(-1, *field.shape_)

    def sobol_indices(self, groups: Groups | None = None) -> SobolIndices:
        """Indices of its variance summed over places; see `Field.sobol_indices`."""
        given, field = () if groups is None else (groups,), self.drawn.field
        leading = [self.drawn.of(k, self.number) for k in range(field.leading_)]
        modes = [draw.sobol_indices(*given) for draw in leading]
        return field._summed([*modes, *field._of_modes(groups)[field.leading_ :]], groups)
