"""From the words of `data:` to a table with its roles, and the parameters of its columns."""

from __future__ import annotations

import hashlib
from collections.abc import Collection
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from surrogate.errors import KeyPath, Mistake, StudyError, nearest
from surrogate.runs.identity import SolverSpec
from surrogate.solver import Output, Solver
from surrogate.space import units
from surrogate.study.parts.data import DataPart
from surrogate.study.parts.inputs import ParameterPart
from surrogate.study.parts.study import StudyPart
from surrogate.study.reading.mistakes import Reading
from surrogate.tables import rows as table_rows
from surrogate.tables.columns import Column
from surrogate.tables.recorded import Recorded, input_of
from surrogate.tables.roles import SPLIT_WORDS, TEST_WORDS, Roles, roles
from surrogate.tables.table import Table, read


@dataclass(frozen=True)
class Data:
    """A table of runs that are done, with the roles of its columns.

    name     the file, as the study writes it
    version  of its content
    """

    name: str
    table: Table
    roles: Roles
    version: str

    def convert(self, solver: Solver) -> dict[str, units.Conversion]:
        """From the unit of each column to that of the solver; `StudyError` when they differ."""
        known: dict[str, Any] = {**solver.inputs, **solver.outputs}
        used = [name for name in (*self.roles.inputs, *self.roles.outputs) if name in known]
        return {
            name: units.conversion(self.table[name].unit or known[name].unit, known[name].unit)
            for name in used
            if self.table[name].numeric
        }


def data_of(reading: Reading, solver: Solver | None) -> Data | None:
    """The table of `data:`, understood; None without one, or when it has mistakes.

    solver: beside which it stands; its inputs and outputs are then those of the table.
    """
    part = reading.part.data
    if part is None:
        return None
    path = (reading.folder or Path()) / part.file
    try:
        table = read(path, rename=part.rename, sheet=part.sheet)
        mistakes = _mistakes(part, table, solver)
        if mistakes:
            raise StudyError(*mistakes)
        found = _beside(table, part, solver) if solver else _alone(reading, table, part)
        version = hashlib.sha256(path.read_bytes()).hexdigest()[:12]
        data = Data(part.file, table, found, version)
        if solver:
            data.convert(solver)
    except StudyError as error:
        for one in error.placed:
            reading.wrong(one.sentence, "data", *(one.path or ("file",)), on_key=one.on_key)
        return None
    reading.notes += [*table.notes, *_told(table, found, part.leave_out)]
    return data


@dataclass(frozen=True)
class Standing:
    """What gives a solver that is there already."""

    solver: Recorded

    def __call__(self) -> Solver:
        """The solver."""
        return self.solver


def _mistakes(part: DataPart, table: Table, solver: Solver | None) -> list[Mistake]:
    """Names that the table does not have, and columns that cannot be what they are said to be."""
    split = part.test.column if part.test else None
    named: list[tuple[KeyPath, str, bool]] = [
        *((("outputs", name), name, True) for name in part.outputs),
        *((("leave_out", k), name, False) for k, name in enumerate(part.leave_out)),
        *([(("test", "column"), split, False)] if split else []),
    ]
    mistakes = [
        Mistake(path, f"{table.file} has no column '{name}'; {nearest(name, table.columns)}", key)
        for path, name, key in named
        if name not in table.columns
    ]
    for name in part.outputs:
        if name in table.columns and not table[name].numeric:
            said = f"column '{name}' of {table.file} holds {_kind(table[name])}, not numbers"
            mistakes.append(Mistake(("outputs", name), said, True))
        if solver is not None and name not in solver.outputs:
            said = f"the solver has no output '{name}'; {nearest(name, solver.outputs)}"
            mistakes.append(Mistake(("outputs", name), said, True))
    if split in table.columns:
        mistakes += _split_mistakes(table, str(split))
    return mistakes


def _kind(column: Column) -> str:
    return {"category": "texts", "date": "dates"}[column.kind]


def _split_mistakes(table: Table, name: str) -> list[Mistake]:
    words = {str(value).lower() for value in table[name].values[~table[name].missing]}
    strange = sorted(words - SPLIT_WORDS)
    if not strange and words & TEST_WORDS:
        return []
    what = f"holds '{strange[0]}'" if strange else "names no row to test with"
    known = ", ".join(sorted(SPLIT_WORDS))
    return [Mistake(("test", "column"), f"column '{name}' {what}; a split is told by {known}")]


