"""Regular two-level fractions: their columns as bit masks over the base factors.

A fraction with 2^m runs has m base factors that take all combinations; every other
factor is the product of some of them. Factor `0b101` is the product of base factors
0 and 2. Factors whose masks add to zero (exclusive or) form a defining word.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

import numpy as np


def matrix(masks: Sequence[int], base: int) -> np.ndarray:
    """Levels -1 and 1 of the factors `masks` in standard (Yates) order; (2^base, factor)."""
    runs = np.arange(2**base)[:, None]
    basic = np.where(runs >> np.arange(base) & 1, 1.0, -1.0)
    bits = [[i for i in range(base) if mask >> i & 1] for mask in masks]
    return np.column_stack([basic[:, of].prod(axis=1) for of in bits])


def weights(masks: Sequence[int], base: int) -> np.ndarray:
    """How many factors of each run differ from the run that is +1 throughout; (2^base,)."""
    changed: np.ndarray = np.rint((len(masks) - matrix(masks, base).sum(axis=1)) / 2)
    return changed.astype(int)


@cache
def krawtchouk(factors: int) -> tuple[tuple[int, ...], ...]:
    """K_i(w) for i, w = 0..factors: coefficient of z^i in (1 - z)^w (1 + z)^(factors - w)."""
    columns = []
    for weight in range(factors + 1):
        polynomial = [1]
        for j in range(factors):
            sign = -1 if j < weight else 1
            shifted = [0, *polynomial]
            polynomial = [a + sign * b for a, b in zip([*polynomial, 0], shifted, strict=True)]
        columns.append(polynomial)
    return tuple(zip(*columns, strict=True))


def word_lengths(run_weights: np.ndarray, factors: int) -> tuple[int, ...]:
    """Number of defining words of length 0, 1, .., factors (MacWilliams 1963).

    A_i = (1 / N) sum over the N runs of K_i(weight of the run): no need to list the
    words, of which there are 2^(factors - m).
    """
    counts = np.bincount(run_weights, minlength=factors + 1).tolist()
    total = sum(counts)
    return tuple(
        sum(k * n for k, n in zip(row, counts, strict=True)) // total for row in krawtchouk(factors)
    )


def resolution(lengths: Sequence[int]) -> int | None:
    """Length of the shortest defining word; None when there is none (a full factorial)."""
    return next((i for i, number in enumerate(lengths) if i and number), None)
