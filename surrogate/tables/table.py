"""A table that has been understood: columns with names, units and kinds; rows with lines."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from surrogate.errors import Mistake, StudyError, nearest
from surrogate.tables.columns import Column, column, identifier, title_and_unit, units_row
from surrogate.tables.notation import decimal_mark
from surrogate.tables.sheet import Sheet, read_sheet

#: Mistakes that are shown; the others are counted.
SHOWN = 10


@dataclass(frozen=True)
class Table:
    """Columns by name, in order; `lines` tells where each row stands in the file.

    outputs  columns that the file itself says are outputs (a dataset of runs)
    """

    file: str
    columns: Mapping[str, Column]
    lines: tuple[int, ...]
    notes: tuple[str, ...] = ()
    outputs: tuple[str, ...] = ()

    @property
    def rows(self) -> int:
        """How many there are."""
        return len(self.lines)

    def __getitem__(self, name: str) -> Column:
        if name not in self.columns:
            raise StudyError(
                f"{self.file} has no column '{name}'; {nearest(name, list(self.columns))}"
            )
        return self.columns[name]

    def duplicates(self, names: list[str]) -> NDArray[np.intp]:
        """For each row the first row with the same values of columns `names`; shape (row,)."""
        first: dict[tuple[Any, ...], int] = {}
        keys = zip(*(self.columns[name].values.tolist() for name in names), strict=True)
        return np.array([first.setdefault(key, i) for i, key in enumerate(keys)], dtype=np.intp)


def read(path: Path, *, rename: Mapping[str, str] | None = None, sheet: str | None = None) -> Table:
    """The table in a file: CSV, TSV, Excel, Parquet or netCDF.

    rename: header as written, or its name without unit -> name. Raises `StudyError` with a
    sentence for each cell that is not understood, with its row and column.
    """
    return understand(path.name, read_sheet(path, sheet), dict(rename or {}))


def understand(file: str, sheet: Sheet, rename: dict[str, str]) -> Table:
    """The table that a sheet holds."""
    rows, lines = sheet.rows, sheet.lines
    titles, units = map(list, zip(*map(title_and_unit, sheet.header), strict=True))
    if all(_is_numeric(title) for title in sheet.header):
        raise StudyError(f"{file}: the first row holds numbers; it must name the columns")
    below = units_row(rows[0]) if len(rows) > 1 else None
    if below is not None:
        units = [own or under for own, under in zip(units, below, strict=True)]
        rows, lines = rows[1:], lines[1:]
    _check_header(file, sheet.header, rename, titles)
    if not rows:
        raise StudyError(f"{file} has names of columns, but no rows below them")
    usual = decimal_mark(cell for row in rows for cell in row)
    columns: dict[str, Column] = {}
    mistakes: list[str] = []
    for j, title in enumerate(titles):
        name = rename.get(sheet.header[j]) or rename.get(title) or identifier(title, list(columns))
        cells = [row[j] for row in rows]
        columns[name], wrong = column(title, name, units[j], cells, lines, usual)
        mistakes += [f"{file}: {sentence}" for sentence in wrong]
    if mistakes:
        more = len(mistakes) - SHOWN
        raise StudyError(*mistakes[:SHOWN], *([f"{file}: and {more} more"] if more > 0 else []))
    names = dict(zip(sheet.header, columns, strict=True))
    outputs = tuple(names[title] for title in sheet.outputs if title in names)
    return Table(file, columns, tuple(lines), sheet.notes, outputs)


def _check_header(
    file: str, header: list[str], rename: Mapping[str, str], titles: list[str]
) -> None:
    mistakes = [
        Mistake((), f"{file}: two columns are called '{title}'; give one another name")
        for title in dict.fromkeys(header)
        if header.count(title) > 1
    ]
    mistakes += [
        Mistake(
            ("rename", title),
            f"rename: {file} has no column '{title}'; {nearest(title, header)}",
            True,
        )
        for title in rename
        if title not in header and title not in titles
    ]
    if mistakes:
        raise StudyError(*mistakes)


def _is_numeric(title: str) -> bool:
    try:
        float(title.replace(",", "."))
    except ValueError:
        return False
    return True
