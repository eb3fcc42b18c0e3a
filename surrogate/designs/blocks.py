"""Blocks of a two-level fraction: the effects that are given up for differences between blocks.

The 2^m runs of a regular fraction are divided into 2^b blocks by the signs of b effects. These
and all products of them, 2^b - 1 effects, cannot be told from differences between blocks
(Montgomery, Design and Analysis of Experiments, chapter 7). They are chosen so that no main effect
is among them, then as few two-factor interactions as can be, then as few of three factors, and
then of high order (Sun, Wu and Chen 1997, Technometrics 39, 298). All choices are
compared up to 64 runs; of larger fractions the answer is the best found.
"""

from __future__ import annotations

import itertools
from collections import Counter

import numpy as np
from numpy.typing import NDArray

from surrogate.designs.requirements import whole
from surrogate.errors import DesignError, nearest
from surrogate.space.space import Space

#: Sets of block effects, times effects, that are carried from one step of the search to the next.
KEPT = 100_000
#: Factors in an effect whose aliases are counted one by one.
COUNTED = 3

#: Numbers of main effects, two- and three-factor interactions, and minus the sum of all orders.
Worth = tuple[int, ...]
#: Block effects -> what they cost, and effects that generate them.
Sets = dict[frozenset[int], tuple[Worth, list[int]]]


def block_parameter(space: Space, name: str) -> int:
    """Number of the parameter that blocks are levels of; raises `DesignError`."""
    if name not in space.names:
        raise DesignError(
            f"blocks: '{name}' is no parameter; {nearest(name, space.names)}. Blocks are the "
            "levels of a parameter, such as day: {levels: [mon, tue]}"
        )
    levels = space[name].levels
    if not levels or len(levels) & (len(levels) - 1) or len(levels) < 2:
        has = f"{len(levels)} levels" if levels else "no levels"
        raise DesignError(
            f"blocks: {name} has {has}; a two-level fraction divides into 2, 4, 8, .. blocks, "
            "which are the levels of a parameter such as day: {levels: [mon, tue]}"
        )
    if space.size < 3:
        raise DesignError("blocks: at least two parameters must vary within them")
    return space.names.index(name)


def block_numbers(corners: NDArray[np.float64], count: int) -> NDArray[np.intp]:
    """Block 0 .. count - 1 of each run (n,) of a regular fraction (n, factor) of -1 and 1.

    Raises `DesignError` when there are too few runs, or main effects would be given up.
    """
    whole("blocks", count, 2)
    coordinates, masks = _coordinates(corners)
    wanted, base = count.bit_length() - 1, coordinates.shape[1]
    if wanted >= base:
        raise DesignError(
            f"blocks: {len(corners)} runs do not divide into {count} blocks of 2 or more; "
            "take fewer blocks or more runs"
        )
    chosen = _search(masks, base, wanted)
    if chosen is None:
        raise DesignError(
            f"blocks: {count} blocks of {len(corners)} runs would hide a main effect; take fewer "
            "blocks, more runs, or a smaller resolution"
        )
    bits = coordinates @ np.array([[v >> i & 1 for v in chosen] for i in range(base)]) % 2
    return np.asarray(bits @ (1 << np.arange(wanted)), dtype=np.intp)


def _coordinates(corners: NDArray[np.float64]) -> tuple[NDArray[np.intp], list[int]]:
    """Bits (n, m) of each run, and of each factor the bits whose sum it is, as a mask."""
    bits = (corners > 0).astype(np.intp)
    reduced = [((1 << len(bits)) - 1, 0)]
    base: list[int] = []
    masks: list[int] = []
    for j, column in enumerate(bits.T):
        value, mask = int("".join(map(str, column)), 2), 0
        for known, sums in reduced:
            if value ^ known < value:
                value, mask = value ^ known, mask ^ sums
        if value:
            new = 1 << len(base)
            reduced = sorted([*reduced, (value, mask ^ new)], reverse=True)
            base.append(j)
            mask = new
        masks.append(mask)
    return bits[:, base], masks


def _search(masks: list[int], base: int, wanted: int) -> list[int] | None:
    """Generators of the best set of block effects; None when all sets hold a main effect."""
    single = _worths(masks, base)
    sets: Sets = {frozenset([0]): ((0,) * (COUNTED + 1), [])}
    for _ in range(wanted):
        grown: Sets = {}
        for group, (_, generators) in sets.items():
            for v in range(1, 2**base):
                if v in group or (new := group | {v ^ one for one in group}) in grown:
                    continue
                worth = tuple(map(sum, zip(*(single[one] for one in new if one), strict=True)))
                if worth[0] == 0:
                    grown[new] = (worth, [*generators, v])
        best = sorted(grown.items(), key=lambda item: item[1])
        sets = dict(best[: max(KEPT >> base, 20)])
    return min(sets.values(), default=(None, None))[1]


def _worths(masks: list[int], base: int) -> list[Worth]:
    """For each effect (a sum of base factors) what giving it up costs, least is best."""
    counts = [Counter[int]() for _ in range(COUNTED)]
    for order, found in enumerate(counts, start=1):
        for factors in itertools.combinations(masks, order):
            found[_sum(factors)] += 1
    orders = _orders(masks, base)
    return [(*(found[v] for found in counts), -orders[v]) for v in range(2**base)]


def _sum(masks: tuple[int, ...]) -> int:
    total = 0
    for mask in masks:
        total ^= mask
    return total


def _orders(masks: list[int], base: int) -> list[int]:
    """Fewest factors whose product each effect is."""
    orders, reached = [0] + [base + 1] * (2**base - 1), [0]
    while reached:
        following = []
        for v, mask in itertools.product(reached, masks):
            if orders[v ^ mask] > orders[v] + 1:
                orders[v ^ mask] = orders[v] + 1
                following.append(v ^ mask)
        reached = following
    return orders
