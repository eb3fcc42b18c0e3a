"""From the words of `data:` to a table with its roles, its laws, and the runs of its rows."""

from __future__ import annotations

import hashlib
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from surrogate.designs.design import Design
from surrogate.errors import KeyPath, Mistake, StudyError, nearest
from surrogate.runs.identity import SolverSpec, canonical, run_inputs
from surrogate.runs.stored import StoredRuns
from surrogate.solver import Output, Solver
from surrogate.space import units
from surrogate.space.dependence import correlated_pairs, dependence
from surrogate.space.space import Space
from surrogate.study.parts import DataPart, ParameterPart, StudyPart
from surrogate.study.reading.mistakes import Reading
from surrogate.tables import rows as table_rows
from surrogate.tables.columns import Column
from surrogate.tables.recorded import Recorded, input_of
from surrogate.tables.roles import SPLIT_WORDS, TEST_WORDS, Roles, roles
from surrogate.tables.table import Table, read

#: Names of the designs that rows make: in place of a solver, beside one, and held out.
TRAIN, DATA, TEST = "train", "data", "test"


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


@dataclass(frozen=True)
class Rows:
    """What the rows of a table give a study: designs, their runs, and notes."""

    designs: Mapping[str, Design]
    runs: StoredRuns
    notes: tuple[str, ...]


def rows_of(
    reading: Reading,
    data: Data,
    space: Space,
    spec: SolverSpec,
    constants: Mapping[str, float | str],
) -> Rows | None:
    """The rows that lie in the space, as designs and as runs that are done."""
    table, solver = data.table, spec.solver
    with reading.mistakes_at("data", "file"):
        convert = data.convert(solver)
        lacking = [name for name in space.names if name not in table.columns]
        if lacking:
            raise StudyError(
                f"{table.file} has no column for the parameters {', '.join(lacking)}; its rows "
                "cannot be runs of this study"
            )
        used = table_rows.used(table, space, {n: c.places for n, c in convert.items()})
        used = _with_fixed_inputs(data, used, space, spec, constants, convert)
        if not len(used.rows):
            raise StudyError("\n".join([f"no row of {table.file} can be used", *used.notes]))
        test = _held_out(reading, data, used)
        order = np.concatenate([np.flatnonzero(~test), np.flatnonzero(test)])
        rows, coded = used.rows[order], used.coded[order]
        count = int((~test).sum())
        names = {TRAIN if spec.recorded else DATA: coded[:count], TEST: coded[count:]}
        designs = {name: _design(name, data, part) for name, part in names.items() if len(part)}
        _check_designs(reading, designs, spec.recorded)
        if spec.deterministic:
            _check_replicates(table, coded, rows, data.roles.outputs)
        runs, notes = _runs(data, spec, space, coded, rows, convert, constants)
        return Rows(designs, runs, (*used.notes, *notes))
    return None


def _check_designs(reading: Reading, made: Iterable[str], recorded: bool) -> None:
    """The rows are designs of their own; no other one may have their names."""
    for name in reading.part.designs:
        if recorded:
            said = (
                "the rows of data: are the designs (train, test); a table cannot be run elsewhere"
            )
            reading.wrong(said, "designs", name, on_key=True)
        elif name in made:
            said = f"the rows of data: make a design '{name}' too; give this one another name"
            reading.wrong(said, "designs", name, on_key=True)


def _with_fixed_inputs(
    data: Data,
    used: table_rows.Used,
    space: Space,
    spec: SolverSpec,
    constants: Mapping[str, float | str],
    convert: Mapping[str, units.Conversion],
) -> table_rows.Used:
    """Without rows in which an input that the study does not vary has another value."""
    keep, notes, table = np.ones(len(used.rows), dtype=bool), list(used.notes), data.table
    for name in data.roles.inputs:
        if name in space.names:
            continue
        fixed = constants.get(name, spec.solver.inputs[name].nominal)
        values = table[name].values[used.rows]
        if isinstance(fixed, str):
            same = values == fixed
        else:
            wanted = float(fixed or 0.0)
            x = convert[name].places(values)
            same = np.asarray(np.abs(x - wanted) <= table_rows.SAME * abs(wanted))
        if not same.all():
            mask = np.isin(np.arange(table.rows), used.rows[~same])
            told = table_rows.left_out(table, mask)
            notes.append(f"{name} is not {_value(fixed)} as in this study: {told}")
        keep &= same
    return table_rows.Used(used.rows[keep], used.coded[keep], tuple(notes))


