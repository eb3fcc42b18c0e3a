"""Maximin Latin hypercubes against SMT's, pyDOE3's and SciPy's, and how evenly they fill.

    OMP_NUM_THREADS=1 python benchmarks/designs.py [--seeds 5]

For each size: the smallest distance between two points in the unit cube (larger is
better), the centred discrepancy (smaller is better) and the processor time, means over
seeds. SMT's `LHS(criterion="ese")` (Jin, Chen and Sudjianto 2005), where it is installed,
takes its own time; ours is shown with ten times its usual effort too. Up to 200 runs the
others get the time that ours took, restarted until it is used up, and keep their best:
pyDOE3 `lhs(criterion="maximin")` as it comes (best of five draws) and restarted; SciPy
`LatinHypercube`, plain, `optimization="random-cd"` and, up to five parameters, `"lloyd"`
(its Voronoi cells take hours in ten dimensions). About two minutes.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable

import numpy as np
import pyDOE3
from scipy.spatial.distance import pdist
from scipy.stats import qmc

from surrogate.designs.latin_hypercube import latin_hypercube
from surrogate.space.distributions import uniform
from surrogate.space.space import Parameter, Space

try:
    from smt.sampling_methods import LHS
except ImportError:  # then it is left out
    LHS = None

SIZES = [(10, 2), (20, 3), (20, 7), (50, 5), (100, 7), (200, 10), (1000, 7)]


def ours(runs: int, size: int, seed: int, effort: float = 1.0) -> np.ndarray:
    """This package's maximin design in the unit cube."""
    space = Space(tuple(Parameter(f"x{i}", uniform(0.0, 1.0)) for i in range(size)))
    return (latin_hypercube(space, runs=runs, seed=seed, effort=effort) + 1.0) / 2.0


def thorough(runs: int, size: int, seed: int) -> np.ndarray:
    """This package's maximin design with ten times the usual effort."""
    return ours(runs, size, seed, effort=10.0)


def smts(runs: int, size: int, seed: int) -> np.ndarray:
    """SMT's design by enhanced stochastic evolution."""
    limits = np.tile([0.0, 1.0], (size, 1))
    return LHS(xlimits=limits, criterion="ese", seed=seed)(runs)


def pydoe(runs: int, size: int, rng: np.random.Generator) -> np.ndarray:
    """pyDOE3's maximin: the best of five draws."""
    return pyDOE3.lhs(size, samples=runs, criterion="maximin", seed=int(rng.integers(2**31)))


def scipys(optimization: str | None) -> Callable[..., np.ndarray]:
    """SciPy's Latin hypercube with one of its optimisations."""

    def draw(runs: int, size: int, rng: np.random.Generator) -> np.ndarray:
        return qmc.LatinHypercube(size, optimization=optimization, seed=rng).random(runs)

    return draw


def best_within(
    draw: Callable[..., np.ndarray], runs: int, size: int, seconds: float, seed: int
) -> np.ndarray:
    """The draw of largest smallest distance; at least one draw, however long it takes."""
    rng = np.random.default_rng(seed)
    end = time.process_time() + seconds
    best = draw(runs, size, rng)
    while time.process_time() < end:
        other = draw(runs, size, rng)
        if pdist(other).min() > pdist(best).min():
            best = other
    return best


RIVALS = {
    "pyDOE3, best of five": (pydoe, False),
    "pyDOE3, equal time": (pydoe, True),
    "SciPy plain, equal time": (scipys(None), True),
    "SciPy lloyd, equal time": (scipys("lloyd"), True),
    "SciPy random-cd, equal time": (scipys("random-cd"), True),
}


def compare(runs: int, size: int, seeds: int) -> None:
    """Print a block for one size."""
    makers = {"this package": ours, "this package, effort 10": thorough}
    makers |= {"SMT, ese": smts} if LHS else {}
    found: dict[str, list[np.ndarray]] = {}
    spent: dict[str, list[float]] = {}
    for seed in range(seeds):
        for name, maker in makers.items():
            start = time.process_time()
            found.setdefault(name, []).append(maker(runs, size, seed))
            spent.setdefault(name, []).append(time.process_time() - start)
        for name, (draw, equal) in rivals(runs, size).items():
            seconds = spent["this package"][-1] if equal else 0.0
            start = time.process_time()
            found.setdefault(name, []).append(best_within(draw, runs, size, seconds, seed))
            spent.setdefault(name, []).append(time.process_time() - start)
    print(f"\n{runs} runs, {size} parameters", flush=True)
    for name, designs in found.items():
        distance = np.mean([pdist(u).min() for u in designs])
        discrepancy = np.mean([qmc.discrepancy(np.clip(u, 0.0, 1.0)) for u in designs])
        print(
            f"  {name:29s} distance {distance:.4f}   discrepancy {discrepancy:.4f}"
            f"   {np.mean(spent[name]):6.2f} s"
        )


def rivals(runs: int, size: int) -> dict[str, tuple[Callable[..., np.ndarray], bool]]:
    """The others that are quick enough at this size."""
    return {
        name: rival
        for name, rival in RIVALS.items()
        if runs <= 200 and ("lloyd" not in name or size <= 5)
    }


def main() -> None:
    """Compare at every size."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--seeds", type=int, default=5)
    seeds = parser.parse_args().seeds
    for runs, size in SIZES:
        compare(runs, size, seeds)


if __name__ == "__main__":
    main()
