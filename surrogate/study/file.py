"""From the data of a study file to its parts, with every mistake of shape."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from difflib import get_close_matches
from typing import Any

from pydantic import BaseModel, ValidationError

from surrogate.errors import KeyPath, Mistake, nearest
from surrogate.study.parts.adaptive import AdaptivePart, AdaptiveUntilPart
from surrogate.study.parts.credibility import CredibilityPart, EvidencePart
from surrogate.study.parts.data import DataOutputPart, DataPart, DataTestPart
from surrogate.study.parts.execution import ExecutionPart
from surrogate.study.parts.inputs import ConstantPart, ParameterPart, SolverPart
from surrogate.study.parts.learning import LearningPart, UntilPart
from surrogate.study.parts.levels import LevelPart
from surrogate.study.parts.methods import (
    DesignPart,
    ScreeningPart,
    SensitivityPart,
    SurrogatePart,
    ValidationPart,
)
from surrogate.study.parts.reliability import ReliabilityPart
from surrogate.study.parts.solve import DesirePart, SolvePart, TargetPart
from surrogate.study.parts.study import KINDS_OF_DESIGN, StudyPart

#: Sections whose entries are checked one by one: a broken entry leaves the others standing.
_SECTIONS = (
    "parameters",
    "constants",
    "levels",
    "designs",
    "surrogates",
    "solve",
    "reliability",
)
_STAND_INS = {"study": "unnamed", "solver": "unnamed", "parameters": {}, "designs": {}}
#: Keys that a study without data needs.
_NEEDED = ("solver", "parameters", "designs")


def read(data: Any) -> tuple[StudyPart | None, list[Mistake], set[KeyPath]]:
    """The sound part of a study's data, every mistake of shape, and what was left out.

    A part that is needed but broken gets an empty stand-in, so that the rest can
    be checked. The study is None when it is not even a mapping.
    """
    if not isinstance(data, Mapping):
        return None, [Mistake((), "a study is a mapping that starts with 'study: NAME'")], set()
    mistakes = list(_keys_that_are_no_text(data, ()))
    broken = {_entry(mistake.path) for mistake in mistakes if mistake.path[0] in _SECTIONS}
    left: dict[str, Any] = dict(_with_text_keys(data) if mistakes else data)
    for key in _NEEDED if "data" not in left else ():
        if key not in left:
            mistakes.append(_needed(key, left))
            broken.add((key,))
            _leave_out(left, (key,))
    for path in broken:
        _leave_out(left, path)
    while True:
        try:
            return StudyPart.model_validate(left), mistakes, broken
        except ValidationError as error:
            found: list[dict[str, Any]] = [
                {**item, "loc": _as_written(item["loc"])} for item in error.errors()
            ]
            items = [item for item in found if not _covered(item["loc"], broken)]
            if not items:  # what is left is wrong because of what was left out
                return None, mistakes, broken
            mistakes += [_mistake(item) for item in items]
            removed = {_entry(tuple(item["loc"])) for item in items}
            broken |= removed
            for path in removed:
                _leave_out(left, path)


def _as_written(path: KeyPath) -> KeyPath:
    """The path without the tag by which pydantic tells kinds of designs."""
    tagged = path[:1] == ("designs",) and len(path) > 2 and path[2] in KINDS_OF_DESIGN
    return (*path[:2], *path[3:]) if tagged else tuple(path)


def _keys_that_are_no_text(part: Any, path: KeyPath) -> Iterator[Mistake]:
    """A mistake for each null, number or boolean that stands as a key, at any depth."""
    if isinstance(part, Mapping):
        for key, item in part.items():
            if not isinstance(key, str):
                shown = _WRITTEN.get(key, str(key))
                sentence = f"key {shown} must be a text: write a name, or put it in quotes"
                yield Mistake((*path, str(key)), sentence, on_key=True)
            yield from _keys_that_are_no_text(item, (*path, str(key)))
    elif isinstance(part, list | tuple):
        for index, item in enumerate(part):
            yield from _keys_that_are_no_text(item, (*path, index))


#: How YAML writes what Python calls None, True and False.
_WRITTEN = {None: "null", True: "true", False: "false"}


def _with_text_keys(part: Any) -> Any:
    """The same data without the keys that are no text."""
    if isinstance(part, Mapping):
        return {key: _with_text_keys(item) for key, item in part.items() if isinstance(key, str)}
    return [_with_text_keys(item) for item in part] if isinstance(part, list | tuple) else part


def _covered(path: KeyPath, broken: set[KeyPath]) -> bool:
    return any(tuple(path[:n]) in broken for n in range(1, len(path) + 1))


def _entry(path: KeyPath) -> KeyPath:
    """The part that is left out when something at `path` is wrong."""
    return path[:2] if path[0] in _SECTIONS and len(path) > 1 else path[:1]


def _leave_out(data: dict[str, Any], path: KeyPath) -> None:
    section = str(path[0])
    if len(path) == 1:
        data.pop(section, None)
        data.update({key: part for key, part in _STAND_INS.items() if key == section})
    else:
        data[section] = {key: v for key, v in data[section].items() if key != path[1]}


def _mistake(item: Mapping[str, Any]) -> Mistake:
    """One sentence for one of pydantic's errors."""
    path, kind, given = tuple(item["loc"]), item["type"], item.get("input")
    key = path[-1] if path else ""
    if kind == "extra_forbidden":
        return Mistake(
            path, f"key '{key}' is unknown; {nearest(str(key), _keys_at(path[:-1]))}", on_key=True
        )
    if kind == "missing" and isinstance(key, int):
        return Mistake(path[:-1], f"{_shown(path)}: must have {key + 1} entries")
    if kind == "missing":
        return replace(_needed(str(key), given or ()), path=path[:-1], on_key=len(path) > 1)
    if kind == "string_pattern_mismatch":
        name = given if isinstance(given, str) else key
        return Mistake(
            tuple(p for p in path if p != "[key]"),
            f"name '{name}' may hold letters, digits and _ only, and starts with a letter",
            on_key="[key]" in path,
        )
    return Mistake(path, f"{_shown(path)} {given!r}: {_wanted(kind, item)}")


