"""The options of a command solver: their words, types and meaning."""

from __future__ import annotations

import math
import shlex
import shutil
from collections.abc import Mapping
from pathlib import Path

from pydantic import Field

from surrogate.errors import StudyError
from surrogate.space import units

from ..declared import DeclaredInput, DeclaredOutput
from ..validated import Strict
from . import templates


class Csv(Strict):
    """A cell of a CSV file, or a whole column when `row` is left out."""

    column: int | str
    row: int | None = None
    delimiter: str = Field(",", min_length=1, max_length=1)
    skip: int = Field(0, ge=0)
    header: bool = True
    comment: str = "#"


class Table(Strict):
    """The same of a table whose columns are separated by white space."""

    column: int | str
    row: int | None = None
    skip: int = Field(0, ge=0)
    header: bool = False
    comment: str = "#"


class OutputOptions(DeclaredOutput):
    """Where an output is found: `file` (what the program prints when left out) and a reader."""

    file: str | None = None
    regex: str | None = None
    pointer: str | None = None
    csv: Csv | None = None
    table: Table | None = None


class Options(Strict):
    """All options; `templates` and `files`: name in the working folder -> path of the study."""

    command: list[str] | str
    inputs: dict[str, DeclaredInput]
    outputs: dict[str, OutputOptions]
    templates: dict[str, str] = Field(default_factory=dict)
    files: list[str] | dict[str, str] = Field(default_factory=list)
    delimiters: tuple[str, str] = ("{{", "}}")
    exit_codes: list[int] = [0]
    timeout: float | str | None = None
    keep: str | None = None
    program_version: str = ""


#: The models of what stands below some keys of the options.
PARTS: dict[str, type[Strict]] = {
    "inputs": DeclaredInput,
    "outputs": OutputOptions,
    "csv": Csv,
    "table": Table,
}


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
