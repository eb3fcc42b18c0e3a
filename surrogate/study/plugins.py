"""Names to objects: entry points and `module:object`.

Entry-point groups: `surrogate.solvers`, `surrogate.designs`,
`surrogate.augmentations`, `surrogate.regressors`, `surrogate.sensitivity`,
`surrogate.executors`. The built-in plug-ins are registered in the same way, so an
installed package needs no edit here.
"""

from __future__ import annotations

import sys
from functools import lru_cache
from importlib.metadata import EntryPoint, EntryPoints, entry_points
from pathlib import Path
from typing import Any

from surrogate.errors import PluginError, nearest
from surrogate.study.solver_factory import imported

SOLVERS = "surrogate.solvers"
DESIGNS = "surrogate.designs"
AUGMENTATIONS = "surrogate.augmentations"
REGRESSORS = "surrogate.regressors"
SENSITIVITY = "surrogate.sensitivity"
EXECUTORS = "surrogate.executors"
#: The groups, and what one of each is called.
NOUNS = {
    SOLVERS: "solver",
    DESIGNS: "design method",
    AUGMENTATIONS: "augmentation",
    REGRESSORS: "regressor",
    SENSITIVITY: "sensitivity method",
    EXECUTORS: "executor",
}


def available(group: str) -> dict[str, EntryPoint]:
    """Installed plug-ins of a group by name, sorted."""
    return {point.name: point for point in sorted(_installed(tuple(sys.path))[group])}


@lru_cache(maxsize=1)
def _installed(path: tuple[str, ...]) -> dict[str, EntryPoints]:
    """Plug-ins by group of all packages on `path`: a file of each package has to be read."""
    found = entry_points()
    return {group: found.select(group=group) for group in NOUNS}


def path_of(group: str, name: str) -> str:
    """`module:object` of the plug-in called `name`; raises `PluginError` when it is unknown."""
    if ":" in name:
        return name
    installed = available(group)
    if name not in installed:  # it may have been installed since
        _installed.cache_clear()
        installed = available(group)
    if name in installed:
        return f"{installed[name].module}:{installed[name].attr}"
    raise PluginError(
        f"{NOUNS[group]} '{name}' is unknown; {nearest(name, installed)}; or write module:object"
    )


def load(group: str, name: str, folder: Path | None = None) -> Any:
    """The object called `name`: an entry point of `group`, or `module:object`.

    folder: where a module of the study's own may stand. Raises `PluginError`
    when the name is unknown or the module does not load.
    """
    path = path_of(group, name)
    try:
        return imported(path, folder)
    except Exception as error:  # a stranger's module raises whatever it likes
        raise PluginError(f"'{name}' does not load: {type(error).__name__}: {error}") from error
