"""Which points are chosen, when a design is reviewed, and why it ends."""

import numpy as np
import pytest

from surrogate.adaptive.aim import (
    ACCURACY,
    INDEX_WIDTH,
    OPTIMUM,
    PROBABILITY,
    TARGET,
    Aim,
    Review,
    Rule,
    Until,
)
from surrogate.adaptive.answers import Answers, processes
from surrogate.adaptive.candidates import allowed, around, candidates
from surrogate.adaptive.choose import choose
from surrogate.adaptive.gain import gain
from surrogate.adaptive.judge import (
    NO_IMPROVEMENT,
    NOTHING_LEFT,
    REACHED,
    SAMPLES,
    USED_UP,
    is_due,
    reason,
    review,
)
from surrogate.adaptive.kept import Kept, State
from surrogate.adaptive.outcome import outcome, outcome_data, outcome_from
from surrogate.designs.latin_hypercube import latin_hypercube
from surrogate.errors import ResultsError
from surrogate.runs.files import write_new
from surrogate.space.constraint_text import parse
from surrogate.space.discrete import integers
from surrogate.space.distributions import distribution, uniform
from surrogate.space.space import Parameter, Space

SQUARE = Space(tuple(Parameter(name, uniform(-1.0, 1.0)) for name in "xy"))
MIXED = Space(
    (
        Parameter("x", uniform(-1.0, 1.0)),
        Parameter("y", uniform(-1.0, 1.0)),
        Parameter("n", integers((0.0, 5.0))),
        Parameter("gas", levels=("a", "b", "c")),
        Parameter("z", distribution("normal", mean=0.0, std=1.0)),
    ),
    constraints=(parse("x + y <= 0", {"x": "", "y": ""}),),
)
AIMS = (
    Aim(ACCURACY, ("f",)),
    Aim(INDEX_WIDTH, ("f",)),
    Aim(OPTIMUM, ("f",), sign=-1),
    Aim(TARGET, ("f",), 0.5),
    Aim(PROBABILITY, ("f",), 0.8),
)


def f(coded):
    return np.sin(3 * coded[:, 0]) * coded[:, 1] + coded[:, 0] ** 2


def answers(coded, ended=None, ok=None):
    whole = np.ones(len(coded), dtype=bool)
    ended = whole if ended is None else ended
    ok = ended if ok is None else ok
    return Answers(coded, ended, ok, {"f": np.where(ok, f(coded), np.nan)})


def rule(aim, **until):
    return Rule(aim, Until(**{"runs": 60, "figure": "q2", **until}), seed=5)


def looked(runs, figure=0.5):
    return Review(runs, figure, np.nan, {})


@pytest.mark.parametrize("aim", AIMS, ids=lambda aim: aim.kind)
def test_equal_answers_give_equal_points_that_are_allowed(aim):
    space = MIXED if aim.kind != INDEX_WIDTH else SQUARE
    known = answers(latin_hypercube(space, runs=20, seed=1))
    found = review(rule(aim), space, known)
    one, again = (choose(rule(aim), space, known, found, 3) for _ in range(2))
    assert np.array_equal(one, again) and space.contains(one).all()
    assert np.isfinite(list(space.decode(one)["z"]) if space is MIXED else one).all()
    assert len(np.unique(np.vstack([known.coded, one]), axis=0)) == 23


@pytest.mark.parametrize("aim", AIMS, ids=lambda aim: aim.kind)
def test_runs_under_way_are_counted(aim):
    """The second point is that which follows when the first one is under way."""
    known = answers(latin_hypercube(SQUARE, runs=15, seed=2))
    found = review(rule(aim), SQUARE, known)
    both = choose(rule(aim), SQUARE, known, found, 2)
    waiting = known.with_points(both[:1])
    assert np.array_equal(choose(rule(aim), SQUARE, waiting, found, 1), both[1:])
    assert np.linalg.norm(both[0] - both[1]) > 0.01