def _alone(reading: Reading, table: Table, part: DataPart) -> Roles:
    """Roles of a table in place of a solver."""
    return roles(
        table,
        inputs=[name for name in reading.part.parameters if name in table.columns],
        outputs=list(part.outputs),
        leave_out=part.leave_out,
        split=part.test.column if part.test else None,
    )


def _beside(table: Table, part: DataPart, solver: Solver) -> Roles:
    """Roles of a table beside a solver: columns with the names of its inputs and outputs."""
    inputs = [n for n in solver.inputs if n in table.columns and n not in part.leave_out]
    outputs = [n for n in part.outputs or solver.outputs if n in table.columns]
    for what, found, offered in (
        ("input", inputs, solver.inputs),
        ("output", outputs, solver.outputs),
    ):
        if not found:
            raise StudyError(
                f"no column of {table.file} has the name of an {what} of the solver "
                f"({', '.join(offered)}); its columns are {', '.join(table.columns)}; use rename:"
            )
    split = part.test.column if part.test else None
    others = [name for name in table.columns if name not in (*inputs, *outputs, split)]
    why = dict.fromkeys(others, "is no input or output of the solver")
    return Roles(tuple(inputs), tuple(outputs), split, why, guessed=False)


def _told(table: Table, found: Roles, leave_out: Collection[str]) -> list[str]:
    told = [
        f"{table.file}: column '{name}' {why}; left out"
        for name, why in found.left_out.items()
        if name not in leave_out
    ]
    if found.guessed:
        told.append(f"{table.file}: outputs are guessed: {', '.join(found.outputs)}")
    return told


def recorded_of(reading: Reading, data: Data) -> SolverSpec:
    """The table in place of a solver."""
    parameters = reading.part.parameters
    outputs = reading.part.data.outputs if reading.part.data else {}
    inputs = {}
    for name in data.roles.inputs:
        said = parameters[name].unit if name in parameters else None
        inputs[name] = input_of(data.table[name], said or "")
    answers = {}
    for name in data.roles.outputs:
        column, unit = data.table[name], outputs[name].unit if name in outputs else None
        with reading.mistakes_at("data", "outputs", name, "unit"):
            unit = column.unit if unit is None else unit
            units.conversion(column.unit or unit, unit)
            answers[name] = Output(unit=unit, description=column.title, gaps=True)
    return SolverSpec(data.name, Standing(Recorded(inputs, answers, data.version)))


def described(part: StudyPart, data: Data) -> StudyPart:
    """The study's words, with the range or the levels that the data have where it gives none."""
    complete = table_rows.complete(data.table, data.roles.inputs)
    parameters = dict(part.parameters)
    for name in data.roles.inputs:
        own, column = parameters.get(name), data.table[name]
        if own is None or not (own.range or own.distribution or own.levels or own.values):
            parameters[name] = _spanned(own, column, complete)
    return part.model_copy(update={"parameters": parameters})


def _spanned(
    own: ParameterPart | None, column: Column, complete: NDArray[np.bool_]
) -> ParameterPart:
    """A parameter over what a column has in its complete rows."""
    words = own.model_dump(exclude_none=True, exclude_defaults=True) if own is not None else {}
    values = column.values[complete] if complete.any() else column.values[~column.missing]
    if not column.numeric:
        return ParameterPart.model_validate({**words, "levels": sorted(set(values.tolist()))})
    ends = [float(values.min()), float(values.max())]
    unit = words.get("unit")
    if unit and column.unit:
        ends = sorted(map(units.conversion(column.unit, unit).place, ends))
    return ParameterPart.model_validate({**words, "range": ends})


def columns_of(data: Data | None, solver: Solver) -> dict[str, NDArray[np.float64]]:
    """Values of the numeric inputs that a table has, in the solver's units: laws come from them."""
    if data is None:
        return {}
    convert = data.convert(solver)
    return {
        name: convert[name].places(data.table[name].values[~data.table[name].missing])
        for name in data.roles.inputs
        if name in convert
    }