def _needed(key: str, given: Iterable[Any]) -> Mistake:
    """A key that is missing, and which of the keys given may be meant."""
    close = get_close_matches(key, [str(word) for word in given], n=1)
    meant = f"; is '{close[0]}' meant to be '{key}'?" if close else ""
    rows = "; or data: FILE.csv for a table of runs that are done" if key == "solver" else ""
    return Mistake((), f"key '{key}' is needed here{meant or rows}")


def _shown(path: KeyPath) -> str:
    words = [str(p) for p in path if not isinstance(p, int)]
    return words[-1] if words else "study"


_KINDS = {
    "float_parsing": "must be a number",
    "float_type": "must be a number",
    "int_parsing": "must be a whole number",
    "int_type": "must be a whole number",
    "int_from_float": "must be a whole number",
    "string_type": "must be a text",
    "dict_type": "must be a mapping (key: value)",
    "model_type": "must be a mapping (key: value)",
    "model_attributes_type": "must be a mapping (key: value)",
    "tuple_type": "must be a list [.., ..]",
    "finite_number": "must be a finite number",
    "bool_parsing": "must be true or false",
}


def _wanted(kind: str, item: Mapping[str, Any]) -> str:
    context = item.get("ctx", {})
    if kind in ("greater_than", "greater_than_equal", "less_than", "less_than_equal"):
        word = {
            "greater_than": "above",
            "greater_than_equal": "at least",
            "less_than": "below",
            "less_than_equal": "at most",
        }[kind]
        limit = next(value for name, value in context.items() if name in ("gt", "ge", "lt", "le"))
        return f"must be {word} {limit:g}"
    if kind == "too_short" or kind == "too_long":
        wanted = context.get("min_length", context.get("max_length"))
        return (
            f"must have {wanted} entries"
            if kind == "too_long"
            else f"must have at least {wanted} {'entry' if wanted == 1 else 'entries'}"
        )
    if kind == "missing_argument":
        return "must have two entries"
    if kind == "value_error":
        return str(context.get("error", item["msg"]))
    message = str(item["msg"])
    return _KINDS.get(kind, message[:1].lower() + message[1:])


def _keys_at(path: KeyPath) -> list[str]:
    """Keys that a mapping of the study file at `path` takes."""
    if path[:1] == ("data",) and len(path) > 1:
        return list((DataTestPart if path[1] == "test" else DataOutputPart).model_fields)
    if path[:1] == ("solve",) and len(path) > 2:
        return list((TargetPart if path[2] == "target" else DesirePart).model_fields)
    if path[:1] == ("designs",) and len(path) > 2:
        return list((AdaptiveUntilPart if path[2] == "until" else DesignPart).model_fields)
    if path == ("learning", "until"):
        return list(UntilPart.model_fields)
    if path[:1] == ("credibility",) and len(path) > 1:
        return list(EvidencePart.model_fields)
    if path[:2] == ("validation", "models") and len(path) > 2:
        return list(SolverPart.model_fields)
    parts: dict[str | int, type[BaseModel]] = {
        "solver": SolverPart,
        "data": DataPart,
        "parameters": ParameterPart,
        "constants": ConstantPart,
        "levels": LevelPart,
        "designs": AdaptivePart,  # the others take any key: their options
        "surrogates": SurrogatePart,
        "sensitivity": SensitivityPart,
        "screening": ScreeningPart,
        "learning": LearningPart,
        "solve": SolvePart,
        "reliability": ReliabilityPart,
        "validation": ValidationPart,
        "credibility": CredibilityPart,
        "execution": ExecutionPart,
    }
    return list((parts[path[0]] if path else StudyPart).model_fields)
