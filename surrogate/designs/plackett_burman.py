"""Plackett-Burman: k parameters in the next multiple of 4 above k runs, main effects only.

Plackett and Burman 1946. Columns come from a Hadamard matrix: Paley 1933, first kind
(cyclic; gives the published first rows for 12, 20 and 24 runs) and second kind, and
Sylvester's doubling. Main effects are orthogonal, but partly confounded with many
two-factor interactions; fold_over frees them.
"""

from __future__ import annotations

from functools import cache

import numpy as np

from surrogate.designs.center_points import centers
from surrogate.designs.requirements import affordable, two_level, uncut, whole
from surrogate.errors import DesignError
from surrogate.space.space import Space


def plackett_burman(
    space: Space, *, runs: int | None = None, center_points: int = 0, seed: int | None = None
) -> np.ndarray:
    """Coded (run, parameter) of -1 and 1, its last run all -1, then centre points.

    runs: a multiple of 4 above the number of parameters; default the smallest for which a
    Hadamard matrix is constructed here (92 runs, for one, is not and becomes 96).
    """
    two_level(space, "plackett_burman")
    least = 4 * (space.size // 4 + 1)
    affordable(least * space.size, "plackett_burman", "use latin_hypercube")
    if runs is None:
        runs = next(n for n in range(least, 4 * least, 4) if constructible(n))
    elif whole("runs", runs, least) % 4 or not constructible(runs):
        sizes = [str(n) for n in range(least, 4 * least, 4) if constructible(n)]
        raise DesignError(
            f"runs: no Plackett-Burman design with {runs} runs here; "
            f"use one of {', '.join(sizes[:8])}"
        )
    columns = saturated(runs)[:, : space.size]
    coded = np.vstack([columns, centers(space, center_points)])
    return uncut(space, coded, "plackett_burman")


def saturated(runs: int) -> np.ndarray:
    """`runs` - 1 orthogonal columns of -1 and 1; the last run is all -1."""
    matrix = hadamard(runs)
    # Signs of rows make the first column constant; signs of columns the last run -1.
    matrix = matrix * matrix[:, :1]
    columns = np.roll(matrix, -1, axis=0)[:, 1:]
    turned: np.ndarray = columns * -columns[-1]
    return turned


def constructible(order: int) -> bool:
    """True when `hadamard(order)` exists."""
    return (
        order in (1, 2)
        or _paley_first(order)
        or _paley_second(order)
        or (order % 8 == 0 and constructible(order // 2))
    )


@cache
def hadamard(order: int) -> np.ndarray:
    """Matrix of -1 and 1 with orthogonal rows, (order, order)."""
    if order == 1:
        return np.ones((1, 1))
    if order == 2 or (order % 8 == 0 and not _paley_first(order)) or order & (order - 1) == 0:
        return np.kron([[1.0, 1.0], [1.0, -1.0]], hadamard(order // 2))
    return _first_kind(order - 1) if _paley_first(order) else _second_kind(order // 2 - 1)


def _paley_first(order: int) -> bool:
    return order % 4 == 0 and _prime(order - 1)


def _paley_second(order: int) -> bool:
    return order % 4 == 0 and _prime(order // 2 - 1) and (order // 2 - 1) % 4 == 1


def _prime(q: int) -> bool:
    return q > 2 and all(q % d for d in range(2, int(q**0.5) + 1))


def _character(q: int) -> np.ndarray:
    """Quadratic character of 0..q-1: 0 at 0, 1 at squares, -1 elsewhere."""
    values = -np.ones(q)
    values[np.arange(q) ** 2 % q] = 1.0
    values[0] = 0.0
    return values


def _first_kind(q: int) -> np.ndarray:
    """q = 3 modulo 4: rows are the shifts of + followed by the character, bordered by +."""
    row = _character(q)
    row[0] = 1.0
    matrix = np.ones((q + 1, q + 1))
    matrix[1:, 1:] = [np.roll(row, shift) for shift in range(q)]
    matrix[0, 1:] = -1.0
    return matrix


def _second_kind(q: int) -> np.ndarray:
    """q = 1 modulo 4: twice the bordered character matrix, entries replaced by 2 x 2 blocks."""
    index = np.arange(q)
    conference = np.ones((q + 1, q + 1))
    conference[0, 0] = 0.0
    conference[1:, 1:] = _character(q)[(index[:, None] - index) % q]
    return np.kron(conference, [[1.0, 1.0], [1.0, -1.0]]) + np.kron(
        np.eye(q + 1), [[1.0, -1.0], [-1.0, -1.0]]
    )
