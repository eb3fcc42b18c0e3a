"""Public pairs of a cheap and a true function of 1 to 8 inputs, each with the work it is from.

Formulas are as collected by Surjanovic and Bingham's Virtual Library of Simulation Experiments
and by mf2 (van Rijn and Schmitt 2020, doi 10.21105/joss.02049). Each takes points on the unit
cube, columns x[0], x[1], ..., and spreads them over the ranges of its source.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import qmc

Array = NDArray[np.float64]
Function = Callable[[Array], Array]


@dataclass(frozen=True)
class Pair:
    """cheap and true: rows of inputs (inputs, n) in their ranges -> (n,)."""

    name: str
    source: str
    ranges: tuple[tuple[float, float], ...]
    cheap: Function
    true: Function

    @property
    def inputs(self) -> int:
        return len(self.ranges)

    def values(self, function: Function, coded: Array) -> Array:
        """Values (n,) of `cheap` or `true` at coded points (n, inputs)."""
        low, high = np.array(self.ranges).T
        return np.asarray(function((low + (high - low) * (coded + 1.0) / 2.0).T), dtype=float)


def scattered(inputs: int, runs: int, cheap: int, seed: int) -> tuple[Array, Array]:
    """Coded points (cheap, inputs) of cheap runs and (runs, inputs) of true ones, the last of them.

    True runs are a random Latin hypercube (small maximin ones are alike whatever the seed), the
    other cheap ones a scrambled Sobol' sequence.
    """
    t = 2.0 * qmc.LatinHypercube(inputs, seed=1000 * runs + seed).random(runs) - 1.0
    more = qmc.Sobol(inputs, seed=seed).random_base2(math.ceil(math.log2(cheap)))[: cheap - runs]
    return np.vstack([2.0 * more - 1.0, t]), t


UNIT = (0.0, 1.0)
DONG = "Dong, Song, Wang and Dong 2015"
XIONG = "Xiong, Qian and Wu 2013"


def forrester(x: Array) -> Array:
    return (6 * x[0] - 2) ** 2 * np.sin(12 * x[0] - 4)


def forrester_cheap(x: Array) -> Array:
    return 0.5 * forrester(x) + 10 * (x[0] - 0.5) - 5


def currin(x: Array) -> Array:
    a, b = x[0], np.maximum(x[1], 1e-9)
    top = 2300 * a**3 + 1900 * a**2 + 2092 * a + 60
    return (1 - np.exp(-1 / (2 * b))) * top / (100 * a**3 + 500 * a**2 + 4 * a + 20)


def currin_cheap(x: Array) -> Array:
    corners = [
        currin(np.array([x[0] + i, np.maximum(x[1] + j, 0.0)]))
        for i in (-0.05, 0.05)
        for j in (-0.05, 0.05)
    ]
    return np.mean(corners, axis=0)


def branin(x: Array) -> Array:
    return _branin(x) - 22.5 * x[1]


def branin_cheap(x: Array) -> Array:
    return _branin(0.7 * x) - 1.575 * x[1] + 2 * (0.9 + x[0] ** 2) - 50


def _branin(x: Array) -> Array:
    valley = x[1] - 5.1 / (4 * np.pi**2) * x[0] ** 2 + 5 / np.pi * x[0] - 6
    return valley**2 + 10 * (1 - 1 / (8 * np.pi)) * np.cos(x[0]) + 10


def himmelblau(x: Array) -> Array:
    return (x[0] ** 2 + x[1] - 11) ** 2 + (x[1] ** 2 + x[0] - 7) ** 2


def himmelblau_cheap(x: Array) -> Array:
    return himmelblau(np.array([0.5 * x[0], 0.8 * x[1]])) + x[1] ** 3 - (x[0] + 1) ** 2


def six_hump_camel(x: Array) -> Array:
    a, b = x
    return (4 - 2.1 * a**2 + a**4 / 3) * a**2 + a * b + (-4 + 4 * b**2) * b**2


def six_hump_camel_cheap(x: Array) -> Array:
    return six_hump_camel(0.7 * x) + x[0] * x[1] - 15


def park(x: Array) -> Array:
    a, b, c, d = np.maximum(x, 1e-9)
    return a / 2 * (np.sqrt(1 + (b + c**2) * d / a**2) - 1) + (a + 3 * d) * np.exp(1 + np.sin(c))


def park_cheap(x: Array) -> Array:
    a, b, c, _ = x
    return (1 + np.sin(a) / 10) * park(x) - 2 * a + b**2 + c**2 + 0.5


def park_2(x: Array) -> Array:
    a, b, c, d = x
    return 2 / 3 * np.exp(a + b) - d * np.sin(c) + c


def park_2_cheap(x: Array) -> Array:
    return 1.2 * park_2(x) - 1


HARTMANN_WIDTHS = np.array(
    [
        [10, 3, 17, 3.5, 1.7, 8],
        [0.05, 10, 17, 0.1, 8, 14],
        [3, 3.5, 1.7, 10, 17, 8],
        [17, 8, 0.05, 10, 0.1, 14],
    ]
)
HARTMANN_PLACES = 1e-4 * np.array(
    [
        [1312, 1696, 5569, 124, 8283, 5886],
        [2329, 4135, 8307, 3736, 1004, 9991],
        [2348, 1451, 3522, 2883, 3047, 6650],
        [4047, 8828, 8732, 5743, 1091, 381],
    ]
)


def hartmann(x: Array) -> Array:
    return np.asarray((2.58 + np.array([1.0, 1.2, 3.0, 3.2]) @ np.exp(_hartmann(x))) / -1.94)


def hartmann_cheap(x: Array) -> Array:
    root = np.exp(-4 / 9) * (1 + (_hartmann(x) + 4) / 9)
    return np.asarray((2.58 + np.array([0.5, 0.5, 2.0, 4.0]) @ root**9) / -1.94)


def _hartmann(x: Array) -> Array:
    apart = x[None] - HARTMANN_PLACES[:, :, None]
    return -np.einsum("ij,ijn->in", HARTMANN_WIDTHS, apart**2)


def borehole(x: Array) -> Array:
    return _well(x, 2 * np.pi, 1.0)


def borehole_cheap(x: Array) -> Array:
    return _well(x, 5.0, 1.5)


def _well(x: Array, factor: float, one: float) -> Array:
    rw, r, tu, hu, tl, hl, length, kw = x
    log = np.log(r / rw)
    below = log * (one + 2 * length * tu / (log * rw**2 * kw) + tu / tl)
    return np.asarray(factor * tu * (hu - hl) / below)


WELL = (
    *((0.05, 0.15), (100.0, 50000.0), (63070.0, 115600.0), (990.0, 1110.0)),
    *((63.1, 116.0), (700.0, 820.0), (1120.0, 1680.0), (9855.0, 12045.0)),
)
PAIRS = {
    one.name: one
    for one in (
        Pair(
            "forrester",
            "Forrester, Sobester and Keane 2007",
            (UNIT,),
            forrester_cheap,
            forrester,
        ),
        Pair("currin", f"Currin et al. 1988, {XIONG}", (UNIT,) * 2, currin_cheap, currin),
        Pair("branin", DONG, ((-5.0, 10.0), (0.0, 15.0)), branin_cheap, branin),
        Pair("himmelblau", DONG, ((-4.0, 4.0),) * 2, himmelblau_cheap, himmelblau),
        Pair("camel", DONG, ((-2.0, 2.0),) * 2, six_hump_camel_cheap, six_hump_camel),
        Pair("park", f"Park 1991, {XIONG}", (UNIT,) * 4, park_cheap, park),
        Pair("park_2", f"Park 1991, {XIONG}", (UNIT,) * 4, park_2_cheap, park_2),
        Pair("hartmann", "Park, Haftka and Kim 2016", ((0.1, 1.0),) * 6, hartmann_cheap, hartmann),
        Pair("borehole", f"Harper and Gupta 1983, {XIONG}", WELL, borehole_cheap, borehole),
    )
}
