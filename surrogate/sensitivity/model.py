"""What is analysed: a fitted surrogate, or any function of coded points."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from surrogate.errors import StudyError
from surrogate.space.space import Space


@dataclass(frozen=True)
class Model:
    """One output as a function of coded points.

    predict    coded (run, parameter) -> values (run,) or (run, ...)
    surrogate  name of the surrogate, "" for a plain function
    q2         share of the variance of unseen runs that it predicts; None when unknown
    estimator  the fitted estimator on coded points, None for a plain function
    coded      (n, d) and values (n, ...): what it learnt from, None for a plain function
    """

    predict: Callable[[np.ndarray], np.ndarray]
    space: Space
    surrogate: str = ""
    output: str = "y"
    q2: float | None = None
    estimator: Any = None
    coded: np.ndarray | None = None
    values: np.ndarray | None = None


def model(fit, space: Space, *, q2: float | None = None) -> Model:
    """The model of a `Fit`, or of a plain function of coded points.

    q2 replaces the fit's own figure, for instance by that of a held-out design.
    """
    if hasattr(fit, "estimator"):
        return Model(
            fit.predict,
            space,
            fit.surrogate,
            fit.output,
            _known(q2, fit),
            fit.estimator,
            fit.coded,
            fit.values,
        )
    if not callable(fit):
        raise StudyError(
            f"sensitivity analysis takes a fit or a function of coded points, "
            f"not {type(fit).__name__}"
        )
    return Model(fit, space, getattr(fit, "__name__", "function"), q2=q2)


def _known(q2: float | None, fit) -> float | None:
    q2 = getattr(fit, "q2", None) if q2 is None else q2
    return None if q2 is None else float(q2)


def rests(values: np.ndarray) -> bool:
    """True when values (run, ...) differ from run to run by rounding only."""
    return bool(np.ptp(values, axis=0).max() <= 1e-14 * np.abs(values).max())


def require_at_least(least: int, **options: int) -> None:
    """Refuse counts that are too small to mean anything."""
    for name, value in options.items():
        if not value >= least:
            raise StudyError(f"{name}: {value} is too few; take {least} or more")


def require_independent(space: Space, method: str) -> None:
    """Refuse correlated parameters, for methods whose results they would spoil."""
    if not space.independent:
        raise StudyError(
            f"sensitivity method {method} needs independent parameters, but these are "
            "correlated: first-order and total indices then no longer split the variance (they "
            "may sum to more than 1). Use method shapley, whose effects always sum to 1"
        )
