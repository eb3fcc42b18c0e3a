"""Names to objects: entry points and `module:object`.

Entry-point groups: `surrogate.solvers`, `surrogate.designs`,
`surrogate.augmentations`, `surrogate.regressors`, `surrogate.sensitivity`. The
built-in plug-ins are registered in the same way, so an installed package needs
no edit here.
"""

from __future__ import annotations

import importlib
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from difflib import get_close_matches
from importlib.metadata import EntryPoint, entry_points
from inspect import Parameter, getdoc, signature
from pathlib import Path
from typing import Any

from pydantic import ConfigDict, PydanticSchemaGenerationError, ValidationError, create_model
from typing_extensions import get_type_hints

from surrogate.errors import PluginError, SurrogateError, nearest
from surrogate.execution.answers import describe

SOLVERS = "surrogate.solvers"
DESIGNS = "surrogate.designs"
AUGMENTATIONS = "surrogate.augmentations"
REGRESSORS = "surrogate.regressors"
SENSITIVITY = "surrogate.sensitivity"
#: The groups, and what one of each is called.
NOUNS = {
    SOLVERS: "solver",
    DESIGNS: "design method",
    AUGMENTATIONS: "augmentation",
    REGRESSORS: "regressor",
    SENSITIVITY: "sensitivity method",
}


def available(group: str) -> dict[str, EntryPoint]:
    """Installed plug-ins of a group by name, sorted."""
    return {point.name: point for point in sorted(entry_points(group=group))}


def load(group: str, name: str, folder: Path | None = None) -> Any:
    """The object called `name`: an entry point of `group`, or `module:object`.

    folder: where a module of the study's own may stand. Raises `PluginError`
    when the name is unknown or the module does not load.
    """
    installed = available(group)
    if name in installed:
        return _load(name, installed[name].load)
    if ":" in name:
        _make_importable(folder)
        return _load(name, lambda: _resolve(name))
    raise PluginError(
        f"{NOUNS[group]} '{name}' is unknown; {nearest(name, installed)}; or write module:object"
    )


def _resolve(path: str) -> Any:
    module, _, attribute = path.partition(":")
    found = importlib.import_module(module)
    for part in attribute.split("."):
        found = getattr(found, part)
    return found


def _load(name: str, loader) -> Any:
    """RunInputs `loader`; whatever goes wrong in a stranger's module becomes one sentence."""
    try:
        return loader()
    except Exception as error:
        raise PluginError(f"'{name}' does not load: {type(error).__name__}: {error}") from error


def _make_importable(folder: Path | None) -> None:
    """Let modules beside the study, and in the current folder, be imported, as scripts can."""
    for place in (folder, Path.cwd()):
        if place is not None and str(place) not in sys.path:
            sys.path.append(str(place))


def call(what: str, function: Callable[..., Any], *given: Any, **options: Any) -> Any:
    """What a plug-in gives; whatever goes wrong in a stranger's code becomes one sentence."""
    try:
        return function(*given, **options)
    except SurrogateError:
        raise
    except Exception as error:
        raise PluginError(f"{what}: {describe(error)}") from error


@dataclass(frozen=True)
class SolverFactory:
    """Builds a study's solver in any process: `factory(**options)`.

    name    entry point or `module:object`
    folder  where the study file lies: for its own modules and files
    """

    name: str
    folder: Path | None = None

    def find(self) -> Any:
        """What the name stands for: a class, a function, or a solver already built."""
        return load(SOLVERS, self.name, self.folder)

    def __call__(self, **options: Any) -> Any:
        """The solver; `PluginError`, or the constructor's own error, when it cannot be built."""
        found = self.find()
        if _is_built(found):
            return found
        extra = {"folder": self.folder} if "folder" in parameters_of(found) else {}
        return found(**options, **extra)


def _is_built(found: Any) -> bool:
    return hasattr(found, "inputs") and not isinstance(found, type)


def parameters_of(function: Any) -> dict[str, Parameter]:
    """Parameters of a callable by name; empty when it does not tell."""
    try:
        return dict(signature(function).parameters)
    except (TypeError, ValueError):
        return {}


def option_mistakes(
    function: Any, options: Mapping[str, Any], given: tuple[str, ...] = ()
) -> list[tuple[str, str]]:
    """What is wrong with `options` for a plug-in's signature: (option, sentence) pairs.

    given: parameters that the framework fills in itself. Values are checked
    against the annotations where the plug-in has any.
    """
    if _is_built(function):
        return [
            (name, f"option '{name}' is not taken: this solver is an object, not a class")
            for name in options
        ]
    taken = {name: p for name, p in parameters_of(function).items() if name not in given}
    if any(p.kind is Parameter.VAR_KEYWORD for p in taken.values()):
        return []
    unknown = [name for name in options if name not in taken]
    mistakes = [(name, f"option '{name}' is unknown; {nearest(name, taken)}") for name in unknown]
    misspelt = {match for name in unknown for match in get_close_matches(name, taken, n=1)}
    mistakes += [
        ("", f"option '{name}' is needed")
        for name, p in taken.items()
        if p.default is Parameter.empty and name not in options and name not in misspelt
    ]
    if "seed" in taken and options.get("seed", 0) is None:
        mistakes.append(
            (
                "seed",
                "option 'seed' is empty: give a whole number, or leave it out; a "
                "study gives the same numbers each time",
            )
        )
    known = {name: value for name, value in options.items() if name in taken}
    return mistakes + _value_mistakes(function, taken, known)


def _value_mistakes(function, taken, options) -> list[tuple[str, str]]:
    target = function.__init__ if isinstance(function, type) else function
    try:
        hints = get_type_hints(target)
        model = create_model(
            "Options",
            __config__=ConfigDict(arbitrary_types_allowed=True),
            **{name: (hints.get(name, Any), None) for name in taken if name in options},
        )
        model.model_validate(dict(options))
    except ValidationError as error:
        return [
            (
                str(item["loc"][0]),
                f"option '{item['loc'][0]}': {options[item['loc'][0]]!r} "
                f"is not accepted: {item['msg'].lower()}",
            )
            for item in error.errors()
        ]
    except (NameError, TypeError, PydanticSchemaGenerationError):
        return []  # annotations that cannot be read are no reason to refuse the options
    return []


def summary(point: EntryPoint) -> str:
    """What a plug-in is, in its documentation's first line, or why it does not load.

    A function alone in a module of its name is described where the module begins.
    """
    try:
        found = point.load()
    except Exception as error:
        return f"does not load: {type(error).__name__}: {error}"
    alone = found.__module__.endswith(f".{getattr(found, '__name__', '')}")
    described = sys.modules[found.__module__] if alone else found
    return (getdoc(described) or "").strip().split("\n")[0]
