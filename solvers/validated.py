"""Options of a solver read by pydantic: every mistake as a sentence, at its own place."""

from __future__ import annotations

import copy
import re
from collections.abc import Mapping
from typing import Any, TypeVar

from pydantic import BaseModel, ConfigDict, ValidationError

from surrogate.errors import KeyPath, Mistake, StudyError, nearest


class Strict(BaseModel):
    """Options that are frozen and know their words."""

    model_config = ConfigDict(extra="forbid", frozen=True)


Model = TypeVar("Model", bound=Strict)


def validated(
    model: type[Model], given: Mapping[str, Any], parts: Mapping[str, type[Strict]]
) -> tuple[Model, list[str]]:
    """The options with their types, and a sentence for each one that is unknown or of a
    wrong type and was left out; raises `StudyError` when they cannot do without it.

    parts: the models of what stands below some keys, for the words that are allowed there.
    """
    try:
        return model.model_validate(given), []
    except ValidationError as error:
        sentences = list(dict.fromkeys(_sentence(one, model, parts) for one in error.errors()))
        remaining = copy.deepcopy(dict(given))
        for place in {tuple(_place(item)) for item in error.errors()}:
            _remove(remaining, place)
        try:
            return model.model_validate(remaining), sentences
        except ValidationError:
            raise StudyError(*(placed(sentence, given) for sentence in sentences)) from error


def placed(sentence: str, options: Mapping[str, Any]) -> Mistake:
    """The sentence with the place that its first words, such as `outputs.y.csv:`, lead to."""
    where, _, text = sentence.partition(": ")
    return Mistake(_followed(where, options), sentence, on_key=text.startswith("is unknown"))


def _followed(where: str, options: Any) -> KeyPath:
    """Keys and indices of the options that a dotted name leads through."""
    parts = dict(enumerate(options)) if isinstance(options, list | tuple) else options
    for key, item in parts.items() if isinstance(parts, Mapping) else ():
        if where == str(key) or where.startswith(f"{key}."):
            return (key, *_followed(where[len(str(key)) + 1 :], item))
    return ()


def _remove(options: Any, place: tuple[Any, ...]) -> None:
    for part in place[:-1]:
        options = options.get(part) if isinstance(options, dict) else None
    if isinstance(options, dict):
        options.pop(place[-1], None)


def _sentence(
    error: Mapping[str, Any], model: type[Strict], parts: Mapping[str, type[Strict]]
) -> str:
    where = ".".join(map(str, _place(error)))
    if error["type"] == "extra_forbidden":
        below = next((parts[part] for part in reversed(error["loc"]) if part in parts), model)
        return f"{where}: is unknown; {nearest(str(error['loc'][-1]), below.model_fields)}"
    if error["type"] == "missing":
        return f"{where}: is needed"
    return f"{where}: {error['input']!r} is not accepted: {error['msg'].lower()}"


def _place(error: Mapping[str, Any]) -> list[Any]:
    """Keys that lead to a mistake, without the names of types that pydantic adds."""
    return [
        part
        for part in error["loc"]
        if not (
            isinstance(part, str) and re.fullmatch(r"(list|dict)\[.*\]|str|int|float|Spread", part)
        )
    ]