def test_what_is_believed_of_a_run_under_way_is_its_prediction():
    """The mean stays what it is everywhere, and the deviation shrinks at the run."""
    known = answers(latin_hypercube(SQUARE, runs=15, seed=3))
    found = review(rule(AIMS[0]), SQUARE, known)
    (before,) = processes(AIMS[0], SQUARE, known, found).values()
    point = np.array([[0.37, -0.61]])
    (after,) = processes(AIMS[0], SQUARE, known.with_points(point), found).values()
    X = SQUARE.sample(50, seed=1)
    assert after.predict(X) == pytest.approx(before.predict(X), abs=1e-5)
    assert after.variance_ == before.variance_
    there = [one.predict(point, return_std=True)[1][0] for one in (before, after)]
    assert there[1] < 0.1 * there[0]


def test_the_optimum_is_found_where_it_is():
    """Fifteen points from twelve: within a thousandth of the largest value."""
    coded, top = latin_hypercube(SQUARE, runs=12, seed=4), f(SQUARE.sample(100_000, seed=0)).max()
    reviews = []
    for _ in range(15):
        known = answers(coded)
        if is_due(rule(AIMS[2]), reviews, len(coded)):
            reviews.append(review(rule(AIMS[2]), SQUARE, known))
        coded = np.vstack([coded, choose(rule(AIMS[2]), SQUARE, known, reviews[-1])])
    assert f(coded).max() > top - 1e-3


def test_the_probability_is_found():
    """Against the function itself at the points of the law at which the process is asked."""
    coded, aim = latin_hypercube(SQUARE, runs=12, seed=4), AIMS[4]
    asked = rule(aim, figure="unsure")
    for _ in range(15):
        found = review(asked, SQUARE, answers(coded))
        coded = np.vstack([coded, choose(asked, SQUARE, answers(coded), found)])
    found = review(asked, SQUARE, answers(coded))
    exact = (f(SQUARE.sample(SAMPLES, seed=asked.seed)) > 0.8).mean()
    assert found.estimate == pytest.approx(exact, rel=0.02) and found.figure < 0.05


def test_a_failed_run_keeps_its_neighbourhood_free():
    points = np.array([[0.0, 0.0], [0.5, 0.5]])
    failed = np.array([True, False])
    tried = np.array([[0.1, 0.0], [0.4, 0.5], [0.5, 0.5], [-1.0, -1.0]])
    assert np.array_equal(allowed(SQUARE, tried, points, failed), tried[1:2])


def test_nothing_is_left_of_a_small_space():
    space = Space((Parameter("n", integers((0.0, 3.0))), Parameter("gas", levels=("a", "b"))))
    whole = np.array([[n, g] for n in np.linspace(-1, 1, 4) for g in (-1.0, 1.0)])
    none = np.zeros(8, dtype=bool)
    assert len(candidates(space, whole, none, seed=1)) == 0
    assert np.array_equal(candidates(space, whole[1:], none[1:], seed=1), whole[:1])


def test_steps_keep_levels_constraints_and_tails():
    best = np.array([[0.5, -0.6, 1.0, 0.0, 0.9999]])
    near = around(MIXED, best, 0.3, seed=1)
    assert len(near) and MIXED.contains(near).all() and (near[:, 3] == 0.0).all()
    assert np.isfinite(MIXED.decode(near)["z"].astype(float)).all()


def test_without_a_surrogate_points_fill_the_space():
    """One answer fits no process: the next points lie far from it and from each other."""
    known = answers(np.array([[-0.9, -0.9]]))
    found = review(rule(AIMS[0]), SQUARE, known)
    points = choose(rule(AIMS[0]), SQUARE, known, found, 3)
    assert found.lengths == {} and np.isnan(found.figure)
    assert np.linalg.norm(points[0] - known.coded[0]) > 2.0


@pytest.mark.parametrize("aim", AIMS, ids=lambda aim: aim.kind)
def test_equal_answers_so_far_stop_nothing(aim):
    """Points fill the space until the output moves."""
    coded = latin_hypercube(SQUARE, runs=12, seed=6)
    known = Answers(coded, *2 * (np.ones(12, dtype=bool),), {"f": np.full(12, 3.0)})
    asked = rule(aim, figure="unsure")
    found = review(asked, SQUARE, known)
    points = choose(asked, SQUARE, known, found, 2)
    assert SQUARE.contains(points).all() and reason(asked, [found], 14) == ""


