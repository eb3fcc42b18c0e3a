"""The options of a command solver: their words, types and meaning."""

from __future__ import annotations

import copy
import math
import re
import shlex
import shutil
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from surrogate.errors import KeyPath, Mistake, StudyError, nearest
from surrogate.solver import Input, Output
from surrogate.space import units

from . import templates


class _Strict(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class InputOptions(_Strict):
    """An input as the study declares it; the words are those of `surrogate.solver.Input`."""

    unit: str = ""
    nominal: float | str | None = None
    range: tuple[float, float] = (-math.inf, math.inf)
    levels: tuple[str, ...] = ()
    description: str = ""
    source: str = ""


class Csv(_Strict):
    """A cell of a CSV file, or a whole column when `row` is left out."""

    column: int | str
    row: int | None = None
    delimiter: str = Field(",", min_length=1, max_length=1)
    skip: int = Field(0, ge=0)
    header: bool = True
    comment: str = "#"


class Table(_Strict):
    """The same of a table whose columns are separated by white space."""

    column: int | str
    row: int | None = None
    skip: int = Field(0, ge=0)
    header: bool = False
    comment: str = "#"


class Spread(_Strict):
    """Evenly spaced coordinates: {from: 0, to: 1, count: 101}."""

    start: float = Field(alias="from")
    stop: float = Field(alias="to")
    count: int = Field(ge=1)


class OutputOptions(_Strict):
    """Where an output is found: `file` (what the program prints when left out) and a reader.

    dims: for an array, dimension -> coordinate values, their number, or {from, to, count}.
    """

    unit: str = ""
    description: str = ""
    file: str | None = None
    regex: str | None = None
    pointer: str | None = None
    csv: Csv | None = None
    table: Table | None = None
    dims: dict[str, list[float] | int | Spread] = Field(default_factory=dict)


class Options(_Strict):
    """All options; `templates` and `files`: name in the working folder -> path of the study."""

    command: list[str] | str
    inputs: dict[str, InputOptions]
    outputs: dict[str, OutputOptions]
    templates: dict[str, str] = Field(default_factory=dict)
    files: list[str] | dict[str, str] = Field(default_factory=list)
    delimiters: tuple[str, str] = ("{{", "}}")
    exit_codes: list[int] = [0]
    timeout: float | str | None = None
    keep: str | None = None
    program_version: str = ""


def validated(given: Mapping[str, Any]) -> tuple[Options, list[str]]:
    """The options with their types, and a sentence for each one that is unknown or of a
    wrong type and was left out; raises `StudyError` when they cannot do without it."""
    try:
        return Options.model_validate(given), []
    except ValidationError as error:
        sentences = list(dict.fromkeys(map(_sentence, error.errors())))
        remaining = copy.deepcopy(dict(given))
        for place in {tuple(_place(item)) for item in error.errors()}:
            _remove(remaining, place)
        try:
            return Options.model_validate(remaining), sentences
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


def _sentence(error: Mapping[str, Any]) -> str:
    where = ".".join(map(str, _place(error)))
    if error["type"] == "extra_forbidden":
        allowed: dict[Any, type[BaseModel]] = {
            "inputs": InputOptions,
            "outputs": OutputOptions,
            "csv": Csv,
            "table": Table,
        }
        model = next((allowed[part] for part in reversed(error["loc"]) if part in allowed), Options)
        return f"{where}: is unknown; {nearest(str(error['loc'][-1]), model.model_fields)}"
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


def arguments(options: Options) -> list[str]:
    """The program and its arguments; a text is split as a shell would, but no shell runs it.

    Spaces inside a placeholder do not split. Raises `StudyError` for an open quote.
    """
    if not isinstance(options.command, str):
        return list(options.command)
    left, right = options.delimiters
    closed = templates.pattern(options.delimiters).sub(
        lambda found: left + found[1].replace(" ", "") + right, options.command
    )
    try:
        return shlex.split(closed)
    except ValueError as error:
        raise StudyError(
            f"command: {options.command!r} cannot be split ({error}); write a list of words instead"
        ) from error


def program(word: str, folder: Path) -> str | None:
    """Where the program is: on the PATH, or relative to the study when it has a slash."""
    return shutil.which(str(folder / word) if "/" in word else word)


def seconds(timeout: float | str | None) -> float | None:
    """The time-out in seconds, from a number or a text such as `30 min`."""
    if timeout is None:
        return None
    try:
        value = units.seconds(timeout)
    except StudyError:
        shown = str(timeout)[:60]
        raise StudyError(f"timeout: {shown!r} is not a time; write 30 min or 600 s") from None
    if not 0 < value < math.inf:
        raise StudyError(
            f"timeout: {timeout if isinstance(timeout, str) else f'{timeout:g} s'} must be above 0"
        )
    return float(value)


def files(options: Options) -> dict[str, str]:
    """Name in the working folder -> path relative to the study, of files to copy."""
    if isinstance(options.files, Mapping):
        return dict(options.files)
    return {Path(path).name: path for path in options.files}


def inputs(options: Options) -> dict[str, Input]:
    """The declared inputs as the solver contract has them."""
    return {name: Input(**given.model_dump()) for name, given in options.inputs.items()}


def outputs(options: Options) -> dict[str, Output]:
    """The declared outputs as the solver contract has them."""
    return {
        name: Output(
            unit=given.unit,
            dims=tuple(given.dims),
            description=given.description,
            coordinates={dim: _coordinates(c) for dim, c in given.dims.items()},
        )
        for name, given in options.outputs.items()
    }


def _coordinates(given: list[float] | int | Spread) -> np.ndarray:
    if isinstance(given, int):
        return np.arange(float(given))
    if isinstance(given, Spread):
        return np.linspace(given.start, given.stop, given.count)
    return np.array(given, dtype=float)
