"""A part of a comparison: sentences and a table, the same for terminal, JSON and page."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, TypeVar

#: A value with the ends of its interval.
Ends = tuple[float, float, float]
#: Headings of the columns of both sides.
SIDES = {"a": "A", "b": "B"}

Key = TypeVar("Key")
Row = dict[str, Any]


@dataclass(frozen=True)
class Part:
    """What changed in one respect.

    key        in the JSON data
    sentences  what changed, in words
    columns    key of a row -> heading
    rows       values: text, number, None, or a number with the ends of its interval
    shown      rows that the terminal prints; None for all of them
    """

    key: str
    title: str
    sentences: tuple[str, ...] = ()
    columns: Mapping[str, str] = field(default_factory=dict)
    rows: Sequence[Mapping[str, Any]] = ()
    shown: Sequence[Mapping[str, Any]] | None = None

    @property
    def data(self) -> dict[str, Any]:
        """The part as JSON data."""
        return {"sentences": list(self.sentences), "rows": [dict(row) for row in self.rows]}

    def table(self, rows: Sequence[Mapping[str, Any]]) -> list[list[str]]:
        """Rows as words, in the order of the columns."""
        return [[words(row.get(key)) for key in self.columns] for row in rows]


def side_by_side(a: Mapping[Key, Any], b: Mapping[Key, Any]) -> Iterator[tuple[Key, Row]]:
    """Each key of A, then those of B alone, with its value on both sides; None where it is not."""
    for key in dict.fromkeys((*a, *b)):
        yield key, {"a": a.get(key), "b": b.get(key)}


def differing(rows: Sequence[Row]) -> list[Row]:
    """Rows whose two values differ."""
    return [row for row in rows if row["a"] != row["b"]]


def words(value: Any) -> str:
    """A cell as words; `-` for what is not there."""
    if value is None or (isinstance(value, float) and value != value):
        return "-"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return f"{value:.6f}" if 0.9995 <= value < 1.0 else f"{value:.4g}"  # a Q2
    if isinstance(value, tuple):
        middle, low, high = map(words, value)
        return middle if low == "-" or high == "-" else f"{middle} [{low}, {high}]"
    return str(value)


def overlap(a: Ends | None, b: Ends | None) -> bool | None:
    """True when two intervals share a point; None where one of them is not known."""
    ends = [end for one in (a, b) if one is not None for end in one[1:]]
    if len(ends) < 4 or any(end is None or end != end for end in ends):
        return None
    return bool(ends[0] <= ends[3] and ends[2] <= ends[1])
