"""Box-Behnken: edge midpoints of the cube, for quadratic models without corners.

Box and Behnken 1960, Technometrics 2(4), 455-475, table 4. Each block of parameters runs
through a two-level factorial while all others stay at the centre. Blocks are pairs up to
5 parameters only; beyond, blocks of 3 to 5 parameters give far fewer runs.
"""

from __future__ import annotations

import itertools

import numpy as np

from surrogate.designs import regular_fraction
from surrogate.designs.center_points import centers
from surrogate.designs.requirements import continuous, uncut
from surrogate.errors import DesignError
from surrogate.space.space import Space


def _cyclic(first: tuple[int, ...], parameters: int) -> tuple[tuple[int, ...], ...]:
    """Blocks made by adding 0, 1, .., parameters - 1 to the first."""
    return tuple(tuple((j + shift) % parameters for j in first) for shift in range(parameters))


def _from_one(*blocks: str) -> tuple[tuple[int, ...], ...]:
    """Blocks printed with parameters counted from 1, hexadecimal digits, 0 for 16."""
    return tuple(tuple((int(digit, 16) - 1) % 16 for digit in block) for block in blocks)


#: Number of parameters -> blocks.
BLOCKS = {
    3: tuple(itertools.combinations(range(3), 2)),
    4: tuple(itertools.combinations(range(4), 2)),
    5: tuple(itertools.combinations(range(5), 2)),
    6: _cyclic((0, 1, 3), 6),
    7: _cyclic((0, 1, 3), 7),
    9: _from_one(
        "147",
        "258",
        "369",
        "123",
        "456",
        "789",
        "159",
        "348",
        "267",
        "168",
        "249",
        "357",
        "147",
        "258",
        "369",
    ),
    10: _from_one("267a", "125a", "2378", "2469", "189a", "345a", "1478", "3579", "1369", "4568"),
    11: _cyclic((2, 6, 7, 8, 10), 11),
    12: _cyclic((0, 1, 4, 6), 12),
    16: _from_one(
        "1269",
        "348b",
        "5ade",
        "7cf0",
        "237a",
        "145c",
        "6bef",
        "89d0",
        "256d",
        "478f",
        "19ae",
        "3bc0",
        "367e",
        "1580",
        "2abf",
        "49cd",
        "13df",
        "24e0",
        "579b",
        "68ac",
        "46a0",
        "359f",
        "17bd",
        "28ce",
    ),
}


def box_behnken(space: Space, *, center_points: int = 1, seed: int | None = None) -> np.ndarray:
    """Coded (run, parameter) with values -1, 0, 1; centre points at the end.

    3 to 7, 9 to 12 or 16 continuous parameters: 12, 24, 40, 48, 56, 120, 160, 176, 192 or
    384 runs besides centre points. Raises `DesignError` for other numbers.
    """
    continuous(space, "box_behnken")
    if space.size not in BLOCKS:
        raise DesignError(
            f"box_behnken: no design is published for {space.size} parameters "
            f"(there are for {', '.join(map(str, BLOCKS))}); use central_composite "
            "or d_optimal with model: quadratic"
        )
    rows = [_block_runs(block, space.size) for block in BLOCKS[space.size]]
    coded = np.vstack([space.snap(np.vstack(rows)), centers(space, center_points)])
    return uncut(space, coded, "box_behnken")


def _block_runs(block: tuple[int, ...], parameters: int) -> np.ndarray:
    """Two-level factorial in the block; blocks of 5 take the half fraction E = ABCD."""
    base = min(len(block), 4)
    masks = [*(1 << i for i in range(base)), 0b1111][: len(block)]
    corners = regular_fraction.matrix(masks, base)
    runs = np.zeros((len(corners), parameters))
    runs[:, block] = corners
    return runs
