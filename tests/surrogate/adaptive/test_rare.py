"""The aim `probability` reaches events that no plain design meets."""

import numpy as np
import pytest
from scipy import stats

from surrogate.adaptive.aim import PROBABILITY, Aim, Review, Rule, Until
from surrogate.adaptive.answers import Answers
from surrogate.adaptive.choose import choose
from surrogate.adaptive.judge import is_due, review
from surrogate.adaptive.rare import explores, exploring
from surrogate.designs.latin_hypercube import latin_hypercube
from surrogate.regressors.gaussian_process import GaussianProcess
from surrogate.space.distributions import distribution, uniform
from surrogate.space.space import Parameter, Space

SPACE = Space(tuple(Parameter(f"x{k}", distribution("normal", mean=0.0, std=1.0)) for k in (1, 2)))

BOX = Space((Parameter("x", uniform(-5.0, 10.0)), Parameter("y", uniform(0.0, 15.0))))


def bowl(coded):
    """Fails beyond the circle of radius 4.5: the probability is exp(-4.5^2 / 2) = 4.0e-5."""
    x, y = SPACE.decode(coded).values()
    return x**2 + y**2


def grown(of, rule, runs, space=SPACE, initial=None):
    coded = latin_hypercube(SPACE, runs=10, seed=2) if initial is None else initial
    reviews = list[Review]()
    while len(coded) < runs:
        ok = np.ones(len(coded), dtype=bool)
        answers = Answers(coded, ok, ok, {"y": of(coded)})
        if is_due(rule, reviews, len(coded)):
            reviews.append(review(rule, space, answers))
        coded = np.vstack([coded, choose(rule, space, answers, reviews[-1])])
    ok = np.ones(len(coded), dtype=bool)
    return coded, review(rule, space, Answers(coded, ok, ok, {"y": of(coded)}))


def test_a_rare_event_all_around_is_found():
    rule = Rule(Aim(PROBABILITY, ("y",), 4.5**2), Until(40, "unsure"))
    coded, last = grown(bowl, rule, 40)
    assert last.estimate == pytest.approx(np.exp(-(4.5**2) / 2.0), rel=0.25)
    assert last.figure < last.estimate
    radius = np.sqrt(bowl(coded[10:]))
    assert np.median(np.abs(radius - 4.5)) < 0.5  # the chosen runs lie near the limit


def branin(coded):
    x, y = BOX.decode(coded).values()
    bow = y - 5.1 * x**2 / (4 * np.pi**2) + 5 * x / np.pi - 6
    return bow**2 + 10 * (1 - 1 / (8 * np.pi)) * np.cos(x) + 10


def test_a_second_region_that_the_process_is_sure_about_is_found():
    """The two corners in which Branin's function passes its 99 % quantile, from eight runs."""
    points = BOX.sample(40_000, seed=1)
    values = branin(points)
    limit = float(np.quantile(values, 0.99))
    rule = Rule(Aim(PROBABILITY, ("y",), limit), Until(24, "unsure"))
    for seed in (0, 4):  # the process of these eight is sure that one corner does not fail
        coded, _ = grown(branin, rule, 24, BOX, latin_hypercube(BOX, runs=8, seed=seed))
        process = GaussianProcess(normal_scores=True, space=BOX).fit(coded, branin(coded))
        assert (process.predict(points) > limit).mean() == pytest.approx(0.01, rel=0.1)


def test_a_run_that_explores_is_far_from_all_and_within_the_ball_that_counts():
    coded = latin_hypercube(SPACE, runs=10, seed=2)
    ok = np.ones(10, dtype=bool)
    answers = Answers(coded, ok, ok, {"y": bowl(coded)})
    process = GaussianProcess(normal_scores=True, space=SPACE).fit(coded, bowl(coded))
    radii = {}
    for probability in (1e-2, 1e-6):
        point = exploring(SPACE, process, answers, probability, seed=1)
        radii[probability] = float(np.sqrt(bowl(point)[0]))
        ball = np.sqrt(-2.0 * np.log(0.1 * probability))  # of Rayleigh's law
        assert 0.9 * ball < radii[probability] <= ball
    assert radii[1e-6] > radii[1e-2]


def test_the_share_of_runs_that_explore_falls():
    assert [n for n in range(60) if explores(n)] == [0, 1, 3, 6, 10, 15, 21, 28, 36, 45, 55]


def test_below_a_limit_is_the_other_side():
    def plane(coded):
        return sum(SPACE.decode(coded).values()) / 2.0**0.5

    rule = Rule(Aim(PROBABILITY, ("y",), -4.0, -1), Until(25, "unsure"))
    _, last = grown(plane, rule, 25)
    # two repeats of 2000 points a level: a coefficient of variation of some 0.2
    assert stats.norm.isf(last.estimate) == pytest.approx(4.0, abs=0.12)
