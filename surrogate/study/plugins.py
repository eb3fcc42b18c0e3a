"""Names to objects: entry points and `module:object`.

Entry-point groups: `surrogate.solvers`, `surrogate.designs`,
`surrogate.augmentations`, `surrogate.regressors`, `surrogate.sensitivity`. The
built-in plug-ins are registered in the same way, so an installed package needs
no edit here.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping
from difflib import get_close_matches
from importlib.metadata import EntryPoint, entry_points
from inspect import Parameter, getdoc
from pathlib import Path
from typing import Any

from pydantic import ConfigDict, PydanticSchemaGenerationError, ValidationError, create_model
from typing_extensions import get_type_hints

from surrogate.errors import PluginError, SurrogateError, nearest
from surrogate.execution.answers import describe
from surrogate.study.solver_factory import imported, is_built, parameters_of

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


def path_of(group: str, name: str) -> str:
    """`module:object` of the plug-in called `name`; raises `PluginError` when it is unknown."""
    if ":" in name:
        return name
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


def call(what: str, function: Callable[..., Any], *given: Any, **options: Any) -> Any:
    """What a plug-in gives; whatever goes wrong in a stranger's code becomes one sentence."""
    try:
        return function(*given, **options)
    except SurrogateError:
        raise
    except Exception as error:
        raise PluginError(f"{what}: {describe(error)}") from error


def option_mistakes(
    function: Any, options: Mapping[str, Any], given: tuple[str, ...] = ()
) -> list[tuple[str, str]]:
    """What is wrong with `options` for a plug-in's signature: (option, sentence) pairs.

    given: parameters that the framework fills in itself. Values are checked
    against the annotations where the plug-in has any.
    """
    if is_built(function):
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
