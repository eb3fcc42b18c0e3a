"""The time left that is shown, against what is really left of schedules made up here."""

import heapq
from collections.abc import Callable

import numpy as np
import pytest

from surrogate.execution.progress import Progress, Tally
from surrogate.runs.record import Record
from surrogate.runs.time_left import time_left

RUNS = 200
#: Seconds of `n` runs, in the order in which they begin.
KINDS: dict[str, Callable[[np.random.Generator, int], np.ndarray]] = {
    "constant": lambda _, n: np.full(n, 60.0),
    "lognormal": lambda rng, n: 60.0 * rng.lognormal(0.0, 0.5, n),
    "increasing": lambda rng, n: 60.0 * (1.0 + 2.0 * np.arange(n) / n),
    "increasing with scatter": lambda rng, n: (
        60.0 * (1.0 + 2.0 * np.arange(n) / n) * rng.lognormal(0.0, 0.1, n)
    ),
    "every fifth fails at once": lambda _, n: np.where(np.arange(n) % 5 == 3, 1.0, 60.0),
}


def record(seconds, finished=0.0, status="ok"):
    return Record("", {}, status, "", seconds, 1, finished)


def shown(seconds, places, earlier=(), start=0.0, wait=0.0):
    """(really left, estimate) after each run on `places`, each begun when a place is free.

    earlier: of runs that the journal has. wait: seconds between two runs of a place.
    """
    now, total = [start], len(seconds) + len(earlier)
    tally = Tally(Progress(total), places, lambda _: None, clock=lambda: now[0])
    tally.start([record(one, end) for one, end in zip(earlier, np.cumsum(earlier), strict=True)])
    moments, waiting = [(start, tally.now.seconds_left)], list(seconds)[::-1]
    running = []

    def begin(moment):
        if waiting:
            took = waiting.pop()
            heapq.heappush(running, (moment + took, took))

    for _ in range(places):
        begin(start)
    while running:
        now[0], took = heapq.heappop(running)
        tally.add(record(took))
        moments.append((now[0], tally.now.seconds_left))
        begin(now[0] + wait)
    end = now[0]
    return [(end - moment, estimate) for moment, estimate in moments]


def errors(pairs, whole):
    """Relative errors of the estimates after the first tenth of the work and before the end."""
    return np.array([abs(e / t - 1.0) for t, e in pairs if 0.1 * whole < t <= 0.9 * whole])


@pytest.mark.parametrize("places", [1, 3, 8])
@pytest.mark.parametrize("kind", KINDS)
def test_right_within_a_fifth_after_a_tenth_of_the_work(kind, places):
    """In nine of ten looks; where durations do not scatter, in each."""
    found = []
    for seed in range(3):
        pairs = shown(KINDS[kind](np.random.default_rng(seed), RUNS), places)
        found.append(errors(pairs, pairs[0][0]))
    wrong = np.concatenate(found)
    assert np.quantile(wrong, 0.9) < 0.2 and np.median(wrong) < 0.06
    if kind in ("constant", "increasing"):
        assert wrong.max() < 0.05


@pytest.mark.parametrize("runs", [10, 23])
@pytest.mark.parametrize("places", [1, 2, 4, 8])
def test_exact_to_the_last_run_where_all_take_as_long(runs, places):
    """The last round of places counts whole, whether it is full or not."""
    pairs = shown(np.full(runs, 60.0), places)
    assert [e for t, e in pairs[1:]] == pytest.approx([t for t, _ in pairs[1:]], abs=1e-9)


@pytest.mark.parametrize("kind", KINDS)
def test_a_resumed_study_knows_from_its_start(kind):
    """Earlier runs count, failed ones included."""
    found = []
    for seed in range(3):
        seconds = KINDS[kind](np.random.default_rng(seed), RUNS)
        pairs = shown(seconds[80:], 4, seconds[:80])
        assert pairs[0][1] == pytest.approx(pairs[0][0], rel=0.2)
        found.append(errors(pairs, pairs[0][0]))
    assert np.quantile(np.concatenate(found), 0.9) < 0.2


def test_a_resumed_study_on_a_machine_of_half_the_speed():
    """Few runs show that the earlier ones are of another machine."""
    rng = np.random.default_rng(1)
    pairs = shown(120 * rng.lognormal(0, 0.1, 100), 4, 60 * rng.lognormal(0, 0.1, 100))
    assert errors(pairs, pairs[0][0]).max() < 0.1


def test_what_comes_between_runs_counts():
    """Short runs: a place waits longer for the next run than it takes."""
    pairs = shown(np.full(RUNS, 1.0), 4, wait=1.5)
    assert errors(pairs, pairs[0][0]).max() < 0.05


def test_places_that_never_come_do_not_count():
    """Eight were asked for, a cluster gave two."""
    now = [0.0]
    tally = Tally(Progress(100), 8, lambda _: None, clock=lambda: now[0])
    tally.start([])
    for k in range(60):
        now[0] = 10.0 * (k // 2 + 1)
        tally.add(record(10.0))
    assert tally.now.seconds_left == pytest.approx(200.0, rel=0.05)


def test_nothing_is_known_before_the_first_run_and_nothing_left_after_the_last():
    assert time_left([], [0.0], 3, 1) is None
    assert time_left([5.0], [], 0, 1) == 0.0


def test_one_run_cannot_be_shared():
    """Two places are no help for a run; three runs take two rounds."""
    assert time_left([60.0] * 5, [], 1, 2) == pytest.approx(60.0)
    assert time_left([60.0] * 5, [], 3, 2) == pytest.approx(120.0)


def test_short_runs_first_do_not_mislead():
    """Half of the runs take 1 s, half 10 s: after 2 s the long ones are seen by their age."""
    assert time_left([1.0] * 8, [2.0] * 4, 4, 4) == 1.0  # as much again as they are over
    assert time_left([1.0, 10.0] * 8, [2.0] * 4, 4, 4) == pytest.approx(8.0)