def test_reviews_come_every_fifth_run_then_every_tenth_part():
    asked, due = rule(AIMS[0], runs=130), []
    reviews = []
    for ended in range(20, 131):
        if is_due(asked, reviews, ended):
            reviews.append(looked(ended))
            due.append(ended)
    assert due[:4] == [20, 25, 30, 35] and due[-3:] == [113, 124, 130]


def test_reasons_to_end():
    asked = rule(AIMS[0], runs=60, value=0.9, patience=10)
    assert reason(asked, [looked(20, 0.5)], 20) == ""
    assert reason(asked, [looked(20, 0.5), looked(25, 0.93)], 26) == REACHED
    assert reason(asked, [looked(20, 0.5)], 60) == USED_UP
    assert reason(asked, [looked(20, 0.5)], 30, closed=True) == NOTHING_LEFT
    stalled = [looked(20, 0.5), looked(25, 0.6), looked(30, 0.6), looked(35, 0.55)]
    assert reason(asked, stalled, 35) == NO_IMPROVEMENT
    assert reason(asked, stalled[:3], 30) == ""
    assert reason(rule(AIMS[0]), stalled, 35) == ""
    slow = [looked(20, 0.5), looked(25, 0.51), looked(30, 0.52)]
    assert reason(asked, slow, 30) == NO_IMPROVEMENT, "less than a twentieth of what is missing"


def test_what_is_kept_is_read_again(tmp_path):
    store, found = Kept(tmp_path / "rule"), Review(12, np.nan, 0.25, {"f": (0.1, -3.0)})
    points = np.array([[0.1, 1 / 3], [0.2, -0.7]])
    assert store.add_points(12, points[:1]) and store.add_points(13, points[1:])
    assert not store.add_points(13, points[:1]), "others have chosen there"
    store.add_review(found)
    state = store.read(12, 2)
    assert np.array_equal(state.points, points) and not state.closed
    assert state.reviews[0].lengths == found.lengths and np.isnan(state.reviews[0].figure)
    store.add_points(14, points[:0])
    assert store.read(12, 2).closed
    (tmp_path / "rule" / "points_00013.json").write_text("[]")
    with pytest.raises(ResultsError, match="points_00013.json is damaged"):
        store.read(12, 2)


def test_an_outcome_survives_as_data():
    asked = rule(Aim(OPTIMUM, ("mass",), unit="kg"), figure="gain", value=0.1)
    state = State(np.zeros((5, 2)), (Review(25, 0.05, 1.5, {"mass": (0.0,)}),))
    found = outcome(asked, 20, state)
    again = outcome_from(outcome_data(found))
    said = (
        "25 of at most 60 runs, aim: the smallest mass; best value 1.5 kg, expected "
        "improvement 0.05 kg (goal 0.1); ended: the goal is reached"
    )
    assert str(again) == str(found) == said


def test_a_new_file_is_made_once_also_without_links(tmp_path, monkeypatch):
    def refuse(*names):
        raise PermissionError("no links here")

    assert write_new(tmp_path / "a", "1") and not write_new(tmp_path / "a", "2")
    monkeypatch.setattr("os.link", refuse)
    assert write_new(tmp_path / "b", "1") and not write_new(tmp_path / "b", "2")
    assert (tmp_path / "a").read_text() == (tmp_path / "b").read_text() == "1"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a", "b"]


def runs(coded):
    return coded, f(coded)


def test_the_gain_is_told_as_it_is():
    """More runs that fill the space, more runs beside each other, and runs that tell nothing."""
    initial, test = latin_hypercube(SQUARE, runs=16, seed=1), SQUARE.sample(300, seed=9)
    better = np.vstack([initial, latin_hypercube(SQUARE, runs=60, seed=2)])
    beside = np.vstack([initial, initial[:1] + 1e-3 * SQUARE.sample(12, seed=3)])
    told = [gain(SQUARE, runs(initial), runs(w), runs(test), "f", "mm") for w in (better, beside)]
    assert "choosing the points did not pay: RMSE of f on the test design" in told[1]
    assert told[0].startswith(("choosing the points paid", "no gain")) and " mm with 76" in told[0]
    few = runs(initial[:2])
    assert "cannot be told" in gain(SQUARE, few, runs(better), runs(test), "f", "")