def _value(value: float | str | None) -> str:
    return value if isinstance(value, str) else f"{value:g}"


def _design(name: str, data: Data, coded: NDArray[np.float64]) -> Design:
    return Design(name, "data", {"file": data.name}, len(coded), partial(np.asarray, coded))


def _check_replicates(
    table: Table, coded: NDArray[np.float64], rows: NDArray[np.intp], outputs: Iterable[str]
) -> None:
    """A deterministic solver has one answer at a point; raises `StudyError` for rows with two."""
    _, first, group = np.unique(coded, axis=0, return_index=True, return_inverse=True)
    for run, earlier in enumerate(first[group.ravel()]):
        for name in outputs:
            values = table[name].values[rows[[run, earlier]]]
            if values[0] != values[1] and not np.isnan(values).any():
                one, other = (table.lines[rows[k]] for k in (earlier, run))
                raise StudyError(
                    f"rows {one} and {other} of {table.file} have the same inputs and other "
                    f"{name}, but the solver is deterministic; leave one out, or declare "
                    "deterministic = False in the solver"
                )


def _held_out(reading: Reading, data: Data, used: table_rows.Used) -> NDArray[np.bool_]:
    """Which of the used rows are held out, shape (run,)."""
    part = reading.part.data.test if reading.part.data else None
    if part is not None and part.fraction is not None:
        _, groups = np.unique(used.coded, axis=0, return_inverse=True)
        return table_rows.held_out(groups.ravel(), part.fraction, part.seed)
    if data.roles.split is None:
        return np.zeros(len(used.rows), dtype=bool)
    words = data.table[data.roles.split].values[used.rows]
    return np.array([str(word).lower() in TEST_WORDS for word in words], dtype=bool)


def _runs(
    data: Data,
    spec: SolverSpec,
    space: Space,
    coded: NDArray[np.float64],
    rows: NDArray[np.intp],
    convert: Mapping[str, units.Conversion],
    constants: Mapping[str, float | str],
) -> tuple[StoredRuns, list[str]]:
    """The rows as a dataset of runs; a row without any output is a failed run."""
    table = data.table
    physical = space.decode(coded)
    first = {name: column[:1] for name, column in physical.items()}
    fixed = {
        name: value
        for name, value in run_inputs(spec, first, constants)[0].items()
        if name not in physical
    }
    values = {name: convert[name].places(table[name].values[rows]) for name in data.roles.outputs}
    gaps = np.array([np.isnan(column) for column in values.values()])
    failed = np.asarray(gaps.all(axis=0))
    lines = [table.lines[row] for row in rows]
    names = ", ".join(values)
    message = [
        f"{table.file}, row {line}: no value of {names}" if lost else ""
        for line, lost in zip(lines, failed, strict=True)
    ]
    notes = []
    for name, own in zip(values, gaps, strict=True):
        some = own & ~failed
        if some.any():
            mask = np.isin(np.arange(table.rows), rows[some])
            notes.append(f"no value of {name} in {table_rows.numbered(table, mask)}")
    count = len(rows)
    dataset = xr.Dataset(
        {
            **{name: ("run", column) for name, column in physical.items()},
            **{name: ("run", column) for name, column in values.items()},
            "status": ("run", np.where(failed, "failed", "ok")),
            "message": ("run", np.array(message, dtype=str)),
            "seconds": ("run", np.full(count, np.nan)),
            "attempts": ("run", np.ones(count, dtype=int)),
            "finished": ("run", np.full(count, np.datetime64("NaT", "ns"))),
            "origin": ("run", np.array([f"{table.file}, row {line}" for line in lines])),
        },
        coords={"parameter": list(space.names)},
        attrs={
            "identity": spec.context,
            "fixed_inputs": canonical(fixed),
            "deterministic": str(spec.deterministic).lower(),
        },
    )
    return StoredRuns(data.name, dataset), notes


def with_dependence(reading: Reading, space: Space, rows: Rows) -> Space:
    """The space with the dependence that the rows show, unless the study says it itself."""
    if {"correlation", "constraints"} & reading.part.model_fields_set:
        return space
    coded = np.vstack([design.coded for design in rows.designs.values()])
    found = replace(space, correlation=dependence(space, coded))
    pairs = [f"{one} and {other} ({c:.2f})" for one, other, c in correlated_pairs(found)]
    if pairs:
        reading.notes.append(
            f"the inputs are correlated: {', '.join(pairs)}; the sensitivities take them as "
            "dependent (correlation: [] takes them as independent)"
        )
    return found
