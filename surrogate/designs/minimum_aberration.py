"""Two-level fractions with the fewest runs and the least aberration.

`TABLE` holds the generators of Box, Hunter and Hunter 1978 (table 12.15), as in the
NIST/SEMATECH handbook, section 5.3.3.4.7. Other sizes are searched: columns are added
greedily so that no word is shorter than the resolution asked for, then exchanged as
long as that improves the word-length pattern (Fries and Hunter 1980: fewest shortest
words first). The search has fixed seeds; beyond the table its answer is the best
found, not proven the best.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from functools import cache

import numpy as np

from surrogate.designs import regular_fraction

#: (factors, generators) -> products of base factors A, B, ... that make the other factors.
TABLE = {
    (3, 1): "AB",
    (4, 1): "ABC",
    (5, 1): "ABCD",
    (5, 2): "AB AC",
    (6, 1): "ABCDE",
    (6, 2): "ABC BCD",
    (6, 3): "AB AC BC",
    (7, 1): "ABCDEF",
    (7, 2): "ABCD ABDE",
    (7, 3): "ABC BCD ACD",
    (7, 4): "AB AC BC ABC",
    (8, 2): "ABCD ABEF",
    (8, 3): "ABC ABD BCDE",
    (8, 4): "BCD ACD ABC ABD",
    (9, 2): "ACDFG BCEFG",
    (9, 3): "ABCD ACEF CDEF",
    (9, 4): "BCDE ACDE ABDE ABCE",
    (9, 5): "ABC BCD ACD ABD ABCD",
    (10, 3): "ABCG BCDE ACDF",
    (10, 4): "BCDF ACDF ABDE ABCE",
    (10, 5): "ABCD ABCE ABDE ACDE BCDE",
    (10, 6): "ABC BCD ACD ABD ABCD AB",
    (11, 5): "CDE ABCD ABF BDEF ADEF",
    (11, 6): "ABC BCD CDE ACD ADE BDE",
}
LETTERS = "ABCDEFGHJKLMNOPQRSTUVWXYZ"
STARTS = 24
#: Words of these lengths are compared when columns are exchanged.
COMPARED = range(3, 9)
#: Random starts up to 2^10 runs; exchanges, which weigh every column against every run, up to
#: 2^8 runs and 64 factors (beyond, numbers of words also leave 64-bit integers).
LARGEST_STARTS, LARGEST_EXCHANGE, MOST_EXCHANGED = 10, 8, 64


def mask(word: str) -> int:
    """Bit mask of a product of base factors written in letters (I is not a factor)."""
    return sum(1 << LETTERS.index(letter) for letter in word)


def fewest_runs(factors: int, resolution: int, largest_base: int) -> tuple[int, ...] | None:
    """Masks of the smallest fraction found with at least this resolution.

    Base factors come first. Returns None when `largest_base` base factors do not suffice.
    """
    for base in range(_least_base(factors, resolution), min(factors, largest_base) + 1):
        masks = fraction(factors, base)
        reached = regular_fraction.resolution(
            regular_fraction.word_lengths(regular_fraction.weights(masks, base), factors)
        )
        if reached is None or reached >= resolution:
            return masks
    return None


@cache
def fraction(factors: int, base: int) -> tuple[int, ...]:
    """Masks of the fraction in 2^base runs with the least aberration known or found."""
    basic = tuple(1 << i for i in range(base))
    if base == factors:
        return basic
    if (factors, factors - base) in TABLE:
        return basic + tuple(map(mask, TABLE[factors, factors - base].split()))
    return search(factors, base)


@cache
def search(factors: int, base: int) -> tuple[int, ...]:
    """Fraction of the highest resolution and then the least aberration that is found."""
    for resolution in range(factors, 2, -1):
        if _least_base(factors, resolution) <= base:
            starts = _starts(factors, base, resolution)
            if starts:
                return min(
                    (_exchange(masks, base) for masks in starts),
                    key=lambda masks: _pattern(masks, base),
                )
    raise ValueError(f"{factors} factors do not fit in {2**base} runs")


def _pattern(masks: tuple[int, ...], base: int) -> tuple[int, ...]:
    return regular_fraction.word_lengths(regular_fraction.weights(masks, base), len(masks))


def _least_base(factors: int, resolution: int) -> int:
    """Base factors that a fraction needs at least: the sphere-packing (Hamming) bound.

    Runs are the cosets of a code of length `factors` and minimum distance `resolution`.
    """
    if resolution % 2 == 0:
        return _least_base(factors - 1, resolution - 1) + 1
    ball = sum(math.comb(factors, i) for i in range((resolution - 1) // 2 + 1))
    return (ball - 1).bit_length()


def _starts(factors: int, base: int, resolution: int) -> list[tuple[int, ...]]:
    """Greedy fractions: candidates in numerical order, then in random orders."""
    rng = np.random.default_rng(factors * 100 + base)
    order = np.arange(1, 2**base)
    found = [_greedy(order, factors, base, resolution)]
    for _ in range(STARTS if base <= LARGEST_STARTS else 0):
        found.append(_greedy(rng.permutation(order), factors, base, resolution))
    return [masks for masks in found if masks is not None]


def _greedy(
    order: Iterable[int], factors: int, base: int, resolution: int
) -> tuple[int, ...] | None:
    """Add each candidate that makes no word shorter than `resolution`; None if too few do."""
    # sums[j] marks every mask that is the sum of at most j chosen columns.
    every = np.arange(2**base)
    sums = np.zeros((resolution - 1, 2**base), dtype=bool)
    sums[:, 0] = True
    chosen: list[int] = []
    for column in [*(1 << i for i in range(base)), *map(int, order)]:
        if len(chosen) == factors:
            break
        if not sums[-1, column]:
            chosen.append(column)
            sums[1:] |= sums[:-1, every ^ column]
    return tuple(chosen) if len(chosen) == factors else None


def _exchange(masks: tuple[int, ...], base: int) -> tuple[int, ...]:
    """Replace one column at a time while that improves the word-length pattern."""
    if base > LARGEST_EXCHANGE or len(masks) > MOST_EXCHANGED:
        return masks
    everything = np.rint((1 - regular_fraction.matrix(range(1, 2**base), base)) / 2).astype(
        np.int32
    )
    chosen, improved = list(masks), True
    while improved:
        improved = False
        for position in range(base, len(chosen)):
            better = _best_exchange(chosen, position, everything)
            if better != chosen[position]:
                chosen[position], improved = better, True
    return tuple(chosen)


def _best_exchange(masks: list[int], position: int, everything: np.ndarray) -> int:
    """Mask for this position that gives the least aberration; the present one on a tie."""
    factors = len(masks)
    present = masks[position] - 1
    others = [mask - 1 for j, mask in enumerate(masks) if j != position]
    free = np.setdiff1d(np.arange(everything.shape[1]), [*others, present])
    free = np.concatenate([[present], free])
    weight = everything[:, others].sum(axis=1)[:, None] + everything[:, free]
    numbers = regular_fraction.krawtchouk(factors)
    patterns = [np.array(numbers[i])[weight].sum(axis=0) for i in COMPARED if i <= factors]
    best = np.lexsort(patterns[::-1])[0]
    tied = all(pattern[best] == pattern[0] for pattern in patterns)
    return masks[position] if tied else int(free[best]) + 1
