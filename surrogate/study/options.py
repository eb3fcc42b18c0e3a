"""Are these options what a plug-in takes? Its signature and annotations decide."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from difflib import get_close_matches
from inspect import Parameter
from typing import Any

from pydantic import (
    BaseModel,
    ConfigDict,
    PydanticSchemaGenerationError,
    ValidationError,
    create_model,
)
from typing_extensions import get_type_hints

from surrogate.errors import KeyPath, Mistake, nearest
from surrogate.stages.plugin import parameters_of
from surrogate.study.solver_factory import is_built


def option_mistakes(
    function: Any, options: Mapping[str, Any], given: tuple[str, ...] = ()
) -> list[Mistake]:
    """What is wrong with `options` for a plug-in's signature, each at the option's own path.

    given: parameters that the framework fills in itself. Values are checked
    against the annotations where the plug-in has any.
    """
    if is_built(function):
        said = "is not taken: this solver is an object, not a class"
        return [Mistake((name,), f"option '{name}' {said}") for name in options]
    taken = {name: p for name, p in parameters_of(function).items() if name not in given}
    if any(p.kind is Parameter.VAR_KEYWORD for p in taken.values()):
        return []
    unknown = [name for name in options if name not in taken]
    misspelt = {match for name in unknown for match in get_close_matches(name, taken, n=1)}
    mistakes = [
        Mistake((name,), f"option '{name}' is unknown; {nearest(name, taken)}", on_key=True)
        for name in unknown
    ]
    mistakes += [
        Mistake((), f"option '{name}' is needed", on_key=True)
        for name, p in taken.items()
        if p.default is Parameter.empty and name not in options and name not in misspelt
    ]
    if "seed" in taken and options.get("seed", 0) is None:
        sentence = (
            "option 'seed' is empty: give a whole number, or leave it out; a study gives the "
            "same numbers each time"
        )
        mistakes.append(Mistake(("seed",), sentence))
    known = {name: value for name, value in options.items() if name in taken}
    return mistakes + _value_mistakes(function, known)


def _value_mistakes(function: Callable[..., Any], options: Mapping[str, Any]) -> list[Mistake]:
    """Values that are not of the annotated types."""
    try:
        _model(function, options).model_validate(dict(options))
    except ValidationError as error:
        return [_of_wrong_type(item, options) for item in error.errors()]
    except (NameError, TypeError, PydanticSchemaGenerationError):
        return []  # annotations that cannot be read are no reason to refuse the options
    return []


def _model(function: Callable[..., Any], options: Mapping[str, Any]) -> type[BaseModel]:
    """The annotations of these options as a pydantic model."""
    target = getattr(function, "__init__") if isinstance(function, type) else function  # noqa: B009
    hints = get_type_hints(target)
    fields: dict[str, Any] = {name: (hints.get(name, Any), None) for name in options}
    return create_model("Options", __config__=ConfigDict(arbitrary_types_allowed=True), **fields)


def _of_wrong_type(item: Mapping[str, Any], options: Mapping[str, Any]) -> Mistake:
    path = _written(item["loc"], options)
    name = ".".join(map(str, path))
    given = item["input"]
    return Mistake(path, f"option '{name}': {given!r} is not accepted: {item['msg'].lower()}")


def _written(location: Sequence[str | int], options: Any) -> KeyPath:
    """Keys and indices as they stand in the options, without the names of types."""
    path: list[str | int] = []
    for part in location:
        if isinstance(options, Mapping) and part in options:
            options = options[part]
        elif isinstance(options, list | tuple) and isinstance(part, int) and part < len(options):
            options = options[part]
        else:
            continue
        path.append(part)
    return tuple(path)
