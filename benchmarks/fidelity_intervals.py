"""Intervals of co-kriging at 95 %: how many new runs of the truth they hold, and how wide they are.

    python benchmarks/fidelity_intervals.py [pair ...]

Of each pair of `fidelity_pairs` and number n of true runs, of random Latin hypercubes, nested in
5 n cheap ones: the mean coverage of 512 new points over designs, and the median of the mean width
over that of the smallest honest interval of constant width, whose half is the 95 % quantile of
the errors at the new points. Beside it the same with deviations as the likelihood has them, not
widened by what left-out runs show.

                              left-out errors   likelihood alone
    pair, true + cheap runs  coverage  width    coverage  width
    forrester     4 +  20       1.000   8.70       1.000   6.70
    forrester     6 +  30       0.992   3.10       0.992   3.10
    forrester     8 +  40       0.997   4.12       0.997   4.12
    currin        6 +  30       0.970   1.59       0.872   0.72
    currin        9 +  45       0.913   0.63       0.801   0.26
    currin       12 +  60       0.908   1.10       0.783   0.33
    branin        6 +  30       1.000   6.19       0.941   0.92
    branin        9 +  45       0.975   1.96       0.902   0.64
    branin       12 +  60       0.987   1.12       0.942   0.75
    himmelblau    6 +  30       0.971   1.35       0.811   0.73
    himmelblau    9 +  45       0.921   0.97       0.736   0.43
    himmelblau   12 +  60       0.969   0.96       0.801   0.44
    camel         6 +  30       0.882   0.74       0.677   0.26
    camel         9 +  45       0.961   0.83       0.817   0.49
    camel        12 +  60       0.946   0.88       0.844   0.56
    park         10 +  50       0.861   1.08       0.812   0.72
    park         15 +  75       1.000   1.68       0.978   0.92
    park         20 + 100       0.928   1.00       0.910   0.82
    park_2       10 +  50       0.986   1.06       0.979   0.94
    park_2       15 +  75       0.990   1.14       0.990   1.14
    park_2       20 + 100       0.994   1.22       0.994   1.22
    hartmann     14 +  70       0.966   1.31       0.913   0.85
    hartmann     21 + 105       0.957   1.13       0.884   0.75
    hartmann     28 + 140       0.936   1.01       0.877   0.71
    borehole     18 +  90       0.957   0.94       0.946   0.82
    borehole     27 + 135       0.947   0.89       0.929   0.76
    borehole     36 + 180       0.940   0.91       0.920   0.76
    mean                        0.958   1.76       0.891   1.14
    lowest pair                 0.930   0.82       0.779   0.44
"""

from __future__ import annotations

import sys

import numpy as np
from fidelity_pairs import PAIRS, Array, Pair, scattered
from scipy.stats import qmc

from surrogate.fitting.fit import Fit, fit
from surrogate.regressors.cokriging import CoKriging
from surrogate.regressors.level_process import LevelRuns
from surrogate.space.distributions import uniform
from surrogate.space.space import Parameter, Space

CHEAP, SEEDS, TEST_POINTS = 5, 8, 512


def sizes(pair: Pair) -> tuple[int, int, int]:
    """Numbers of true runs: two for each input and two more; one and a half and twice as many."""
    least = 2 * pair.inputs + 2
    return least, least * 3 // 2, least * 2


def judged(pair: Pair, runs: int, seed: int) -> list[float]:
    """Coverage and relative width with one design; then both with widenings of 1."""
    space = Space(tuple(Parameter(f"x{j}", uniform(0, 1)) for j in range(pair.inputs)))
    x, t = scattered(pair.inputs, runs, CHEAP * runs, seed)
    model = CoKriging(lower=[LevelRuns(x, pair.values(pair.cheap, x))])
    found = fit(space, t, pair.values(pair.true, t), model)
    new = 2.0 * qmc.Sobol(pair.inputs, seed=9).random(TEST_POINTS) - 1.0
    truth = pair.values(pair.true, new)
    wide = _of_intervals(found, new, truth)
    fitted = found.estimator
    assert isinstance(fitted, CoKriging)
    for level in fitted.levels_:
        level.widening_ = 1.0
    return [*wide, *_of_intervals(found, new, truth)]


def _of_intervals(found: Fit, new: Array, truth: Array) -> tuple[float, float]:
    mean, (half,) = found.half_widths(new, (0.95,))
    errors, slack = np.abs(truth - mean), 1e-9 * float(truth.std())
    honest = max(float(np.quantile(errors, 0.95)), slack)
    return float((errors <= half + slack).mean()), float(np.mean(half)) / honest


def line(label: str, row: Array) -> str:
    """A line of the table: coverage and width, widened, then not."""
    wide, width, bare, narrow = row
    return f"{label:23} {wide:9.3f} {width:6.2f}   {bare:9.3f} {narrow:6.2f}"


def main() -> None:
    """Print the table."""
    print(f"{'':23}   left-out errors   likelihood alone")
    print(f"{'pair, true + cheap runs':23}  coverage  width    coverage  width")
    table, pairs = [], []
    for name in sys.argv[1:] or PAIRS:
        pair = PAIRS[name]
        for runs in sizes(pair):
            rows = np.array([judged(pair, runs, seed) for seed in range(SEEDS)])
            row = np.where([True, False] * 2, rows.mean(axis=0), np.median(rows, axis=0))
            table.append(row)
            print(line(f"{name:11} {runs:3d} + {CHEAP * runs:3d}", row), flush=True)
        pairs.append(np.mean(table[-3:], axis=0))
    print(line("mean", np.mean(table, axis=0)))
    print(line("lowest pair", np.min(pairs, axis=0)))


if __name__ == "__main__":
    main()
