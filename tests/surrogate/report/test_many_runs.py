"""A page of many runs draws and lists some of them, and says so."""

import numpy as np
from made_up import runs_dataset

from surrogate.report import Content, build
from surrogate.report.content import MOST_RUNS, thinned
from surrogate.space.distributions import uniform
from surrogate.space.space import Parameter, Space


def test_few_runs_are_all_shown_and_many_are_thinned_evenly():
    assert thinned(MOST_RUNS).all()
    shown = np.flatnonzero(thinned(10 * MOST_RUNS))
    assert len(shown) == MOST_RUNS
    assert np.diff(shown).max() <= 11


def test_failed_runs_come_first_and_take_half_of_the_room():
    count = 10 * MOST_RUNS
    failed = np.zeros(count, dtype=bool)
    failed[:30] = True
    assert thinned(count, failed)[:30].all()
    failed[: count // 2] = True
    shown = thinned(count, failed)
    assert shown.sum() == MOST_RUNS and shown[failed].sum() >= MOST_RUNS // 2


def test_a_page_of_many_runs_is_made_and_says_what_it_leaves_out():
    space = Space((Parameter("a", uniform(0.0, 1.0)), Parameter("b", uniform(0.0, 1.0))))
    coded = space.sample(3 * MOST_RUNS, seed=1)
    runs = runs_dataset(space, {"train": coded}, {"y": (lambda x: x[:, 0], (), "")}, {})
    page = build(Content("many", space, runs)).html
    assert f"{MOST_RUNS} of {len(coded)} runs are drawn" in page
    assert f"{MOST_RUNS} of {len(coded)} runs; runs.nc has all" in page
    assert page.count("<tr>") < 2 * MOST_RUNS + 100  # of the runs, and behind the figure
