"""Public test functions of 1 to 20 inputs, each with the work that it is from.

Formulas are as collected by UQTestFuns (Wicaksono and Hecht 2023, doi 10.21105/joss.05671) and
by Surjanovic and Bingham's Virtual Library of Simulation Experiments. Each takes points on the
unit cube, columns x[0], x[1], ..., and spreads them over the ranges of its source. The textbook
functions that ship as solvers are among them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from surrogate.solver import Solver
from surrogate_solvers import textbook

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Function:
    """values(unit points (n, inputs)) -> (n,); source is author and year."""

    name: str
    source: str
    inputs: int
    values: Callable[[Array], Array]


ALL: list[Function] = []


def _public(source: str, *ranges: tuple[float, float]) -> Callable[..., Callable[..., Array]]:
    """Register a function of the rows x (inputs, n), whose inputs have these ranges."""
    low, high = np.array(ranges).T

    def register(function: Callable[..., Array]) -> Callable[..., Array]:
        def values(u: Array) -> Array:
            return np.asarray(function((low + (high - low) * u).T), dtype=float)

        ALL.append(Function(function.__name__, source, len(ranges), values))
        return function

    return register


UNIT = (0.0, 1.0)


@_public("Forrester, Sobester and Keane 2008", UNIT)
def forrester(x: Array) -> Array:
    return (6.0 * x[0] - 2.0) ** 2 * np.sin(12.0 * x[0] - 4.0)


@_public("Gramacy and Lee 2012", (0.5, 2.5))
def gramacy_lee(x: Array) -> Array:
    return np.sin(10.0 * np.pi * x[0]) / (2.0 * x[0]) + (x[0] - 1.0) ** 4


@_public("Higdon 2002", (0.0, 10.0))
def higdon(x: Array) -> Array:
    return np.sin(2.0 * np.pi * x[0] / 10.0) + 0.2 * np.sin(2.0 * np.pi * x[0] / 2.5)


@_public("Santner, Williams and Notz 2003", UNIT)
def damped_cosine(x: Array) -> Array:
    return np.exp(-1.4 * x[0]) * np.cos(3.5 * np.pi * x[0])


@_public("Oakley and O'Hagan 2002", (-12.0, 12.0))
def oakley_1d(x: Array) -> Array:
    return 5.0 + x[0] + np.cos(x[0])


@_public("Dixon and Szego 1978 (Branin)", (-5.0, 10.0), (0.0, 15.0))
def branin(x: Array) -> Array:
    valley = x[1] - 5.1 / (4.0 * np.pi**2) * x[0] ** 2 + 5.0 / np.pi * x[0] - 6.0
    return valley**2 + 10.0 * (1.0 - 1.0 / (8.0 * np.pi)) * np.cos(x[0]) + 10.0


@_public("Currin, Mitchell, Morris and Ylvisaker 1988", UNIT, UNIT)
def currin(x: Array) -> Array:
    front = -np.expm1(-0.5 / np.maximum(x[1], 1e-12))
    above = 2300.0 * x[0] ** 3 + 1900.0 * x[0] ** 2 + 2092.0 * x[0] + 60.0
    return front * above / (100.0 * x[0] ** 3 + 500.0 * x[0] ** 2 + 4.0 * x[0] + 20.0)


@_public("Lim, Sacks, Studden and Welch 2002", UNIT, UNIT)
def lim(x: Array) -> Array:
    return ((30.0 + 5.0 * x[0] * np.sin(5.0 * x[0])) * (4.0 + np.exp(-5.0 * x[1])) - 100.0) / 6.0


@_public("Franke 1979", UNIT, UNIT)
def franke(x: Array) -> Array:
    a, b = 9.0 * x
    return (
        0.75 * np.exp(-((a - 2.0) ** 2 + (b - 2.0) ** 2) / 4.0)
        + 0.75 * np.exp(-((a + 1.0) ** 2) / 49.0 - (b + 1.0) / 10.0)
        + 0.5 * np.exp(-((a - 7.0) ** 2 + (b - 3.0) ** 2) / 4.0)
        - 0.2 * np.exp(-((a - 4.0) ** 2) - (b - 7.0) ** 2)
    )


@_public("McCormick 1976", (-1.5, 4.0), (-3.0, 4.0))
def mccormick(x: Array) -> Array:
    a, b = x
    return np.sin(a + b) + (a - b) ** 2 - 1.5 * a + 2.5 * b + 1.0


@_public("Dixon and Szego 1978 (six-hump camel)", (-2.0, 2.0), (-1.0, 1.0))
def six_hump_camel(x: Array) -> Array:
    a, b = x
    return (4.0 - 2.1 * a**2 + a**4 / 3.0) * a**2 + a * b + (-4.0 + 4.0 * b**2) * b**2


@_public("Picheny, Wagner and Ginsbourger 2013 (log of Goldstein-Price)", UNIT, UNIT)
def goldstein_price(x: Array) -> Array:
    a, b = 4.0 * x - 2.0
    inner = 19.0 - 14.0 * a + 3.0 * a**2 - 14.0 * b + 6.0 * a * b + 3.0 * b**2
    outer = 18.0 - 32.0 * a + 12.0 * a**2 + 48.0 * b - 36.0 * a * b + 27.0 * b**2
    product = (1.0 + (a + b + 1.0) ** 2 * inner) * (30.0 + (2.0 * a - 3.0 * b) ** 2 * outer)
    return (np.log(product) - 8.693) / 2.427


@_public("Gramacy 2007", (-2.0, 6.0), (-2.0, 6.0))
def gramacy_exponential(x: Array) -> Array:
    return x[0] * np.exp(-(x[0] ** 2) - x[1] ** 2)


@_public("Cheng and Sandu 2010", UNIT, UNIT)
def cheng_sandu(x: Array) -> Array:
    return np.cos(x[0] + x[1]) * np.exp(x[0] * x[1])


@_public("Alemazkoor and Meidani 2018", (-1.0, 1.0), (-1.0, 1.0))
def high_order_polynomial(x: Array) -> Array:
    powers = np.arange(1, 6)[:, None]
    return np.sum(x[0] ** (2 * powers) * x[1] ** (2 * powers), axis=0)


@_public("Dette and Pepelyshev 2010 (curved)", UNIT, UNIT, UNIT)
def dette_curved(x: Array) -> Array:
    a, b, c = x
    return (
        4.0 * (a - 2.0 + 8.0 * b - 8.0 * b**2) ** 2
        + (3.0 - 4.0 * b) ** 2
        + 16.0 * np.sqrt(c + 1.0) * (2.0 * c - 1.0) ** 2
    )


HARTMANN_WEIGHTS = np.array([1.0, 1.2, 3.0, 3.2])


def _hartmann(x: Array, widths: Array, places: Array) -> Array:
    squares = np.einsum("ij,ijn->in", widths, (x[None] - places[:, :, None]) ** 2)
    return -HARTMANN_WEIGHTS @ np.exp(-squares)


@_public("Dixon and Szego 1978 (Hartmann)", *[UNIT] * 3)
def hartmann_3(x: Array) -> Array:
    widths = np.array([[3.0, 10.0, 30.0], [0.1, 10.0, 35.0]] * 2)
    places = [[3689, 1170, 2673], [4699, 4387, 7470], [1091, 8732, 5547], [381, 5743, 8828]]
    return _hartmann(x, widths, 1e-4 * np.array(places))


@_public("Dixon and Szego 1978 (Hartmann)", *[UNIT] * 6)
def hartmann_6(x: Array) -> Array:
    widths = [
        [10.0, 3.0, 17.0, 3.5, 1.7, 8.0],
        [0.05, 10.0, 17.0, 0.1, 8.0, 14.0],
        [3.0, 3.5, 1.7, 10.0, 17.0, 8.0],
        [17.0, 8.0, 0.05, 10.0, 0.1, 14.0],
    ]
    places = [
        [1312, 1696, 5569, 124, 8283, 5886],
        [2329, 4135, 8307, 3736, 1004, 9991],
        [2348, 1451, 3522, 2883, 3047, 6650],
        [4047, 8828, 8732, 5743, 1091, 381],
    ]
    return _hartmann(x, np.array(widths), 1e-4 * np.array(places))


@_public("Bliznyuk et al. 2008", (7.0, 13.0), (0.02, 0.12), (0.01, 3.0), (30.01, 30.295))
def pollutant(x: Array) -> Array:
    """Concentration of two spills of mass M at place 1.5 and time 40."""
    M, D, L, tau = x
    place, time = 1.5, 40.0
    first = np.exp(-(place**2) / (4.0 * D * time)) / np.sqrt(D * time)
    second = np.exp(-((place - L) ** 2) / (4.0 * D * (time - tau))) / np.sqrt(D * (time - tau))
    return M * (first + second)


@_public("Park 1991, function 1", (0.01, 1.0), *[UNIT] * 3)
def park_1(x: Array) -> Array:
    a, b, c, d = x
    root = np.sqrt(1.0 + (b + c**2) * d / a**2)
    return a / 2.0 * (root - 1.0) + (a + 3.0 * d) * np.exp(1.0 + np.sin(c))


@_public("Park 1991, function 2", *[UNIT] * 4)
def park_2(x: Array) -> Array:
    return 2.0 / 3.0 * np.exp(x[0] + x[1]) - x[3] * np.sin(x[2]) + x[2]


@_public("Friedman, Grosse and Stuetzle 1983", *[UNIT] * 5)
def friedman(x: Array) -> Array:
    return 10.0 * np.sin(np.pi * x[0] * x[1]) + 20.0 * (x[2] - 0.5) ** 2 + 10.0 * x[3] + 5.0 * x[4]


@_public("Gramacy and Lee 2009", *[UNIT] * 6)
def gramacy_lee_6d(x: Array) -> Array:
    return np.exp(np.sin((0.9 * (x[0] + 0.48)) ** 10)) + x[1] * x[2] + x[3]


@_public("An and Owen 2001", *[(0.0, 2.0 * np.pi)] * 4, *[UNIT] * 4)
def robot_arm(x: Array) -> Array:
    angles, lengths = np.cumsum(x[:4], axis=0), x[4:]
    return np.hypot((lengths * np.cos(angles)).sum(axis=0), (lengths * np.sin(angles)).sum(axis=0))


@_public("Dette and Pepelyshev 2010 (8 inputs)", *[UNIT] * 8)
def dette_8d(x: Array) -> Array:
    curved = 4.0 * (x[0] - 2.0 + 8.0 * x[1] - 8.0 * x[1] ** 2) ** 2 + (3.0 - 4.0 * x[1]) ** 2
    waves = 16.0 * np.sqrt(x[2] + 1.0) * (2.0 * x[2] - 1.0) ** 2
    sums = [i * np.log(1.0 + x[2:i].sum(axis=0)) for i in range(4, 9)]
    return curved + waves + np.sum(sums, axis=0)


@_public(
    "Iooss and Lemaitre 2015 (flood, uniform laws)",
    (500.0, 3000.0),
    (15.0, 50.0),
    (49.0, 51.0),
    (54.0, 56.0),
    (7.0, 9.0),
    (55.0, 56.0),
    (4990.0, 5010.0),
    (295.0, 305.0),
)
def flood(x: Array) -> Array:
    """Height of the water above the dyke, in m."""
    Q, Ks, Zv, Zm, Hd, Cb, L, B = x
    height = (Q / (B * Ks * np.sqrt((Zm - Zv) / L))) ** 0.6
    return Zv + height - Hd - Cb


@_public("Linkletter et al. 2006 (sine)", *[UNIT] * 10)
def linkletter_sine(x: Array) -> Array:
    return np.sin(x[0]) + np.sin(5.0 * x[1])


@_public("Linkletter et al. 2006 (decreasing coefficients)", *[UNIT] * 10)
def linkletter_decreasing(x: Array) -> Array:
    return 0.2 * sum(0.5**i * x[i] for i in range(8))


@_public("Loeppky, Williams and Moore 2013", *[UNIT] * 10)
def loeppky(x: Array) -> Array:
    main = 6.0 * x[0] + 4.0 * x[1] + 5.5 * x[2] + x[6] + 0.5 * x[7] + 0.2 * x[8] + 0.1 * x[9]
    return main + 3.0 * x[0] * x[1] + 2.2 * x[0] * x[2] + 1.4 * x[1] * x[2]


@_public("Bratley, Fox and Niederreiter 1992", *[UNIT] * 10)
def bratley(x: Array) -> Array:
    return -np.cumprod(-x, axis=0).sum(axis=0)


@_public("Saltelli and Sobol' 1995, a_i = i / 2 - 1 / 2, 15 inputs", *[UNIT] * 15)
def sobol_g_15d(x: Array) -> Array:
    a = 0.5 * np.arange(len(x))[:, None]
    return np.prod((np.abs(4.0 * x - 2.0) + a) / (1.0 + a), axis=0)


@_public("Welch et al. 1992", *[(-0.5, 0.5)] * 20)
def welch(x: Array) -> Array:
    return (
        5.0 * x[11] / (1.0 + x[0])
        + 5.0 * (x[3] - x[19]) ** 2
        + x[4]
        + 40.0 * x[18] ** 3
        - 5.0 * x[18]
        + 0.05 * x[1]
        + 0.08 * x[2]
        - 0.03 * x[5]
        + 0.03 * x[6]
        - 0.09 * x[8]
        - 0.01 * x[9]
        - 0.07 * x[10]
        + 0.25 * x[12] ** 2
        - 0.04 * x[13]
        + 0.06 * x[14]
        - 0.01 * x[16]
        - 0.03 * x[17]
    )


def _solver(solver: Solver, source: str) -> Function:
    """The first output of a textbook solver."""
    low, high = np.array([given.range for given in solver.inputs.values()], dtype=float).T
    names, output = list(solver.inputs), next(iter(solver.outputs))

    def values(u: Array) -> Array:
        given = dict(zip(names, (low + (high - low) * u).T, strict=True))
        return np.asarray(solver(**given)[output], dtype=float)

    return Function(type(solver).__name__.lower(), source, len(names), values)


ALL += [
    _solver(textbook.Ishigami(), "Ishigami and Homma 1990"),
    _solver(textbook.Cantilever(), "Timoshenko 1955"),
    _solver(textbook.OTLCircuit(), "Ben-Ari and Steinberg 2007"),
    _solver(textbook.Piston(), "Kenett and Zacks 1998"),
    _solver(textbook.Borehole(), "Harper and Gupta 1983"),
    _solver(textbook.SobolG(), "Saltelli and Sobol' 1995"),
    _solver(textbook.WingWeight(), "Forrester, Sobester and Keane 2008"),
    _solver(textbook.MorrisFunction(), "Morris 1991"),
]

#: In the order of their numbers of inputs.
FUNCTIONS = tuple(sorted(ALL, key=lambda function: function.inputs))
#: Every third one, on which rules were chosen; the others only judge them.
DEVELOPMENT = FUNCTIONS[1::3]
