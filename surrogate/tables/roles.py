"""What the columns of a table look like: inputs, outputs, a split, or something to leave out."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass

import numpy as np

from surrogate.errors import StudyError
from surrogate.tables.columns import Column
from surrogate.tables.table import Table

TEST_WORDS = frozenset(("test", "testing", "validation", "holdout"))
SPLIT_WORDS = TEST_WORDS | {"train", "training"}
OUTPUT_TITLES = frozenset(("y", "output", "response", "result", "target", "yield"))
ROW_TITLES = frozenset(("id", "run", "no", "nr", "number", "index", "row", "case", "trial"))
#: A category with more levels than this share of the rows is a label of rows.
MANY_LEVELS = 0.5
#: Rows from which a column 1, 2, 3 ... is a number of the row, whatever it is called.
MANY_ROWS = 10


@dataclass(frozen=True)
class Roles:
    """What each column is.

    inputs, outputs  names of columns
    split            the column that tells test rows from training rows, if there is one
    left_out         name -> why
    guessed          True when the outputs are a guess that a person should look at
    """

    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    split: str | None
    left_out: Mapping[str, str]
    guessed: bool = True


def roles(
    table: Table,
    *,
    inputs: Collection[str] = (),
    outputs: Collection[str] = (),
    leave_out: Collection[str] = (),
    split: str | None = None,
) -> Roles:
    """The roles of the columns: those that are given, and what the others look to be.

    Raises `StudyError` when no input or no output can be found. Outputs that nobody names are
    those that the file tells, numeric columns with names such as `y1` or `response`, or,
    without any, the last numeric column.
    """
    outputs = outputs or table.outputs
    given = {*inputs, *outputs}
    free = [name for name in table.columns if name not in given and name not in leave_out]
    if split is None:
        split = next((name for name in free if splits(table[name])), None)
    left_out = {name: "as the study says" for name in leave_out} | {
        name: why for name in free if name != split and (why := _useless(table[name], table.rows))
    }
    rest = [name for name in table.columns if name != split and name not in left_out]
    numeric = [name for name in rest if table[name].numeric and name not in inputs]
    found = tuple(outputs) or tuple(filter(_named_as_output, numeric)) or tuple(numeric[-1:])
    others = tuple(name for name in rest if name not in found)
    if not found or not others:
        lost = "".join(f"; '{name}' {why}" for name, why in left_out.items())
        what = "no inputs and outputs are" if not found else "no inputs are"
        raise StudyError(f"{table.file}: {what} left of its columns{lost}")
    return Roles(others, found, split, left_out, guessed=not outputs)


def splits(one: Column) -> bool:
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
    counts = one.kind == "integer" and bool(np.all(np.diff(one.values) == 1))
    named = one.title.strip().lower() in ROW_TITLES
    if (named and (counts or not one.numeric)) or (
        counts and one.values[0] in (0, 1) and rows >= MANY_ROWS
    ):
        return "numbers the rows"
    if one.kind == "category" and len(set(one.values)) > max(2, MANY_LEVELS * rows):
        return "names the rows"
    return ""


def _named_as_output(name: str) -> bool:
    return name.lower().rstrip("0123456789_") in OUTPUT_TITLES
