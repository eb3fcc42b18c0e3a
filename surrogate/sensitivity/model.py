"""What is analysed: a fitted surrogate, or any function of coded points."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from typing_extensions import TypeIs

from surrogate.errors import StudyError
from surrogate.estimator import Array, Predictor, Regressor
from surrogate.space.space import Space

#: Values (run,) or (run, ...) at coded points (run, parameter).
Predict = Callable[[Array], Array]
Seed = int | Sequence[int] | None


class Fitted(Protocol):
    """What sensitivity reads of a fit; `q2` besides, where it has one."""

    @property
    def surrogate(self) -> str: ...

    @property
    def output(self) -> str: ...

    @property
    def estimator(self) -> Regressor: ...

    @property
    def coded(self) -> Array: ...

    @property
    def values(self) -> Array: ...

    def predict(self, coded: Array, /) -> Array: ...


#: What a sensitivity method analyses: a fit, or any function of coded points.
Analysed = Fitted | Predict


@dataclass(frozen=True)
class Learnt:
    """A fitted estimator with the coded points (n, d) and values (n, ...) it learnt from."""

    estimator: Regressor
    coded: Array
    values: Array


@dataclass(frozen=True)
class Model:
    """One output as a function of coded points.

    predict    coded (run, parameter) -> values (run,) or (run, ...)
    surrogate  name of the surrogate, "" for a plain function
    q2         share of the variance of unseen runs that it predicts; None when unknown
    learnt     the fitted estimator and its runs, None for a plain function
    """

    predict: Predict
    space: Space
    surrogate: str = ""
    output: str = "y"
    q2: float | None = None
    learnt: Learnt | None = None

    @property
    def estimator(self) -> Regressor | None:
        """The fitted estimator on coded points, None for a plain function."""
        return None if self.learnt is None else self.learnt.estimator

    @property
    def predictor(self) -> Predictor:
        """The fitted estimator; for a plain function, the model itself."""
        return self if self.learnt is None else self.learnt.estimator


def model(fit: Analysed, space: Space, *, q2: float | None = None) -> Model:
    """The model of a `Fit`, or of a plain function of coded points.

    q2 replaces the fit's own figure, for instance by that of a held-out design.
    """
    if _is_fit(fit):
        learnt = Learnt(fit.estimator, fit.coded, fit.values)
        return Model(fit.predict, space, fit.surrogate, fit.output, _known(q2, fit), learnt)
    if not callable(fit):
        raise StudyError(
            f"sensitivity analysis takes a fit or a function of coded points, "
            f"not {type(fit).__name__}"
        )
    return Model(fit, space, getattr(fit, "__name__", "function"), q2=q2)


def _is_fit(fit: Analysed) -> TypeIs[Fitted]:
    return hasattr(fit, "estimator")


def _known(q2: float | None, fit: Fitted) -> float | None:
    q2 = getattr(fit, "q2", None) if q2 is None else q2
    return None if q2 is None else float(q2)


def rests(values: Array) -> bool:
    """True when values (run, ...) differ from run to run by rounding only."""
    return bool(np.ptp(values, axis=0).max() <= 1e-14 * np.abs(values).max())


def require_at_least(least: int, **options: int) -> None:
    """Refuse counts that are too small to mean anything."""
    for name, value in options.items():
        if not value >= least:
            raise StudyError(f"{name}: {value} is too few; take {least} or more")
