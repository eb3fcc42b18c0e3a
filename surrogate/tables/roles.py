"""What the columns of a table look like: inputs, outputs, a split, or something to leave out."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from surrogate.errors import StudyError
from surrogate.tables.columns import Column
from surrogate.tables.table import Table

SPLIT_WORDS = frozenset(("train", "training", "test", "testing", "validation", "holdout"))
OUTPUT_TITLES = frozenset(("y", "f", "z", "output", "response", "result", "target", "yield"))
ROW_TITLES = frozenset(("id", "run", "no", "nr", "number", "index", "row", "case", "trial"))
#: A category with more levels than this share of the rows is a label of rows.
MANY_LEVELS = 0.5


@dataclass(frozen=True)
class Roles:
    """A guess that a person should look at.

    inputs, outputs  names of columns
    split            the column that tells test rows from training rows, if there is one
    left_out         name -> why
    """

    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    split: str | None
    left_out: Mapping[str, str]


def roles(table: Table) -> Roles:
    """The roles that columns look to have; raises `StudyError` when no output can be found.

    Outputs are numeric columns with names such as `y1`, `response`; without any, the last
    numeric column.
    """
    split = next((name for name, c in table.columns.items() if _splits(c)), None)
    left_out = {
        name: why
        for name, c in table.columns.items()
        if name != split and (why := _useless(c, table.rows))
    }
    rest = {n: c for n, c in table.columns.items() if n != split and n not in left_out}
    numeric = [name for name, c in rest.items() if c.numeric]
    outputs = [name for name in numeric if _named_as_output(name)] or numeric[-1:]
    inputs = [name for name in rest if name not in outputs]
    if not outputs or not inputs:
        raise StudyError(
            f"{table.file}: no inputs and outputs are left of its columns; "
            + "; ".join(f"'{name}' {why}" for name, why in left_out.items())
        )
    return Roles(tuple(inputs), tuple(outputs), split, left_out)


def _splits(one: Column) -> bool:
    """True when its values are words for training and test rows."""
    if one.kind != "category":
        return False
    words = {str(value).lower() for value in one.values[~one.missing]}
    return len(words) == 2 and words <= SPLIT_WORDS


def _useless(one: Column, rows: int) -> str:
    """Why a column is neither input nor output; "" when it may be one."""
    if one.kind == "date":
        return "holds dates"
    if not one.varies:
        return "does not vary"
    counts_up = one.kind == "integer" and np.all(np.diff(one.values) == 1)
    if one.title.strip().lower() in ROW_TITLES and (counts_up or not one.numeric):
        return "numbers the rows"
    if one.kind == "category" and len(set(one.values)) > max(2, MANY_LEVELS * rows):
        return "names the rows"
    return ""


def _named_as_output(name: str) -> bool:
    return name.lower().rstrip("0123456789_") in OUTPUT_TITLES
