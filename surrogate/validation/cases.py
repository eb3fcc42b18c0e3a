"""Cases that no surrogate has seen: measurements in a table, or runs of a better solver.

A table's first line names the columns: parameters, other inputs of a model, outputs,
if wanted `case` (a label) and `subject` (who it was measured on, when one has several
cases). Numbers are in the study's units unless they carry one (`98 N/m`), or their column
does (`tension [N/m]`). Empty cells of an output are gaps; other columns are left alone. What
files may look like is said in `surrogate.tables`.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from surrogate.errors import ResultsError, StudyError, nearest
from surrogate.runs import dataset as rundata
from surrogate.space import units
from surrogate.tables.columns import title_and_unit, units_row
from surrogate.tables.notation import decimal_mark, missing, number
from surrogate.tables.sheet import read_sheet

LABEL, SUBJECT = "case", "subject"
#: Mistakes shown before the rest is only counted.
SHOWN = 20
_NUMBER = re.compile(r"([-+\u2212]?[\d.,' ]*(?:[eE][-+]?\d+)?)(.*)", re.DOTALL)


@dataclass(frozen=True)
class Cases:
    """A table of cases.

    name      the file, as the study writes it
    columns   name -> cells (case,): texts or numbers
    places    where each case stands, for messages, (case,)
    units     name -> unit of a column; one that is not named is in the unit asked for
    labels    what each case is called, (case,)
    """

    name: str
    columns: Mapping[str, np.ndarray]
    places: tuple[str, ...]
    labels: tuple[str, ...]
    units: Mapping[str, str] = field(default_factory=dict)

    @property
    def subjects(self) -> np.ndarray | None:
        """Who each case was measured on, (case,); None when the cases do not tell."""
        return self.columns.get(SUBJECT)

    def by_subject(self, name: str | None) -> Cases:
        """The same cases with the column `name` for who they were measured on, if it is there."""
        if name is None or name not in self.columns:
            return self
        return replace(self, columns={**self.columns, SUBJECT: self.columns[name]})

    def numbers(self, name: str, unit: str, gaps: bool = False) -> np.ndarray:
        """A column in `unit`, (case,); `gaps`: an empty cell is NaN.

        Raises `StudyError` naming the place of each cell that is no number.
        """
        stated = self.units.get(name, unit)
        convert = units.conversion(stated, unit)
        values, mistakes = np.full(len(self.places), np.nan), []
        for k, cell in enumerate(self.columns[name]):
            try:
                if isinstance(cell, str) and cell.strip().lower() in ("", "nan"):
                    cell = np.nan
                if not gaps and not _finite(cell):
                    raise StudyError("there is no value")
                values[k] = convert.place(
                    units.quantity(cell, stated) if isinstance(cell, str) else float(cell)
                )
            except StudyError as error:
                mistakes.append(f"{self.places[k]}: {name}: {error}".removeprefix(": "))
        if mistakes:
            more = [f"and {len(mistakes) - SHOWN} more"] if len(mistakes) > SHOWN else []
            raise StudyError(*mistakes[:SHOWN], *more)
        return values

    def words(self, name: str) -> np.ndarray:
        """A column of level names, (case,)."""
        return np.array([str(cell).strip() for cell in self.columns[name]])

    def in_units(self, known: Mapping[str, Any]) -> Cases:
        """The same cases, columns without a stated unit being in that of `known` (name -> with
        `unit`)."""
        return replace(
            self, units={**{name: one.unit for name, one in known.items()}, **self.units}
        )

    def inputs(self, wanted: Mapping[str, Any]) -> dict[str, np.ndarray]:
        """The columns among `wanted` (name -> with `unit` and `levels`), in those units."""
        return {
            name: self.words(name) if one.levels else self.numbers(name, one.unit)
            for name, one in wanted.items()
            if name in self.columns
        }


def _finite(cell: Any) -> bool:
    return isinstance(cell, str) or bool(np.isfinite(cell))


def read_table(path: Path, name: str = "") -> Cases:
    """The cases in a table; raises `StudyError` when it cannot be read or holds none.

    name: of the file, as the study writes it; default the path.
    """
    sheet = read_sheet(path)
    titles, stated = map(list, zip(*map(title_and_unit, sheet.header), strict=True))
    rows, lines = sheet.rows, sheet.lines
    below = units_row(rows[0]) if len(rows) > 1 else None
    if below is not None:
        stated = [own or under for own, under in zip(stated, below, strict=True)]
        rows, lines = rows[1:], lines[1:]
    twice = [title for title in dict.fromkeys(titles) if titles.count(title) > 1]
    if twice:
        raise StudyError(*(f"{path}: column '{title}' stands twice" for title in twice))
    if not rows:
        raise StudyError(
            f"{path} holds no cases; its first line names the columns, each further line is a case"
        )
    usual = decimal_mark(_parts(cell)[0] for row in rows for cell in row)
    columns = {
        title: _cells(path, title, [row[j] for row in rows], usual)
        for j, title in enumerate(titles)
    }
    labels = columns.pop(LABEL, range(1, len(rows) + 1))
    return Cases(
        name or str(path),
        columns,
        tuple(f"{path}:{line}" for line in lines),
        tuple(map(str, labels)),
        {title: unit for title, unit in zip(titles, stated, strict=True) if unit},
    )


def _cells(path: Path, title: str, cells: list[Any], usual: str | None) -> np.ndarray:
    """The cells of a column (case,), numbers in texts with a decimal point, "" where missing.

    usual: the decimal mark of the rest of the file.
    """
    mark = decimal_mark((_parts(cell)[0] for cell in cells), usual)
    if mark is None:
        raise StudyError(
            f"{path}: column '{title}': its numbers can be read with a decimal comma or with a "
            "mark between thousands; write all of them with a point"
        )
    return np.array(["" if missing(cell) else _pointed(cell, mark) for cell in cells], dtype=object)


def _pointed(cell: Any, mark: str) -> Any:
    """A cell whose number, with or without unit, has a decimal point; others as they are."""
    if not isinstance(cell, str):
        return cell
    value, unit = _parts(cell)
    found = number(value, mark)
    return cell if found is None or _reads(value) else f"{found!r} {unit}"


def _parts(cell: Any) -> tuple[str, str]:
    """The number that a text begins with and the rest; empty for what is no text."""
    found = _NUMBER.fullmatch(cell.strip()) if isinstance(cell, str) else None
    return (found[1].strip(), found[2]) if found else ("", "")


def _reads(text: str) -> bool:
    """Whether a text is a number as Python writes it."""
    try:
        float(text)
    except ValueError:
        return False
    return True


def read_runs(path: Path, name: str) -> Cases:
    """The good runs in a runs dataset as cases."""
    try:
        runs = rundata.load(
            path,
            missing="a path in a study is relative to the study file",
            damaged="write it again",
        )
    except ResultsError as error:
        raise StudyError(f"cases '{name}': {error}") from None
    if "parameter" not in runs.coords or "status" not in runs:
        raise StudyError(
            f"cases '{name}': {path} is not a dataset of runs: it lacks 'parameter' "
            "or 'status'; give a runs.nc, a CSV file or a study"
        )
    return from_runs(runs, name)


def from_runs(runs: xr.Dataset, name: str) -> Cases:
    """The good runs of a dataset: parameters, constants and scalar outputs are the columns.

    Of levels of fidelity those of the truth.
    """
    runs = rundata.at_level(runs)
    rows = np.flatnonzero(runs["status"].values == "ok")
    if not len(rows):
        raise StudyError(f"cases '{name}': there is no finished run")
    given = [
        *runs["parameter"].values.tolist(),
        *(one for one in rundata.output_names(runs) if runs[one].ndim == 1),
    ]
    columns = {one: runs[one].values[rows] for one in given}
    stated = {one: runs[one].attrs["units"] for one in given if "units" in runs[one].attrs}
    if "fixed_inputs" in runs.attrs:
        fixed = rundata.described(runs, "fixed_inputs")
        columns |= {one: np.full(len(rows), value) for one, value in fixed.items()}
        stated |= {
            one: unit
            for one, unit in rundata.described(runs, "fixed_units").items()
            if one in fixed
        }
    return Cases(
        name, columns, tuple(f"run {row} of {name}" for row in rows), tuple(map(str, rows)), stated
    )


def header(columns: Mapping[str, Any], name: str) -> Cases:
    """Cases without rows, of runs yet to come: columns is name -> with `unit`."""
    return Cases(
        name,
        {one: np.array([]) for one in columns},
        (),
        (),
        {one: what.unit for one, what in columns.items()},
    )


def lacking(cases: Cases, names: Iterable[str], what: str) -> list[str]:
    """A sentence for each name that the cases have no column for."""
    titles = [title for title in cases.columns if title != SUBJECT]
    return [
        f"cases '{cases.name}' have no column for {what} '{name}'; {nearest(name, titles)}"
        for name in names
        if name not in cases.columns
    ]
