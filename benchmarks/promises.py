"""Are promises kept? Stated probabilities of `solve` beside what the solver says.

    python benchmarks/promises.py                    200 promises of a Gaussian process
    python benchmarks/promises.py --each 50 --surrogate chaos

Eight functions of the literature stand for the solver. Each promise has its own training design
(a Latin hypercube of five runs an input, at least 20 and ten more than the surrogate needs), limit
and probability: a linear cost of the inputs is minimised such that the output stays below a limit
with probability p, p between 0.5 and 0.95. The limit is active at the answer, so the search goes
where the surrogate errs on the pleasant side: a hard case. A promise is kept when the function
meets the limit at the first candidate. If stated probabilities are true, the number of promises
kept lies in the central 99 % of the sum of Bernoulli variables with these probabilities (normal
approximation with continuity correction).
"""

from __future__ import annotations

import argparse
import math
import os
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass

import numpy as np
from scipy import stats
from scipy.stats import qmc

from surrogate.fitting.fit import fit, minimum_runs
from surrogate.regressors.chaos import PolynomialChaos
from surrogate.regressors.gaussian_process import GaussianProcess
from surrogate.regressors.polynomial import Linear, Quadratic
from surrogate.solving.goals import Objective
from surrogate.solving.problem import Problem
from surrogate.solving.solve import solve
from surrogate.space.constraint_text import parse
from surrogate.space.distributions import uniform
from surrogate.space.space import Parameter, Space
from surrogate_solvers import textbook

SURROGATES = {"gp": GaussianProcess, "chaos": PolynomialChaos, "quadratic": Quadratic}


def branin(x: np.ndarray) -> np.ndarray:
    """Branin (1972), on its usual domain."""
    a, b = 7.5 * x[:, 0] + 2.5, 7.5 * x[:, 1] + 7.5
    bowl = (b - 5.1 / (4 * math.pi**2) * a**2 + 5 / math.pi * a - 6) ** 2
    return bowl + 10 * (1 - 1 / (8 * math.pi)) * np.cos(a) + 10


def friedman(x: np.ndarray) -> np.ndarray:
    """Friedman (1991), five inputs."""
    u = (x + 1) / 2
    wave = 10 * np.sin(math.pi * u[:, 0] * u[:, 1])
    return wave + 20 * (u[:, 2] - 0.5) ** 2 + 10 * u[:, 3] + 5 * u[:, 4]


def of_textbook(solver):
    space = Space(tuple(Parameter(n, uniform(*i.range)) for n, i in solver.inputs.items()))

    def evaluated(x: np.ndarray) -> np.ndarray:
        (values,) = solver(**space.decode(x)).values()
        return np.asarray(values)

    return space.size, evaluated


FUNCTIONS = {
    "branin": (2, branin),
    "ishigami": of_textbook(textbook.Ishigami()),
    "friedman": (5, friedman),
    "otl circuit": of_textbook(textbook.OTLCircuit()),
    "piston": of_textbook(textbook.Piston()),
    "borehole": of_textbook(textbook.Borehole()),
    "wing weight": of_textbook(textbook.WingWeight()),
    "linear": (6, lambda x: x @ np.arange(1.0, 7.0)),
}


@dataclass(frozen=True)
class Promise:
    """A stated probability, and whether it was kept."""

    function: str
    stated: float
    kept: bool


def promise(name: str, surrogate: str, seed: int) -> Promise | None:
    """One promise; None where the surrogate sees no way to keep the limit so surely."""
    size, function = FUNCTIONS[name]
    rng = np.random.default_rng([seed, size])
    space = Space(tuple(Parameter(f"x{k}", uniform(-1.0, 1.0)) for k in range(size)))
    estimator = SURROGATES[surrogate]()
    runs = max(20, 5 * size, minimum_runs(estimator, space) + 10)
    coded = 2.0 * qmc.LatinHypercube(size, seed=seed).random(runs) - 1.0
    weights = rng.standard_normal(size)
    fits = {
        "y": fit(space, coded, function(coded), estimator, output="y"),
        "cost": fit(space, coded, coded @ weights, Linear(), output="cost"),
    }
    everywhere = function(2.0 * rng.random((2000, size)) - 1.0)
    limit = np.quantile(everywhere, rng.uniform(0.1, 0.6))
    asked = rng.uniform(0.5, 0.95)
    stated = parse(f"y <= {limit:.9g}" if limit >= 0 else f"y <= -{-limit:.9g}", {"y": ""})
    problem = Problem(
        "p", (Objective("cost"),), (stated,), space.names, probability=asked, candidates=1
    )
    best = solve(problem, space, fits, seed=seed).candidates[0]
    if best.probability < asked - 0.05:
        return None
    at = space.encode({name: [value] for name, value in best.inputs.items()})
    return Promise(name, best.probability, bool(function(at)[0] <= limit))


def _one(given: tuple[str, str, int]) -> Promise | None:
    return promise(*given)


def main() -> None:
    """Print kept beside stated, for each function and together."""
    words = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    words.add_argument("--each", type=int, default=25, help="promises of each function")
    words.add_argument("--surrogate", choices=SURROGATES, default="gp")
    words.add_argument("--workers", type=int, default=os.cpu_count())
    words.add_argument("--seed", type=int, default=1)
    asked = words.parse_args()
    todo = [
        (name, asked.surrogate, asked.seed + k) for name in FUNCTIONS for k in range(asked.each)
    ]
    with ProcessPoolExecutor(asked.workers) as pool:
        found = [one for one in pool.map(_one, todo) if one is not None]
    print(f"{'function':12}  promises  stated    kept")
    for name in FUNCTIONS:
        own = [one for one in found if one.function == name]
        if own:
            p = np.array([one.stated for one in own])
            kept = sum(one.kept for one in own)
            print(f"{name:12}  {len(own):8d}  {p.mean():6.3f}  {kept / len(own):6.3f}")
    p = np.array([one.stated for one in found])
    kept, mean = sum(one.kept for one in found), p.sum()
    half = stats.norm.ppf(0.995) * math.sqrt((p * (1 - p)).sum()) + 0.5
    verdict = "inside" if abs(kept - mean) <= half else "OUTSIDE"
    print(
        f"together: {kept} of {len(found)} kept, {mean:.1f} stated; {verdict} the central 99 % "
        f"({mean - half:.1f} to {mean + half:.1f})"
    )


if __name__ == "__main__":
    main()
