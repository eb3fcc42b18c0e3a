"""From `module:object` to an object, and to a solver that any process can build.

A worker process imports this module and what the solver needs, nothing else.
"""

from __future__ import annotations

import importlib
import sys
from collections.abc import Callable
from dataclasses import dataclass
from inspect import Parameter, signature
from pathlib import Path
from typing import Any


def imported(path: str, folder: Path | None = None) -> Any:
    """The object at `module:object`; raises whatever the import of the module raises.

    folder: where a module of the study's own may stand.
    """
    _make_importable(folder)
    module, _, attribute = path.partition(":")
    found = importlib.import_module(module)
    for part in attribute.split("."):
        found = getattr(found, part)
    return found


def _make_importable(folder: Path | None) -> None:
    """Let modules beside the study, and in the current folder, be imported, as scripts can."""
    for place in (folder, Path.cwd()):
        if place is not None and str(place) not in sys.path:
            sys.path.append(str(place))


@dataclass(frozen=True)
class SolverFactory:
    """Builds a study's solver in any process: `factory(**options)`.

    path    `module:object`, a class, a function, or a solver already built
    folder  where the study file lies: for its own modules and files
    """

    path: str
    folder: Path | None = None

    def __call__(self, **options: Any) -> Any:
        """The solver; the module's or the constructor's own error when it cannot be built."""
        found = imported(self.path, self.folder)
        if is_built(found):
            return found
        extra = {"folder": self.folder} if "folder" in parameters_of(found) else {}
        return found(**options, **extra)


def is_built(found: Any) -> bool:
    """True for a solver, False for a class or function that makes one."""
    return hasattr(found, "inputs") and not isinstance(found, type)


def parameters_of(function: Callable[..., Any]) -> dict[str, Parameter]:
    """Parameters of a callable by name; empty when it does not tell."""
    try:
        return dict(signature(function).parameters)
    except (TypeError, ValueError):
        return {}
