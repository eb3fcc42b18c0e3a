"""A column of a table: its name, unit and kind, found from header and cells."""

from __future__ import annotations

import datetime as dt
import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from surrogate.space.units import known
from surrogate.tables.notation import decimal_mark, missing, number

#: Share of a column's cells that must be numbers before the others are mistakes.
MOSTLY = 0.5
_UNIT = re.compile(r"(?P<name>.*?\S)\s*(?:\[(?P<a>[^\[\]]*)\]|\((?P<b>[^()]*)\))\s*")
_DATE = re.compile(
    r"\d{4}-\d{1,2}-\d{1,2}([T ]\d{1,2}:\d{2}(:\d{2}(\.\d+)?)?(Z|[+-]\d{2}:?\d{2})?)?"
    r"|\d{1,2}\.\d{1,2}\.\d{2,4}( \d{1,2}:\d{2}(:\d{2})?)?"
    r"|\d{1,2}/\d{1,2}/\d{2,4}( \d{1,2}:\d{2}(:\d{2})?)?"
)


@dataclass(frozen=True)
class Column:
    """One column.

    title    the header's text as written; name: the same as a study can call it
    unit     a unit that pint knows, or ""
    kind     "number", "integer", "category" or "date"
    values   (row,) floats with NaN where missing; texts with "" where missing
    """

    title: str
    name: str
    unit: str
    kind: str
    values: NDArray[Any]

    @property
    def numeric(self) -> bool:
        """True for numbers and integers."""
        return self.kind in ("number", "integer")

    @property
    def missing(self) -> NDArray[np.bool_]:
        """Where the column has no value, shape (row,)."""
        return np.isnan(self.values) if self.numeric else np.asarray(self.values == "")

    @property
    def varies(self) -> bool:
        """True when it has two or more different values."""
        return len(np.unique(self.values[~self.missing])) > 1


def title_and_unit(header: str) -> tuple[str, str]:
    """`load [N]` and `load (N)` are load in N; what is no unit stays a part of the name."""
    found = _UNIT.fullmatch(header.strip())
    if found:
        unit = _plain_unit((found["a"] or found["b"] or "").strip())
        if unit == "" or is_unit(unit):
            return found["name"], unit
    return header.strip(), ""


def _plain_unit(unit: str) -> str:
    """A unit in pint's words: `-` and `1` are none, and degrees have a name."""
    unit = {"-": "", "1": "", "–": "", "°": "degree", "°C": "degC", "°F": "degF"}.get(unit, unit)
    return unit.replace("²", "**2").replace("³", "**3").replace("·", "*")


def is_unit(text: str) -> bool:
    """True for a text that is a unit by itself, such as `mm` or `kN/m^2`, and no number."""
    return bool(text) and not re.search(r"^[\d.,]+$", text) and len(text) < 40 and known(text)


def units_row(cells: Sequence[Any]) -> list[str] | None:
    """The units of a row that stands under the header, one a column; None when it is none."""
    texts = [str(cell).strip().strip("[]()") if cell is not None else "" for cell in cells]
    units = [_plain_unit(text) for text in texts]
    if not any(units) or any(number(cell) is not None for cell in cells if cell is not None):
        return None
    return units if all(unit == "" or is_unit(unit) for unit in units) else None


def identifier(title: str, taken: Sequence[str]) -> str:
    """A name that a study can use, made of a title; different from those `taken`."""
    name = re.sub(r"\W+", "_", title).strip("_") or "column"
    name = f"x_{name}" if name[0].isdigit() else name
    count = 2
    result = name
    while result in taken:
        result, count = f"{name}_{count}", count + 1
    return result


def column(
    title: str,
    name: str,
    unit: str,
    cells: Sequence[Any],
    lines: Sequence[int],
    usual_mark: str | None = None,
) -> tuple[Column, list[str]]:
    """The column that cells make, and a sentence with row and column for each bad cell.

    usual_mark: the decimal mark of the rest of the file.
    """
    there = [(line, cell) for line, cell in zip(lines, cells, strict=True) if not missing(cell)]
    if there and all(_is_date(cell) for _, cell in there):
        texts = ["" if missing(cell) else str(cell) for cell in cells]
        return Column(title, name, unit, "date", np.array(texts, dtype=object)), []
    mark = decimal_mark((cell for _, cell in there), usual_mark)
    numbers = [number(cell, mark or ".") for _, cell in there]
    good = sum(value is not None for value in numbers)
    if there and good < MOSTLY * len(there):
        texts = ["" if missing(cell) else _word(cell) for cell in cells]
        return Column(title, name, unit, "category", np.array(texts, dtype=object)), []
    mistakes = [
        f"row {line}, column '{title}': {_shown(cell)} is not a number"
        for (line, cell), value in zip(there, numbers, strict=True)
        if value is None
    ]
    mistakes += [
        f"row {line}, column '{title}': {_shown(cell)} is not finite"
        for (line, cell), value in zip(there, numbers, strict=True)
        if value is not None and math.isinf(value)
    ]
    if mark is None:
        mistakes.append(
            f"column '{title}': numbers such as {_first_ambiguous(there)} can be read with a "
            "decimal comma or with a mark between thousands; write all of them with a point"
        )
    values = np.array(
        [np.nan if missing(cell) else _or_nan(number(cell, mark or ".")) for cell in cells]
    )
    whole = values[~np.isnan(values)]
    integer = bool(len(whole)) and bool(np.all(whole == np.round(whole)))
    return Column(title, name, unit, "integer" if integer else "number", values), mistakes


def _or_nan(value: float | None) -> float:
    return np.nan if value is None or math.isinf(value) else value


def _is_date(cell: Any) -> bool:
    if isinstance(cell, dt.date | dt.time | np.datetime64):
        return True
    return isinstance(cell, str) and bool(_DATE.fullmatch(cell.strip()))


def _word(cell: Any) -> str:
    return str(cell).strip()


def _shown(cell: Any) -> str:
    text = repr(cell) if isinstance(cell, str) else str(cell)
    return text if len(text) <= 40 else f"{text[:37]}..."


def _first_ambiguous(cells: Sequence[tuple[int, Any]]) -> str:
    return next((str(cell) for _, cell in cells if "," in str(cell) or "." in str(cell)), "")
