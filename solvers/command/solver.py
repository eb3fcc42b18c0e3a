"""Any external program as a solver.

::

    solver:
      name: command
      options:
        command: ./beam.sh beam.inp           # no shell; or a list of words
        templates: {beam.inp: beam.template}  # name in the working folder: file beside the study
        inputs:
          load: {unit: N, nominal: 10, range: [0, 100]}
        outputs:
          tip: {unit: mm, file: result.txt, regex: 'tip *= *(\\S+)'}

Each run has a working folder of its own with the filled templates and copies of `files`;
the program runs there. In templates and in the command, `{{ load }}` or `{{ load:10.3e }}`
stands for an input.
"""

from __future__ import annotations

import hashlib
import json
import os
import shutil
import tempfile
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from surrogate.errors import SolverError, StudyError, nearest
from surrogate.solver import Input

from .. import declared
from ..validated import placed, validated
from . import checks, process, readers, written
from . import options as settings
from . import templates as placeholders
from .options import OutputOptions


class Command:
    """Runs an external program: fills its input files, reads its output files.

    command          the program and its arguments; a program with a slash is relative to
                     the study's folder, others are looked up on the PATH
    inputs           name -> {unit, nominal, range or levels, description, source}
    outputs          name -> {unit, description, file, dims} and one of
                     regex: one group around the number, the last match counts (all with dims);
                     pointer: JSON pointer, /result/0/value;
                     csv: {column, row, delimiter, skip, header}; table: {column, row, skip,
                     header} for white space. Without file, what the program prints is read
    templates        name in the working folder -> template, relative to the study
    files            files and folders to copy into the working folder: [path] or {name: path}
    delimiters       around placeholders, for files that use {{ }} themselves
    exit_codes       exit statuses that mean success
    timeout          of one run, in s or with a unit (30 min): all processes of it are killed
    keep             folder inside the study's, in which working folders are kept
    program_version  any text; change it to tell that the program gives other answers now
    folder           the study's folder; the study fills it in

    Raises `StudyError` with all mistakes in the options.
    """

    def __init__(
        self,
        command: list[str] | str,
        inputs: dict[str, Any],
        outputs: dict[str, Any],
        templates: dict[str, str] | None = None,
        files: list[str] | dict[str, str] | None = None,
        delimiters: list[str] | None = None,
        exit_codes: list[int] | None = None,
        timeout: float | str | None = None,
        keep: str | None = None,
        program_version: str = "",
        folder: Path | None = None,
    ):
        given = {
            "command": command,
            "inputs": inputs,
            "outputs": outputs,
            "templates": templates,
            "files": files,
            "delimiters": delimiters,
            "exit_codes": exit_codes,
            "timeout": timeout,
            "keep": keep,
            "program_version": program_version,
        }
        self.options, mistakes = validated(
            settings.Options,
            {option: value for option, value in given.items() if value is not None},
            settings.PARTS,
        )
        self.folder = Path(folder or ".").resolve()
        self.texts, unreadable = _texts(self.options.templates.values(), self.folder)
        mistakes += [*unreadable, *checks.mistakes(self.options, self.folder, self.texts)]
        if mistakes:
            raise StudyError(*(placed(sentence, given) for sentence in mistakes))
        self.timeout = settings.seconds(self.options.timeout)
        self.inputs = declared.inputs(self.options.inputs)
        self.outputs = declared.outputs(self.options.outputs)
        self.version = _version(self.options, self.folder, self.texts)
        self.identity_options: dict[str, Any] = {}  # the version covers all that change answers

    def __call__(self, **inputs: float | str) -> dict[str, float | np.ndarray]:
        """Run the program once; raises `SolverError` with its last words when it fails."""
        values = self._values(inputs)
        with self._working_folder(values) as place:
            words = self._prepare(place, values)
            try:
                status = process.run(words, place, self.timeout, self.options.keep is None)
            except OSError as error:
                raise SolverError(f"{words[0]} cannot be started: {error.strerror}") from error
            if status is None:
                raise SolverError(
                    _with_last_words(
                        f"{words[0]} was stopped after {self.timeout:g} s; raise timeout and run "
                        "with --retry-failed",
                        place,
                    )
                )
            if status not in self.options.exit_codes:
                accepted = ", ".join(map(str, self.options.exit_codes))
                raise SolverError(
                    _with_last_words(
                        f"{words[0]} ended with {process.status_text(status)} "
                        f"(accepted: {accepted})",
                        place,
                    )
                )
            return {
                name: self._read(name, given, place) for name, given in self.options.outputs.items()
            }

    def _values(self, inputs: Mapping[str, float | str]) -> dict[str, float | str]:
        """A value for every input; nominal ones fill in."""
        for name in inputs:
            if name not in self.inputs:
                raise SolverError(f"input '{name}' is unknown; {nearest(name, self.inputs)}")
        return {
            name: _checked(name, inputs.get(name, given.nominal), given)
            for name, given in self.inputs.items()
        }

    @contextmanager
    def _working_folder(self, values: Mapping[str, float | str]) -> Iterator[Path]:
        """A new folder: temporary, or kept under the name of its inputs' hash."""
        if self.options.keep is None:
            with tempfile.TemporaryDirectory(prefix="command-", ignore_cleanup_errors=True) as name:
                yield Path(name)
            return
        text = json.dumps(values, sort_keys=True, default=float)
        kept = self.folder / self.options.keep
        kept.mkdir(parents=True, exist_ok=True)
        digest = hashlib.sha256(f"{self.version} {text}".encode()).hexdigest()[:12]
        place = Path(tempfile.mkdtemp(prefix=f"run-{digest}-", dir=kept))
        (place / "inputs.json").write_text(text, encoding="utf-8")
        yield place

    def _prepare(self, place: Path, values: Mapping[str, float | str]) -> list[str]:
        """Copy files, fill templates; the words of the command, filled too."""
        for name, path in settings.files(self.options).items():
            (place / name).parent.mkdir(parents=True, exist_ok=True)
            source = self.folder / path
            (shutil.copytree if source.is_dir() else shutil.copy2)(source, place / name)
        placeholder = placeholders.pattern(self.options.delimiters)
        for name, path in self.options.templates.items():
            (place / name).parent.mkdir(parents=True, exist_ok=True)
            filled = placeholders.fill(self.texts[path], placeholder, values)
            # newline="": the template's own line ends are kept.
            (place / name).write_text(filled, encoding="utf-8", newline="")
        words = [
            placeholders.fill(word, placeholder, values)
            for word in settings.arguments(self.options)
        ]
        return [settings.program(words[0], self.folder) or words[0], *words[1:]]

    def _read(self, name: str, given: OutputOptions, place: Path) -> float | np.ndarray:
        file = given.file or process.STDOUT
        said = "what the program printed" if given.file is None else file
        # Of a pattern the last match counts: the end of what is too long to be read is enough.
        read = written.tail if given.regex is not None and not given.dims else written.text
        try:
            text = read(place / file)
        except written.Unfit as error:
            raise SolverError(_with_last_words(f"{name}: {said} {error}", place)) from error
        except OSError as error:
            raise SolverError(
                _with_last_words(
                    f"{name}: the program ended well but did not write {file} ({error.strerror})",
                    place,
                )
            ) from error
        try:
            values = np.array(_numbers(given, text))
        except readers.Unreadable as error:
            raise SolverError(_with_last_words(f"{name}: in {said} {error}", place)) from error
        shape = self.outputs[name].shape
        if values.size != np.prod(shape, dtype=int):
            raise SolverError(
                f"{name}: {said} has {values.size} values where {shape or 'one'} "
                f"{'is' if shape == () else 'are'} expected; check dims and the file"
            )
        if not np.isfinite(values).all():
            raise SolverError(
                _with_last_words(f"{name}: {said} has values that are not finite", place)
            )
        return values.reshape(shape) if shape else float(values[0])


