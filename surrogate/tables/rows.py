"""Rows of a table as points of a space: which are used, which are held out, and why."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from surrogate.space.space import Parameter, Space
from surrogate.tables.table import Table

Mask = NDArray[np.bool_]

#: Row numbers that a sentence names; the others are counted.
NAMED = 8
#: Relative size up to which a value must come back from its code.
SAME = 1e-9


@dataclass(frozen=True)
class Used:
    """The rows of a table that lie in a space.

    rows   their numbers in the table, (run,)
    coded  points (run, parameter)
    notes  a sentence for each reason why others are left out
    """

    rows: NDArray[np.intp]
    coded: NDArray[np.float64]
    notes: tuple[str, ...]


def complete(table: Table, names: Iterable[str]) -> Mask:
    """Which rows have a value in each of these columns, shape (row,)."""
    missing = [table[name].missing for name in names]
    return ~np.any(missing, axis=0) if missing else np.ones(table.rows, dtype=bool)


def used(
    table: Table, space: Space, convert: Mapping[str, Callable[..., NDArray[np.float64]]]
) -> Used:
    """The rows with all inputs, inside of the ranges and among the levels of the space.

    convert: name -> from the column's unit to the parameter's.
    """
    keep = complete(table, space.names)
    notes = []
    for name in space.names:
        gaps = table[name].missing
        if gaps.any():
            notes.append(f"no value of {name}: {left_out(table, gaps)}")
    coded = np.zeros((table.rows, space.size))
    for j, parameter in enumerate(space.parameters):
        there = keep & ~table[parameter.name].missing
        inside = np.ones(table.rows, dtype=bool)
        inside[there], coded[there, j] = _placed(
            parameter, table[parameter.name].values[there], convert.get(parameter.name, np.asarray)
        )
        if not inside.all():
            notes.append(f"outside of {_range(parameter)}: {left_out(table, ~inside)}")
        keep &= inside
    if space.constraints and keep.any():
        broken = keep.copy()
        given = coded[keep] if space.region is None else space.region.completed(coded[keep])
        broken[keep] = ~space.contains(given)
        if broken.any():
            notes.append(f"against the constraints: {left_out(table, broken)}")
        keep &= ~broken
    rows = np.flatnonzero(keep)
    return Used(rows, coded[rows], tuple(notes))


def left_out(table: Table, which: Mask) -> str:
    """`rows 3 and 7 of tests.csv are left out`."""
    count = int(which.sum())
    return f"{numbered(table, which)} {'is' if count == 1 else 'are'} left out"


def numbered(table: Table, which: Mask) -> str:
    """`rows 3, 4 and 7 of tests.csv`, as a spreadsheet counts them."""
    lines = [str(table.lines[row]) for row in np.flatnonzero(which)]
    more = [f"{len(lines) - NAMED} more"] if len(lines) > NAMED else []
    words = [*lines[:NAMED], *more]
    listed = " and ".join([*[", ".join(words[:-1])] * (len(words) > 1), words[-1]])
    return f"{'row' if len(lines) == 1 else 'rows'} {listed} of {table.file}"


def held_out(groups: NDArray[np.intp], fraction: float, seed: int) -> Mask:
    """A share of the runs at random, shape (run,); those of one group stay together.

    groups: number of each run's group, (run,). At least one group is held out, one is not.
    """
    names, counts = np.unique(groups, return_counts=True)
    order = np.random.default_rng(seed).permutation(len(names))
    taken = int(np.searchsorted(np.cumsum(counts[order]), fraction * len(groups)) + 1)
    chosen = names[order[: max(1, min(taken, len(names) - 1))]]
    return np.asarray(np.isin(groups, chosen))


def _placed(
    parameter: Parameter, values: NDArray[np.generic], convert: Callable[..., NDArray[np.float64]]
) -> tuple[Mask, NDArray[np.float64]]:
    """Which values the parameter can take, and their codes (0 for the others)."""
    codes = np.zeros(len(values))
    if parameter.categorical:
        inside = np.isin(values.astype(str), parameter.levels)
        codes[inside] = parameter.encode(values[inside])
        return inside, codes
    x = np.asarray(convert(values.astype(float)), dtype=float)
    low, high = parameter.law.support
    slack = SAME * (high - low) if parameter.bounded else 0.0
    inside = (x >= low - slack) & (x <= high + slack)
    codes[inside] = np.clip(parameter.encode(x[inside]), -1.0, 1.0)
    back = parameter.decode(codes)
    size = np.abs(x).max(initial=0.0)
    inside &= np.isfinite(back) & (np.abs(back - x) <= slack + SAME * size)
    return inside, np.where(inside, codes, 0.0)


def _range(parameter: Parameter) -> str:
    if parameter.categorical:
        return f"the levels of {parameter.name} ({', '.join(parameter.levels)})"
    low, high = parameter.law.support
    if not parameter.bounded:
        return f"what the distribution of {parameter.name} makes likely"
    return f"the range of {parameter.name} [{low:g}, {high:g}] {parameter.unit}".rstrip()
