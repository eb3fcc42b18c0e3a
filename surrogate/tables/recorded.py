"""A table in the place of a solver: it declares inputs and outputs, and is never called."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from surrogate.errors import SolverError
from surrogate.solver import Input, Output
from surrogate.tables.columns import Column


@dataclass
class Recorded:
    """What a table of runs tells about itself, as a solver does (`surrogate.solver`).

    version  of its content. Rows with the same inputs are replicates, so the same inputs may
             give another answer.
    """

    inputs: Mapping[str, Input]
    outputs: Mapping[str, Output]
    version: str
    deterministic: ClassVar[bool] = False
    recorded: ClassVar[bool] = True

    def __call__(self, **inputs: Any) -> Mapping[str, Any]:
        """No answer: the runs of a table are done."""
        raise SolverError("this study reads a table: it has the runs of its rows and no others")


def input_of(column: Column, unit: str = "") -> Input:
    """A column as an input; its nominal value is the median, or the most frequent level.

    unit: of a column whose header names none.
    """
    known = column.values[~column.missing]
    if column.numeric:
        middle = float(np.median(known)) if len(known) else None
        return Input(unit=column.unit or unit, nominal=middle, description=column.title)
    levels, counts = np.unique(known.astype(str), return_counts=True)
    usual = str(levels[counts.argmax()]) if len(levels) else None
    return Input(levels=tuple(levels.tolist()), nominal=usual, description=column.title)
