"""Numbers read back from what a program wrote.

Rows and columns count from 0; -1 is the last. Numbers may have Fortran's D exponent.
"""

from __future__ import annotations

import csv
import json
import re
from typing import Any

from surrogate.errors import nearest


class Unreadable(ValueError):
    """The text does not hold what the option says; the message says what is there."""


def by_pattern(text: str, regex: str, several: bool) -> list[Any]:
    """Every match of `regex` (its group when it has one), or the last alone.

    The last, because iterative programs print the converged value last.
    """
    found = [
        match[1] if match.re.groups else match[0]
        for match in re.finditer(regex, text, re.MULTILINE)
    ]
    if not found:
        raise Unreadable(f"nothing matches {regex!r}")
    return [number(word) for word in (found if several else found[-1:])]


def by_pointer(text: str, pointer: str) -> list[float]:
    """The number, or all numbers of the nested lists, at a JSON pointer (RFC 6901)."""
    try:
        place = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise Unreadable(f"it is not JSON ({error})") from error
    for step in pointer.split("/")[1:]:
        place = _inside(place, step.replace("~1", "/").replace("~0", "~"), pointer)
    return [number(value) for value in _flat(place)]


def _inside(place: Any, step: str, pointer: str) -> Any:
    if isinstance(place, dict) and step in place:
        return place[step]
    if isinstance(place, list) and step.isdecimal() and int(step) < len(place):
        return place[int(step)]
    there = (
        nearest(step, place)
        if isinstance(place, dict)
        else f"it has {len(place)} items"
        if isinstance(place, list)
        else "it holds one value"
    )
    raise Unreadable(f"there is no '{step}' on the way of {pointer}; {there}")


def _flat(place: Any) -> list[Any]:
    if isinstance(place, list):
        return [value for item in place for value in _flat(item)]
    return [place]


def by_column(
    text: str,
    column: int | str,
    row: int | None,
    *,
    delimiter: str | None,
    skip: int = 0,
    header: bool = True,
    comment: str = "#",
) -> list[float]:
    """A column of a table, or its cell in `row`.

    delimiter: between cells; None for any white space. skip: lines left out at the top.
    header: the first line that counts names the columns.
    """
    lines = [
        line
        for line in text.splitlines()[skip:]
        if line.strip() and not (comment and line.lstrip().startswith(comment))
    ]
    cells = (
        [line.split() for line in lines]
        if delimiter is None
        else [[cell.strip() for cell in line] for line in csv.reader(lines, delimiter=delimiter)]
    )
    names = cells.pop(0) if header and cells else []
    index = _column_index(column, names)
    values = [_cell(line, index, column) for line in cells]
    if row is None:
        return [number(value) for value in values]
    if not -len(values) <= row < len(values):
        raise Unreadable(f"there is no row {row}; it has {len(values)} rows")
    return [number(values[row])]


def _column_index(column: int | str, names: list[str]) -> int:
    if isinstance(column, int):
        return column
    if column not in names:
        raise Unreadable(f"there is no column '{column}'; {nearest(column, names)}")
    return names.index(column)


def _cell(line: list[str], index: int, column: int | str) -> str:
    if not -len(line) <= index < len(line):
        raise Unreadable(f"there is no column {column} in the row '{' '.join(line)}'")
    return line[index]


def number(value: Any) -> float:
    """A float of a number or of its text; raises `Unreadable` for anything else."""
    try:
        if isinstance(value, bool) or value is None:
            raise ValueError
        if isinstance(value, str):
            value = re.sub(r"(?<=[\d.])[dD](?=[+-]?\d)", "e", value.strip())
        return float(value)
    except (TypeError, ValueError) as error:
        raise Unreadable(f"'{value}' is not a number") from error
