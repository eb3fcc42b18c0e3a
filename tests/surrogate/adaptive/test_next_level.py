"""The choice of a level: extremes, and a race against runs of the truth alone."""

from copy import copy

import numpy as np
import pytest

from surrogate.adaptive.aim import ACCURACY, Aim, Level, Rule, Until
from surrogate.adaptive.answers import Answers
from surrogate.adaptive.by_seconds import neglected
from surrogate.adaptive.next_level import choose, gains
from surrogate.regressors.cokriging import CoKriging
from surrogate.regressors.level_process import LevelRuns

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
    point, level = choose([model(gap, gap[::2]).levels_], GRID, GRID, [1.0, 100.0])
    assert level == 0 and GRID[point] > 0
    whole = np.linspace(-1, 1, 40)[:, None]
    rough = CoKriging(nugget=1e-8, lower=[LevelRuns(whole, cheap(whole))]).fit(
        whole[::13], truth(whole[::13]) + np.cos(9 * whole[::13, 0])
    )
    assert choose([rough.levels_], GRID, GRID, [1.0, 1.0])[1] == 1


def test_expensive_truth_is_run_less_than_cheap_truth():
    """Of eight choices, fewer fall on the truth when it costs more."""
    counts = []
    for dear in (1.0, 200.0):
        low = np.linspace(-1, 1, 5)[:, None]
        high, chosen = low[::2], 0
        for _ in range(8):
            point, level = choose([model(low, high).levels_], GRID, GRID, [1.0, dear])
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
        choose([model(low, low[::2]).levels_], GRID, GRID, [1.0])


def test_what_is_taken_is_what_the_variance_falls_by():
    """A run of both levels at a point, lengths kept, against the closed form."""
    low = np.linspace(-1, 1, 7)[:, None]
    one = model(low, low[::2])
    X = np.array([[0.47]])
    told = gains(one.levels_, X, GRID)
    before = one.variance_of_levels(GRID).mean(axis=0)
    lower, upper = one.levels_
    below = copy(lower).condition(np.vstack([low, X]), np.append(cheap(low), 0.6), lower.logs_)
    below.variance_ = lower.variance_
    rho, spread = upper.rho(GRID)
    factor = (upper.scale_ / lower.scale_) ** 2 * (rho**2 + spread)
    fallen = (factor * (lower.parts(GRID)[0] - below.parts(GRID)[0])).mean()
    assert told[0, 0] == pytest.approx(fallen, rel=1e-6)
    above = copy(upper).condition(
        np.vstack([low[::2], X]), np.append(truth(low[::2]), 0.7), upper.logs_
    )
    above.variance_ = upper.variance_
    assert told[0, 1] == pytest.approx(before[1] - above.parts(GRID)[-1].mean(), rel=1e-6)


def test_a_level_that_is_done_costs_nothing_and_what_is_too_dear_is_not_chosen():
    low = np.linspace(-1, 1, 9)[:, None]
    one = model(low, low[::4])
    done = np.column_stack([np.ones(len(low), dtype=bool), np.arange(len(low)) % 4 == 0])
    point, level = choose([one.levels_], low, GRID, [1.0, 10.0], done=done)
    assert level == 1 and point % 4
    assert choose([one.levels_], low, GRID, [1.0, 10.0], done=done, left=9.0) is None
    assert choose([one.levels_], GRID, GRID, [1.0, 10.0], left=9.0)[1] == 0


def test_a_truth_with_few_runs_is_run_next_whatever_its_process_says():
    """While twice the square of its runs is less than the runs of the cheap level."""
    levels = (Level("cheap", (0,), 1.0), Level("true", (0,), 10.0))
    rule = Rule(Aim(ACCURACY, ("y",)), Until(None, "q2", seconds=1e9), levels=levels)

    def lacks(cheap, true):
        named = np.repeat(("cheap", "true"), (cheap, true))
        none = np.zeros(len(named), dtype=bool)
        return neglected(rule, Answers(np.zeros((len(named), 1)), none, none, {}, named))

    assert [lacks(cheap, 3) for cheap in (9, 18, 19, 100)] == [0, 0, 1, 1]
    assert lacks(100, 8) == 0
