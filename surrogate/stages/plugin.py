"""Calls of other people's code: what goes wrong in it becomes one sentence."""

from __future__ import annotations

from collections.abc import Callable
from inspect import Parameter, signature
from typing import Any

from surrogate.errors import PluginError, SurrogateError


def call(what: str, function: Callable[..., Any], *given: Any, **options: Any) -> Any:
    """What a plug-in gives; whatever goes wrong in a stranger's code becomes one sentence."""
    try:
        return function(*given, **options)
    except SurrogateError:
        raise
    except Exception as error:
        from surrogate.execution.answers import describe  # NumPy: `surrogate list` needs none

        raise PluginError(f"{what}: {describe(error)}") from error


def parameters_of(function: Any) -> dict[str, Parameter]:
    """Parameters of a callable by name; empty when it does not tell."""
    try:
        return dict(signature(function).parameters)
    except (TypeError, ValueError):
        return {}
