"""What sensitivity methods ask for: independent parameters or not, a surrogate or the runs."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

import xarray as xr

from surrogate.errors import StudyError
from surrogate.space.space import Space

Method = TypeVar("Method", bound=Callable[..., xr.Dataset])


def needs_independent(method: Method) -> Method:
    """Marks such a sensitivity method, so that a study refuses it before any run."""
    method.__dict__["needs_independent"] = True
    return method


def takes_correlated(method: Method) -> Method:
    """Marks a method that takes correlated parameters, but none that constraints join."""
    method.__dict__["takes_correlated"] = True
    return method


def reads_runs(method: Method) -> Method:
    """Marks a method that reads the runs themselves, and no surrogate."""
    method.__dict__["reads_runs"] = True
    return method


def needs_no_surrogate(method: object) -> bool:
    """True when the method reads the runs themselves."""
    return bool(getattr(method, "reads_runs", False))


def spoilt(method: object, space: Space) -> bool:
    """True when the method needs independent parameters and these are not.

    One that takes correlated ones is spoilt by constraints alone.
    """
    if getattr(method, "takes_correlated", False):
        return bool(space.constraints)
    return bool(getattr(method, "needs_independent", False)) and not space.independent


def require_independent(space: Space, method: str) -> None:
    """Refuse dependent parameters, for methods whose results they would spoil."""
    if not space.independent:
        joined = "joined by constraints" if space.constraints else "correlated"
        raise StudyError(
            f"sensitivity method {method} needs independent parameters, but these are "
            f"{joined}: first-order and total indices then no longer split the variance (they "
            "may sum to more than 1). Use method shapley, whose effects always sum to 1"
            + ("" if space.constraints else ", or dependent_sobol")
        )


def require_no_constraints(space: Space, method: str) -> None:
    """Refuse parameters that constraints join."""
    if space.constraints:
        raise StudyError(
            f"sensitivity method {method} takes correlated parameters, but none that constraints "
            "join: what is independent of the others is then not defined. Use method shapley"
        )
