"""Active learning of failure probabilities on the public benchmark, from at most 100 runs.

    python benchmarks/reliability.py [repeats] [problem ..]

Problems: those of the TNO reliability challenge (Rozsas and Slobbe 2019, "Repository and
black-box reliability challenge") as stated by otbenchmark (github.com/mbaudin47/otbenchmark), and
literature problems, from which Moustapha, Marelli and Sudret 2022 (doi
10.1016/j.strusafe.2021.102174, arXiv 2106.01713) took their 20. Each reference is computed here,
by 10 repeats of subset simulation with 100 000 points a level on the true function, and printed
beside the published value.

One setting for all: 12 or 2 d runs of a Latin hypercube over [-3, 3]^d of the standard normal
space, then one at a time where the sign of a Gaussian process is least sure, until
`learning.enough` or 100 runs.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import stats
from scipy.special import ndtr
from scipy.stats import qmc

from surrogate.regressors.gaussian_process import GaussianProcess
from surrogate.reliability.learning import candidates, enough, known, next_points
from surrogate.reliability.limit_state import LimitState
from surrogate.reliability.subset import subset

Array = NDArray[np.float64]

#: Runs at most, runs of the first design at least, and half-width of its box.
RUNS, FIRST, BOX = 100, 12, 3.0
#: Standard normal coordinates are coded as u / REACH.
REACH = 8.0
ALLOWED = 0.2


@dataclass(frozen=True)
class Problem:
    """A limit state in standard normal space, and the published probability."""

    name: str
    size: int
    g: Callable[[Array], Array]
    published: float


def normal(u: Array, mean: list[float], std: list[float]) -> Array:
    """Columns (d, m) of normal inputs."""
    return (np.array(mean) + np.array(std) * u).T


def lognormal(u: Array, mean: list[float], std: list[float]) -> Array:
    """Columns (d, m) of lognormal inputs with these means and standard deviations."""
    m, s = np.array(mean), np.array(std)
    width = np.sqrt(np.log1p((s / m) ** 2))
    return np.exp(np.log(m) - width**2 / 2.0 + width * u).T


def rp8(u: Array) -> Array:
    x = lognormal(u, [120.0] * 4 + [50.0, 40.0], [12.0] * 4 + [10.0, 8.0])
    return x[0] + 2 * x[1] + 2 * x[2] + x[3] - 5 * x[4] - 5 * x[5]


def rp14(u: Array) -> Array:
    x1 = 70.0 + 10.0 * ndtr(u[:, 0])
    x2, x4, x5 = normal(u[:, [1, 3, 4]], [39.0, 400.0, 250e3], [0.1, 0.1, 35e3])
    scale = 350.0 * np.sqrt(6.0) / np.pi
    x3 = 1500.0 - np.euler_gamma * scale - scale * np.log(-stats.norm.logcdf(u[:, 2]))
    return x1 - 32.0 / (np.pi * x2**3) * np.sqrt(x3**2 * x4**2 / 16.0 + x5**2)


def rp24(u: Array) -> Array:
    x, y = normal(u, [10.0] * 2, [3.0] * 2)
    return 2.5 - 0.2357 * (x - y) + 0.00463 * (x + y - 20.0) ** 4


def rp28(u: Array) -> Array:
    x, y = normal(u, [78064.0, 0.0104], [11710.0, 0.00156])
    return x * y - 146.14


def rp33(u: Array) -> Array:
    return np.minimum(3.0 * np.sqrt(3.0) - u.sum(axis=1), 3.0 - u[:, 2])


def rp35(u: Array) -> Array:
    x, y = u.T
    return np.minimum(2.0 - y + np.exp(-0.1 * x**2) + (0.2 * x) ** 4, 4.5 - x * y)


def rp38(u: Array) -> Array:
    mean = [350.0, 50.8, 3.81, 173.0, 9.38, 33.1, 0.036]
    a, b, c, d, e, f, h = normal(u, mean, [0.1 * one for one in mean])
    top = d**2 - 4 * e * f * h**2 + d * (f + 4 * e + 2 * f * h)
    return 15.59e4 - a * b**3 / (2 * c**3) * top / (d * e * (d + f + 2 * f * h))


def rp53(u: Array) -> Array:
    x, y = normal(u, [1.5, 2.5], [1.0, 1.0])
    return np.sin(2.5 * x) + 2.0 - (x**2 + 4.0) * (y - 1.0) / 20.0


def rp54(u: Array) -> Array:
    return -stats.norm.logsf(u).sum(axis=1) - 8.951


def rp55(u: Array) -> Array:
    x, y = (2.0 * ndtr(u) - 1.0).T
    bend, apart = 0.2 + 0.6 * (x - y) ** 4, (x - y) / np.sqrt(2.0)
    far = 5.0 / np.sqrt(2.0) - 2.2
    return np.minimum.reduce([bend - apart, bend + apart, x - y + far, y - x + far])


def rp57(u: Array) -> Array:
    x, y = u.T
    both = np.maximum(-(x**2) + y**3 + 3.0, 2.0 - x - 8.0 * y)
    return np.minimum(both, (x + 3.0) ** 2 + (y + 3.0) ** 2 - 4.0)


def rp60(u: Array) -> Array:
    a, b, c, d, load = lognormal(
        u, [2200.0, 2100.0, 2300.0, 2000.0, 1200.0], [220.0, 210.0, 230.0, 200.0, 480.0]
    )
    half = np.minimum.reduce([b, c, d]) - load / 2.0
    whole = np.maximum(d - load, np.minimum(b, c) - load)
    return np.minimum(a - load, np.maximum(half, whole))


def rp110(u: Array) -> Array:
    x, y = u.T
    first = np.where(x <= 3.5, 0.85 - 0.1 * x, 4.0 - x)
    return np.minimum(first, np.where(y <= 2.0, 2.3 - y, 0.5 - 0.1 * y))


def four_branch(u: Array) -> Array:
    x, y = u.T
    bend, total = 3.0 + 0.1 * (x - y) ** 2, (x + y) / np.sqrt(2.0)
    far = 7.0 / np.sqrt(2.0)
    return np.minimum.reduce([bend - total, bend + total, x - y + far, y - x + far])


def hat(u: Array) -> Array:
    """Schöbi, Sudret and Marelli 2017, doi 10.1061/AJRUA6.0000870."""
    x, y = normal(u, [0.25, 0.25], [1.0, 1.0])
    return 20.0 - (x - y) ** 2 - 8.0 * (x + y - 4.0) ** 3


PROBLEMS = (
    Problem("RP8", 6, rp8, 7.898e-4),
    Problem("RP14", 5, rp14, 7.7285e-4),
    Problem(
        "RP22",
        2,
        lambda u: 2.5 - u.sum(axis=1) / np.sqrt(2.0) + 0.1 * (u[:, 0] - u[:, 1]) ** 2,
        4.207e-3,
    ),
    Problem("RP24", 2, rp24, 2.86e-3),
    Problem(
        "RP25",
        2,
        lambda u: np.maximum(u[:, 0] ** 2 - 8 * u[:, 1] + 16, -16 * u[:, 0] + u[:, 1] + 32),
        4.1486e-5,
    ),
    Problem("RP28", 2, rp28, 1.453e-7),
    Problem("RP31", 2, lambda u: 2.0 - u[:, 1] + 256.0 * u[:, 0] ** 4, 3.2267e-3),
    Problem("RP33", 3, rp33, 2.57e-3),
    Problem("RP35", 2, rp35, 3.479e-3),
    Problem("RP38", 7, rp38, 8.1e-3),
    Problem("RP53", 2, rp53, 3.13e-2),
    Problem("RP54", 20, rp54, 9.98e-4),
    Problem("RP55", 2, rp55, 0.56),
    Problem("RP57", 2, rp57, 2.84e-2),
    Problem("RP60", 5, rp60, 4.56e-2),
    Problem("RP63", 100, lambda u: 0.1 * (u[:, 1:] ** 2).sum(1) - u[:, 0] - 4.5, 3.79e-4),
    Problem("RP75", 2, lambda u: 3.0 - u[:, 0] * u[:, 1], 9.819e-3),
    Problem("RP107", 10, lambda u: 5.0 * np.sqrt(10.0) - u.sum(axis=1), 2.92e-7),
    Problem("RP110", 2, rp110, 3.19e-5),
    Problem("RP111", 2, lambda u: 12.5 - np.abs(u[:, 0] * u[:, 1]), 7.65e-7),
    Problem("four branches", 2, four_branch, 2.2228e-3),
    Problem("hat", 2, hat, 4.4e-4),
)


def learnt(problem: Problem, seed: int) -> tuple[float, int, bool]:
    """Probability from at most `RUNS` runs, the runs, and whether learning ended by itself."""
    first = min(max(FIRST, 2 * problem.size), RUNS - 1)
    u = BOX * (2.0 * qmc.LatinHypercube(problem.size, seed=seed).random(first) - 1.0)
    g = problem.g(u)
    history = []
    while True:
        process = GaussianProcess(nugget=1e-8, seed=seed).fit(u / REACH, g)

        def told(points: Array, process: GaussianProcess = process) -> tuple[Array, Array]:
            return process.predict(points / REACH, return_std=True)

        points = candidates(told, problem.size, samples=2000, seed=seed + len(u))
        history.append(known(told, points))
        if enough(history) or len(u) >= RUNS:
            break
        new = next_points(told, points)
        u, g = np.vstack([u, new]), np.append(g, problem.g(new))
    state = LimitState(problem.size, lambda points: process.predict(points / REACH))
    return subset(state, samples=4000, seed=seed).probability, len(u), enough(history)


def main() -> None:
    repeats = int(sys.argv[1]) if len(sys.argv) > 1 else 3
    wanted = sys.argv[2:]
    columns = "problem          d  published  reference       ours  runs  error  within 20 %"
    print(columns, flush=True)
    met = []
    for problem in PROBLEMS:
        if wanted and problem.name not in wanted:
            continue
        start = time.process_time()
        state = LimitState(problem.size, problem.g)
        reference = subset(state, samples=min(100_000, 2_000_000 // problem.size)).probability
        found = [learnt(problem, seed) for seed in range(repeats)]
        ours = float(np.median([one[0] for one in found]))
        runs = float(np.median([one[1] for one in found]))
        error = ours / reference - 1.0
        met.append(abs(error) <= ALLOWED)
        print(
            f"{problem.name:14} {problem.size:3} {problem.published:10.3e} {reference:10.3e} "
            f"{ours:10.3e} {runs:5.0f} {error:+6.1%}  {'yes' if met[-1] else 'no':3} "
            f"({time.process_time() - start:.0f} s)",
            flush=True,
        )
    print(f"{sum(met)} of {len(met)} problems within 20 %")


if __name__ == "__main__":
    main()
