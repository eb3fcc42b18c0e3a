"""What can be wrong with the options of a command solver before its first run."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from pathlib import Path, PurePosixPath

from surrogate.errors import StudyError

from .. import declared
from . import process, templates
from .options import Csv, Options, OutputOptions, Table, arguments, files, program, seconds


def mistakes(options: Options, folder: Path, texts: Mapping[str, str]) -> Iterable[str]:
    """What is wrong beyond types; texts: template's path -> contents (those that were read)."""
    yield from _command_mistakes(options, folder)
    yield from _timeout_mistakes(options.timeout)
    yield from declared.input_mistakes(options.inputs)
    yield from declared.output_mistakes(options.outputs)
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


def _output_mistakes(name: str, given: OutputOptions) -> Iterable[str]:
    where = f"outputs.{name}"
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
    known = declared.inputs(options.inputs)
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
