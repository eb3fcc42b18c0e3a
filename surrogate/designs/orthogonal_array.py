"""Orthogonal arrays: every pair of levels of any two parameters equally often.

For main effects of parameters with unlike numbers of levels, in few runs (Hedayat, Sloane and
Stufken, Orthogonal Arrays, 1999). The arrays are pyDOE3's; a column of 4 levels also serves as
three of 2, one of 6 as one of 2 and one of 3 (expansive replacement, section 9.3 there). One of
pyDOE3's is no orthogonal array (L64(2^31) in version 1.6): such are left out.
"""

from __future__ import annotations

from collections import Counter
from functools import cache

import numpy as np
import pyDOE3
from numpy.typing import NDArray

from surrogate.designs.levels import counts_of, grid
from surrogate.designs.requirements import bounded, uncut
from surrogate.errors import DesignError
from surrogate.space.space import Space

Index = NDArray[np.intp]

#: Levels of a column -> columns that may stand in its place, (row of the level, column).
REPLACED = {
    4: np.array([[0, 0, 0], [0, 1, 1], [1, 0, 1], [1, 1, 0]]),
    6: np.array([[a, b] for a in range(2) for b in range(3)]),
}


def orthogonal_array(
    space: Space,
    *,
    levels: int | dict[str, int] | None = None,
    runs: int | None = None,
    seed: int | None = None,
) -> NDArray[np.float64]:
    """Coded (run, parameter) of the smallest array with such levels; or of one of `runs` runs.

    levels: number of levels of each parameter, or of the named ones; the others have 3, or 2
    where they have two values. A categorical parameter has its own. Raises `DesignError`
    when no array of those here has columns enough.
    """
    bounded(space, "orthogonal_array")
    counts = counts_of(space, _each(space, levels), default=3)
    arrays = (a for a in _arrays() if runs in (None, len(a)))
    columns = next(filter(None, (_columns(a, counts) for a in arrays)), None)
    if columns is None:
        listed = ", ".join(f"{n} with {count}" for count, n in sorted(Counter(counts).items()))
        sizes = sorted({len(a) for a in _arrays()})
        raise DesignError(
            f"orthogonal_array: no array of {runs or f'{sizes[-1]} or fewer'} runs holds all "
            f"levels (parameters: {listed} levels); arrays have {', '.join(map(str, sizes))} "
            "runs; take other levels, or d_optimal"
        )
    coded = [
        grid(p, count)[column]
        for p, count, column in zip(space.parameters, counts, columns, strict=True)
    ]
    return uncut(space, np.column_stack(coded), "orthogonal_array")


def _each(space: Space, levels: int | dict[str, int] | None) -> int | dict[str, int]:
    """The levels that are given; 2 for parameters with two values that get none."""
    if isinstance(levels, int):
        return levels
    two = {p.name: 2 for p in space.parameters if p.allowed is not None and len(p.allowed) == 2}
    return {**two, **(levels or {})}


@cache
def _arrays() -> tuple[Index, ...]:
    """Every array of strength 2 that pyDOE3 has, the smallest first; levels from 0."""
    found = [
        np.column_stack([np.unique(column, return_inverse=True)[1] for column in array.T])
        for array in map(pyDOE3.get_orthogonal_array, pyDOE3.list_orthogonal_arrays())
    ]
    eight = found[1]  # L8(2^7), whose third column is the product of the first two
    found.append(np.column_stack([2 * eight[:, 0] + eight[:, 1], eight[:, 3:]]))
    return tuple(sorted(filter(balanced, found), key=len))


def balanced(array: Index) -> bool:
    """Whether each two columns (run, column) hold every pair of levels equally often."""
    one = [np.eye(column.max() + 1)[column] for column in array.T]
    together = np.hstack(one).T @ np.hstack(one)
    shares = np.concatenate([np.full(o.shape[1], 1.0 / o.shape[1]) for o in one])
    wanted = len(array) * np.outer(shares, shares)
    number = np.repeat(np.arange(len(one)), [o.shape[1] for o in one])
    other = number[:, None] != number
    return bool(np.abs(together - wanted)[other].max(initial=0.0) < 1e-9)


def _columns(array: Index, counts: list[int]) -> list[Index] | None:
    """A column for each count of levels; None when there are too few."""
    free: dict[int, list[Index]] = {}
    for column in array.T:
        free.setdefault(int(column.max()) + 1, []).append(column)
    found: dict[int, Index] = {}
    # Columns of many levels first: what is left of them may be replaced.
    for number in sorted(range(len(counts)), key=lambda number: -counts[number]):
        column = _taken(free, counts[number])
        if column is None:
            return None
        found[number] = column
    return [found[number] for number in range(len(counts))]


def _taken(free: dict[int, list[Index]], count: int) -> Index | None:
    """A free column of so many levels, which is taken away; of a replaced one when needed."""
    if not free.get(count):
        for levels, inner in REPLACED.items():
            if free.get(levels) and count in inner.max(axis=0) + 1:
                column = free[levels].pop()
                for part in inner.T:
                    free.setdefault(int(part.max()) + 1, []).append(part[column])
                break
    return free[count].pop(0) if free.get(count) else None
