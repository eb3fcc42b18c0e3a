"""From `module:object` to an object, and to a solver that any process can build.

A worker process imports this module and what the solver needs, nothing else.
"""

from __future__ import annotations

import importlib
import sys
from dataclasses import dataclass
from importlib.machinery import PathFinder
from pathlib import Path
from types import ModuleType
from typing import Any

from surrogate.stages.plugin import parameters_of


def imported(path: str, folder: Path | None = None) -> Any:
    """The object at `module:object`; raises whatever the import of the module raises.

    folder: where the study lies; its own modules come before all others.
    """
    module, _, attribute = path.partition(":")
    found: Any = _module(module, None if folder is None else folder.resolve())
    for part in attribute.split("."):
        found = getattr(found, part)
    return found


def _module(name: str, folder: Path | None) -> ModuleType:
    """The module of the study, of the current folder or installed, in this order.

    `solvers.x` is the built-in `surrogate_solvers.x` for those who have no such module:
    0.1.0 installed the built-in solvers under that name.
    """
    try:
        return _imported_beside(name, folder)
    except ModuleNotFoundError as error:
        missing = error.name is not None and f"{name}.".startswith(f"{error.name}.")
        if not (missing and name.startswith("solvers.")):
            raise
        try:
            return importlib.import_module(f"surrogate_{name}")
        except ModuleNotFoundError:
            raise error from None


#: Modules that stood beside a study when they were imported, and in which folder.
_BESIDE: dict[str, Path] = {}


def _imported_beside(name: str, folder: Path | None) -> ModuleType:
    """Import a module, from the study's folder first where it lies there.

    Modules of the same name from another study's folder are forgotten before. Both folders
    stay importable for what the module imports later.
    """
    for place in (folder, Path.cwd()):
        if place is not None and str(place) not in sys.path:
            sys.path.append(str(place))
    if folder is None or not _stands_in(folder, name.partition(".")[0]):
        return importlib.import_module(name)
    for top in [top for top, place in _BESIDE.items() if place != folder]:
        if _stands_in(folder, top):
            _forget(top)
    before = set(sys.modules)
    sys.path.insert(0, str(folder))
    try:
        return importlib.import_module(name)
    finally:
        sys.path.remove(str(folder))
        new = (sys.modules[one] for one in set(sys.modules) - before if "." not in one)
        _BESIDE.update({module.__name__: folder for module in new if _lies_in(folder, module)})


def _stands_in(folder: Path, name: str) -> bool:
    return PathFinder.find_spec(name, [str(folder)]) is not None


def _lies_in(folder: Path, module: ModuleType) -> bool:
    """True for a module or package directly in the folder."""
    places = [*getattr(module, "__path__", ()), getattr(module, "__file__", None)]
    return any(place is not None and Path(place).parent == folder for place in places)


def _forget(top: str) -> None:
    del _BESIDE[top]
    for name in [name for name in sys.modules if name == top or name.startswith(f"{top}.")]:
        del sys.modules[name]


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
