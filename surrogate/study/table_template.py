"""The commented study of a table that `surrogate new NAME --data FILE` writes.

Everything that was guessed stands in it, so that a person can see and change it.
"""

from __future__ import annotations

import json
import os
import re
from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np

from surrogate.fitting.fit import minimum_runs
from surrogate.runs.names import RESERVED_NAMES
from surrogate.study import plugins
from surrogate.study.source import read_text
from surrogate.study.study import Study
from surrogate.tables.columns import Column
from surrogate.tables.roles import Roles, roles
from surrogate.tables.rows import complete
from surrogate.tables.table import Table, read

#: Rows from which a fifth of them is held out; with fewer, cross-validation alone judges.
HELD_OUT_FROM = 30
#: Surrogates in the order in which they stand, those that the rows suffice for.
SURROGATES = {"linear": "linear", "quadratic": "quadratic", "gp": "gaussian_process"}
#: Whole numbers over no more than this are taken for counts.
COUNTS = 50
#: Words that YAML does not read as texts.
_NO_TEXTS = frozenset(("true", "false", "null", "yes", "no", "on", "off", "nan", "inf"))


def text_of(name: str, data: Path, folder: Path) -> str:
    """YAML of a study called `name` in `folder`, of the table in `data`.

    Raises `StudyError` with row and column for what is not understood.
    """
    table, rename = _read(data)
    found = roles(table)
    head = "".join(
        f"{line}\n" for line in _head(name, table, rename, found, _relative(data, folder))
    )
    study = Study._of(read_text(head, f"{name}.yaml"), folder)
    return head + "".join(f"{line}\n" for line in _tail(study))


def _read(data: Path) -> tuple[Table, dict[str, str]]:
    """The table, and other names for columns whose names a dataset of runs needs itself."""
    table = read(data)
    found = roles(table)
    used = {*found.inputs, *found.outputs} & RESERVED_NAMES
    rename = {table[name].title: f"{name}_" for name in table.columns if name in used}
    return read(data, rename=rename) if rename else table, rename


def _relative(data: Path, folder: Path) -> str:
    return Path(os.path.relpath(data, folder)).as_posix()


def _head(
    name: str, table: Table, rename: dict[str, str], found: Roles, file: str
) -> Iterator[str]:
    yield f"# A study of {table.file}, {table.rows} rows: look at what was guessed, then"
    yield f"# `surrogate check {name}.yaml` and `surrogate run {name}.yaml`."
    yield ""
    yield f"study: {name}"
    yield f"about: {_quoted(f'How does {_listed(found.outputs)} depend on the inputs?')}"
    yield ""
    yield "data:"
    yield f"  file: {_quoted(file)}"
    if rename:
        yield f"  rename: {json.dumps(rename, ensure_ascii=False)}"
    guessed = "which columns are outputs is guessed" if found.guessed else "as the file says"
    yield f"  outputs:                  # {guessed}"
    for output in found.outputs:
        yield f"    {output}: {{unit: {_quoted(table[output].unit)}}}"
    yield from _split(table, found)
    yield from _left_out(table, found)
    yield ""
    yield "parameters:                 # inputs with the range that the data have"
    yield "  # or {distribution: fit}: the likeliest law of the column"
    there = complete(table, found.inputs)
    width = max(map(len, found.inputs))
    for one in found.inputs:
        yield f"  {one}:{' ' * (width - len(one))} {_parameter(table[one], there)}"
    yield ""
    yield from _about_rows(table, found)


def _split(table: Table, found: Roles) -> Iterator[str]:
    if found.split is not None:
        yield f"  test: {{column: {found.split}}}   # rows that are held out to test the surrogates"
    elif table.rows >= HELD_OUT_FROM:
        yield "  test: {fraction: 0.2, seed: 1}   # rows held out to test the surrogates"
    else:
        yield "  # test: {fraction: 0.2}   # few rows: cross-validation alone judges"


def _left_out(table: Table, found: Roles) -> Iterator[str]:
    if found.left_out:
        listed = ", ".join(map(_quoted, found.left_out))
        yield f"  leave_out: [{listed}]"
        for name, why in found.left_out.items():
            yield f"    # {name} {why}"


def _parameter(column: Column, there: np.ndarray) -> str:
    values = column.values[there] if there.any() else column.values[~column.missing]
    if not column.numeric:
        levels = ", ".join(map(_quoted, sorted(set(values.tolist()))))
        return f"{{levels: [{levels}]}}"
    low, high = float(values.min()), float(values.max())
    words = f"range: [{_number(low)}, {_number(high)}]"
    if column.unit:
        words += f", unit: {_quoted(column.unit)}"
    if column.kind == "integer" and not column.unit and 1 < high - low <= COUNTS:
        return f"{{{words}, integer: true}}   # guessed: whole numbers only"
    return f"{{{words}}}"


def _about_rows(table: Table, found: Roles) -> Iterator[str]:
    """Comments on replicates and gaps."""
    there = complete(table, found.inputs)
    first = table.duplicates(list(found.inputs))[there]
    _, counts = np.unique(first, return_counts=True)
    if (counts > 1).any():
        yield f"# Replicates: points in several rows: {int((counts > 1).sum())}."
    if not there.all():
        yield f"# Rows without some input, left out: {int((~there).sum())}."
    empty = sum(int((table[name].missing & there).sum()) for name in found.outputs)
    if empty:
        yield f"# Missing answers: {empty}; a row without any answer is a failed run."


def _tail(study: Study) -> Iterator[str]:
    yield ""
    yield "surrogates:                 # cheap models, compared on the same rows"
    points = len(np.unique(study.designs["train"].coded, axis=0))
    for name, method in SURROGATES.items():
        needed = minimum_runs(plugins.load(plugins.REGRESSORS, method)(), study.space)
        mark = "" if needed <= points else "# "
        why = "" if needed <= points else f"   # needs {needed} different points"
        yield f"  {mark}{name}: {method}{why}"
    yield ""
    yield "# Sobol' indices; of correlated inputs Shapley effects"
    yield "sensitivity: {surrogate: best, confidence: 0.95}"
    if study.space.size > 1:
        yield "screening: {freeze_below: 0.02}   # inputs with a smaller effect may be left out"


def _number(value: float) -> str:
    return repr(int(value)) if value == int(value) and abs(value) < 1e15 else repr(value)


def _listed(names: Iterable[str]) -> str:
    *most, last = names
    return f"{', '.join(most)} and {last}" if most else last


def _quoted(text: str) -> str:
    """A text as YAML reads it back, quoted where it has to be."""
    plain = re.fullmatch(r"[A-Za-z_][A-Za-z0-9_./*-]*", text) and text.lower() not in _NO_TEXTS
    return text if plain else json.dumps(text, ensure_ascii=False)
