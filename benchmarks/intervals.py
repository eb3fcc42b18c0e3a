"""Prediction intervals at 95 %: how many new runs they hold, and how wide they are.

    python benchmarks/intervals.py --regressors gaussian_process --runs 10 20 40 80 160 300

Of each regressor and number of runs, over functions of `public_functions` (1 to 20 inputs) and
random Latin hypercubes: the mean coverage; the lowest coverage of a function, and which; the
median width over that of the smallest honest interval of constant width about the same
prediction, whose half is the 95 % quantile of the errors at the test points.

All 40 functions, two designs each, Gaussian process (the lowest coverage is of two designs):

    runs   coverage   lowest   width
      10      0.945     0.72    1.34
      20      0.952     0.74    1.20
      40      0.954     0.80    1.07
      80      0.967     0.89    1.00
     160      0.972     0.91    1.19

Rules were chosen on every third function (`--functions development`), before the others were
looked at (`--functions others`).
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator

import numpy as np
from public_functions import DEVELOPMENT, FUNCTIONS, Function
from scipy.stats import qmc
from sklearn.ensemble import RandomForestRegressor

from surrogate.fitting.fit import fit, minimum_runs
from surrogate.regressors.chaos import PolynomialChaos
from surrogate.regressors.gaussian_process import GaussianProcess
from surrogate.regressors.polynomial import Interactions, Linear, Quadratic
from surrogate.regressors.selection import Lasso, Stepwise
from surrogate.space.distributions import uniform
from surrogate.space.space import Parameter, Space

REGRESSORS = {
    "gaussian_process": GaussianProcess(),
    "linear": Linear(),
    "interactions": Interactions(),
    "quadratic": Quadratic(),
    "stepwise": Stepwise("linear"),
    "lasso": Lasso(),
    "polynomial_chaos": PolynomialChaos(),
    "forest": RandomForestRegressor(50, random_state=0),
}
GROUPS = {
    "all": FUNCTIONS,
    "development": DEVELOPMENT,
    "others": tuple(one for one in FUNCTIONS if one not in DEVELOPMENT),
}
TEST_POINTS = 512


def judged(function: Function, name: str, runs: int, repeats: int) -> Iterator[tuple[float, float]]:
    """Coverage and relative width of each design that the regressor can be fitted to."""
    space = Space(tuple(Parameter(f"x{i}", uniform(-1, 1)) for i in range(function.inputs)))
    if runs < minimum_runs(REGRESSORS[name], space) + 1:
        return
    test = qmc.Sobol(function.inputs, seed=9).random(TEST_POINTS)
    truth = function.values(test)
    for seed in range(repeats):
        points = qmc.LatinHypercube(function.inputs, seed=1000 * runs + seed).random(runs)
        found = fit(space, 2.0 * points - 1.0, function.values(points), REGRESSORS[name])
        mean, (half,) = found.half_widths(2.0 * test - 1.0, (0.95,))
        errors = np.abs(truth - mean)
        honest = max(float(np.quantile(errors, 0.95)), 1e-12 * float(truth.std()))
        yield float((errors <= half + 1e-12 * truth.std()).mean()), float(np.mean(half)) / honest


def table(name: str, sizes: list[int], repeats: int, functions: tuple[Function, ...]) -> None:
    """A line for each number of runs."""
    for runs in sizes:
        every = {one.name: list(judged(one, name, runs, repeats)) for one in functions}
        coverage = {key: np.mean(rows, axis=0)[0] for key, rows in every.items() if rows}
        if not coverage:
            continue
        width = np.median([row[1] for rows in every.values() for row in rows])
        worst = min(coverage, key=lambda key: coverage[key])
        print(
            f"{name:17} {runs:4d} {len(coverage):9d} {np.mean(list(coverage.values())):9.3f} "
            f"{coverage[worst]:7.2f} {width:6.2f}  {worst}",
            flush=True,
        )


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--regressors", nargs="+", choices=REGRESSORS, default=list(REGRESSORS))
    parser.add_argument("--runs", type=int, nargs="+", default=[10, 20, 40, 80, 160, 300])
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--functions", choices=GROUPS, default="all")
    given = parser.parse_args()
    print(f"{'regressor':17} {'runs':>4} functions  coverage  lowest  width  of")
    for name in given.regressors:
        table(name, given.runs, given.repeats, GROUPS[given.functions])


if __name__ == "__main__":
    main()
