"""The choice of a level: extremes, and a race against runs of the truth alone."""

import numpy as np
import pytest

from surrogate.regressors.cokriging import CoKriging
from surrogate.regressors.level_process import LevelRuns
from surrogate.regressors.next_level import choose

GRID = np.linspace(-1, 1, 201)[:, None]


def truth(x):
    return np.sin(5 * x[:, 0]) + 0.3 * x[:, 0]


def cheap(x):
    return 0.6 * np.sin(5 * x[:, 0])


def model(low, high):
    return CoKriging(nugget=1e-8, lower=[LevelRuns(low, cheap(low))]).fit(high, truth(high))


def test_what_is_known_of_one_level_decides():
    """A cheap level with a gap is run; one that is known everywhere is not."""
    gap = np.linspace(-1, 0, 6)[:, None]
    point, level = choose(model(gap, gap[::2]), GRID, [1.0, 100.0])
    assert level == 0 and GRID[point] > 0
    whole = np.linspace(-1, 1, 40)[:, None]
    rough = CoKriging(nugget=1e-8, lower=[LevelRuns(whole, cheap(whole))]).fit(
        whole[::13], truth(whole[::13]) + np.cos(9 * whole[::13, 0])
    )
    assert choose(rough, GRID, [1.0, 1.0])[1] == 1


def test_expensive_truth_is_run_less_than_cheap_truth():
    """Of eight choices, fewer fall on the truth when it costs more."""
    counts = []
    for dear in (1.0, 200.0):
        low = np.linspace(-1, 1, 5)[:, None]
        high, chosen = low[::2], 0
        for _ in range(8):
            point, level = choose(model(low, high), GRID, [1.0, dear])
            low = np.unique(np.vstack([low, GRID[point : point + 1]]), axis=0)
            if level == 1:
                high, chosen = (
                    np.unique(np.vstack([high, GRID[point : point + 1]]), axis=0),
                    chosen + 1,
                )
        counts.append(chosen)
    assert counts[1] <= counts[0]


def test_costs_must_be_positive_and_one_a_level():
    low = np.linspace(-1, 1, 6)[:, None]
    with pytest.raises(ValueError, match="one above 0 for each level"):
        choose(model(low, low[::2]), GRID, [1.0])
