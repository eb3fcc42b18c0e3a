"""What can be wrong with the options of a command solver before its first run."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping
from pathlib import Path, PurePosixPath

from surrogate.errors import StudyError, nearest
from surrogate.space import units

from . import process, templates
from .options import (
    Csv,
    InputOptions,
    Options,
    OutputOptions,
    Table,
    arguments,
    files,
    inputs,
    program,
    seconds,
)


def mistakes(options: Options, folder: Path, texts: Mapping[str, str]) -> Iterable[str]:
    """What is wrong beyond types; texts: template's path -> contents (those that were read)."""
    yield from _command_mistakes(options, folder)
    yield from _timeout_mistakes(options.timeout)
    for name, given in options.inputs.items():
        yield from _input_mistakes(name, given)
    for name, output in options.outputs.items():
        yield from _output_mistakes(name, output)
    yield from _file_mistakes(options, folder)
    yield from _keep_mistakes(options.keep, folder)
    yield from _placeholder_mistakes(options, texts)


def _command_mistakes(options: Options, folder: Path) -> Iterable[str]:
    try:
        words = arguments(options)
    except StudyError as error:
        yield from error.mistakes
        return
    if not words:
        yield "command: is empty; write the program and its arguments"
    elif program(words[0], folder) is None:
        where = f"relative to {folder}" if "/" in words[0] else "on the PATH"
        yield f"command: program '{words[0]}' is not found or not executable {where}"
    if not options.outputs:
        yield "outputs: is empty; say what to read back"
    if not options.exit_codes:
        yield "exit_codes: is empty; give the accepted ones, such as [0]"
    if not all(options.delimiters) or options.delimiters[0] == options.delimiters[1]:
        yield f"delimiters: {list(options.delimiters)} must be two different texts"


def _timeout_mistakes(timeout: float | str | None) -> Iterable[str]:
    try:
        seconds(timeout)
    except StudyError as error:
        yield from error.mistakes


def _input_mistakes(name: str, given: InputOptions) -> Iterable[str]:
    if not name.isidentifier():
        yield f"inputs.{name}: a name has letters, digits and _ only"
    yield from _unit_mistakes(f"inputs.{name}", given.unit)
    low, high = given.range
    if given.levels:
        if math.isfinite(low) or math.isfinite(high):
            yield f"inputs.{name}: give either range or levels, not both"
        if given.nominal is not None and given.nominal not in given.levels:
            yield (
                f"inputs.{name}.nominal: {given.nominal!r} is not a level; "
                f"{nearest(str(given.nominal), given.levels)}"
            )
    elif not low < high:
        yield f"inputs.{name}.range: [{low:g}, {high:g}] is upside down; write [smallest, largest]"
    elif isinstance(given.nominal, str):
        yield f"inputs.{name}.nominal: {given.nominal!r} is not a number; or give levels"
    elif given.nominal is not None and not low <= given.nominal <= high:
        yield (f"inputs.{name}.nominal: {given.nominal:g} lies outside range [{low:g}, {high:g}]")


def _unit_mistakes(where: str, unit: str) -> Iterable[str]:
    if not units.known(unit):
        yield f"{where}.unit: '{unit}' is not a unit; write for instance mm, N/mm, kPa or mmHg"


def _output_mistakes(name: str, given: OutputOptions) -> Iterable[str]:
    where = f"outputs.{name}"
    yield from _unit_mistakes(where, given.unit)
    readers = [
        word for word in ("regex", "pointer", "csv", "table") if getattr(given, word) is not None
    ]
    if len(readers) != 1:
        yield f"{where}: give one of regex, pointer, csv and table ({len(readers)} given)"
    yield from _regex_mistakes(where, given.regex)
    if given.pointer and not given.pointer.startswith("/"):
        yield f"{where}.pointer: '{given.pointer}' must start with /, such as /result/0/value"
    for reader in (given.csv, given.table):
        if reader is not None:
            yield from _column_mistakes(where, reader, bool(given.dims))
    for dim, coordinates in given.dims.items():
        if not dim.isidentifier() or dim == name:
            yield f"{where}.dims: '{dim}' must be a name of its own, of letters, digits and _"
        if coordinates == [] or (isinstance(coordinates, int) and coordinates < 1):
            yield f"{where}.dims.{dim}: needs at least one coordinate"
    if given.file is not None:
        yield from _place_mistakes(f"{where}.file", given.file)


def _column_mistakes(where: str, reader: Csv | Table, array: bool) -> Iterable[str]:
    if isinstance(reader.column, str) and not reader.header:
        yield f"{where}: column '{reader.column}' needs header: true, or give its number"
    if (reader.row is None) != array:
        yield (
            f"{where}: give either row, for a single number (-1 is the last), "
            "or dims, for the whole column"
        )


def _regex_mistakes(where: str, regex: str | None) -> Iterable[str]:
    if regex is None:
        return
    try:
        groups = re.compile(regex, re.MULTILINE).groups
    except re.error as error:
        yield f"{where}.regex: {regex!r} is not a regular expression ({error})"
        return
    if groups > 1:
        yield (
            f"{where}.regex: {regex!r} has {groups} groups; put one pair of ( ) around the "
            "number and write (?: ) elsewhere"
        )


def _place_mistakes(where: str, name: str) -> Iterable[str]:
    """A name in the working folder may not lead out of it."""
    if PurePosixPath(name).is_absolute() or ".." in PurePosixPath(name).parts or not name:
        yield f"{where}: '{name}' must lie in the working folder: a relative path without '..'"


def _file_mistakes(options: Options, folder: Path) -> Iterable[str]:
    copied = files(options)
    for option, given in (("templates", options.templates), ("files", copied)):
        for name, path in given.items():
            yield from _place_mistakes(option, name)
            if name in (process.STDOUT, process.STDERR):
                yield f"{option}: '{name}' is where the program's own words go; take another name"
            if not (folder / path).exists():
                yield f"{option}: {folder / path} does not exist"
            elif option == "templates" and not (folder / path).is_file():
                yield f"{option}: {folder / path} is not a file"
    for name in set(copied) & set(options.templates):
        yield f"files: '{name}' is made from a template already"
    if isinstance(options.files, list) and len(copied) < len(options.files):
        yield "files: two of them have the same name; write name: path for each"


def _keep_mistakes(keep: str | None, folder: Path) -> Iterable[str]:
    """What is kept stays inside the study's folder, links followed."""
    if keep is not None and not (folder / keep).resolve().is_relative_to(folder.resolve()):
        yield f"keep: '{keep}' must lie inside the study's folder: a relative path without '..'"


def _placeholder_mistakes(options: Options, texts: Mapping[str, str]) -> Iterable[str]:
    try:
        words = [("command", word) for word in arguments(options)]
        placeholder = templates.pattern(options.delimiters)
    except StudyError:
        return  # said already
    known = inputs(options)
    used: set[str] = set()
    for where, text in [*texts.items(), *words]:
        used |= templates.names(text, placeholder)
        yield from templates.mistakes(text, where, placeholder, known)
    for name in known.keys() - used if len(texts) == len(set(options.templates.values())) else ():
        left, right = options.delimiters
        yield (
            f"inputs.{name}: is used nowhere; write {left} {name} {right} in a template or in "
            "the command, or leave the input out"
        )
