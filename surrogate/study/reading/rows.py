"""From the rows of a table to runs that are done, and the designs that they make."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from surrogate.designs.design import Design
from surrogate.errors import StudyError
from surrogate.runs.identity import SolverSpec, canonical, run_inputs
from surrogate.runs.stored import StoredRuns
from surrogate.space import units
from surrogate.space.dependence import correlated_pairs, dependence
from surrogate.space.space import Space
from surrogate.study.reading.data import Data
from surrogate.study.reading.mistakes import Reading
from surrogate.tables import rows as table_rows
from surrogate.tables.roles import TEST_WORDS
from surrogate.tables.table import Table

#: Names of the designs that rows make: in place of a solver, beside one, and held out.
TRAIN, DATA, TEST = "train", "data", "test"


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