def _checked(name: str, value: float | str | None, known: Input) -> float | str:
    low, high = known.range
    if value is None:
        raise SolverError(f"input '{name}' has no value and no nominal one")
    if known.levels:
        if value not in known.levels:
            raise SolverError(f"{name}: '{value}' is unknown; {nearest(str(value), known.levels)}")
    elif isinstance(value, str):
        raise SolverError(f"{name}: '{value}' is not a number")
    elif not low <= value <= high:
        raise SolverError(
            f"{name}: {value:g} {known.unit}".rstrip() + f" is not between {low:g} and {high:g}"
        )
    return value


def _numbers(given: OutputOptions, text: str) -> list[float]:
    if given.regex is not None:
        return readers.by_pattern(text, given.regex, several=bool(given.dims))
    if given.pointer is not None:
        return readers.by_pointer(text, given.pointer)
    table = given.csv or given.table
    assert table is not None  # the checks ask for one of the four
    delimiter = given.csv.delimiter if given.csv else None
    return readers.by_column(
        text,
        table.column,
        table.row,
        delimiter=delimiter,
        skip=table.skip,
        header=table.header,
        comment=table.comment,
    )


def _with_last_words(sentence: str, place: Path) -> str:
    words = process.last_words(place)
    return f"{sentence}; its last lines:\n{words}" if words else f"{sentence}; it printed nothing"


def _texts(paths: Iterable[str], folder: Path) -> tuple[dict[str, str], list[str]]:
    """Contents of the templates by path, and a sentence for those that are not text."""
    texts, mistakes = {}, []
    for path in dict.fromkeys(paths):
        try:
            with open(folder / path, encoding="utf-8", newline="") as stream:
                texts[path] = stream.read()
        except UnicodeDecodeError:
            mistakes.append(
                f"templates: {folder / path} is not a text file in UTF-8; "
                "list it under files if it needs no filling"
            )
        except OSError:
            continue  # missing files are reported with the other options
    return texts, mistakes


def _version(options: settings.Options, folder: Path, texts: Mapping[str, str]) -> str:
    """Changes with everything that can change an answer: templates, files, program, options."""
    digest = hashlib.sha256()
    chosen = options.model_dump(mode="json", exclude={"keep", "timeout"})
    digest.update(json.dumps([chosen, dict(texts)], sort_keys=True).encode())
    program = settings.arguments(options)[0]
    own = [folder / program] if "/" in program and not os.path.isabs(program) else []
    for path in [*own, *(folder / path for path in settings.files(options).values())]:
        for file in sorted(path.rglob("*")) if path.is_dir() else [path]:
            if file.is_file():
                digest.update(file.name.encode() + hashlib.sha256(file.read_bytes()).digest())
    return "-".join(filter(None, ["1", options.program_version, digest.hexdigest()[:12]]))
