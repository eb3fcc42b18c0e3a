"""The aim `probability` reaches events that no plain design meets."""

import numpy as np
import pytest
from scipy import stats

from surrogate.adaptive.aim import PROBABILITY, Aim, Review, Rule, Until
from surrogate.adaptive.answers import Answers
from surrogate.adaptive.choose import choose
from surrogate.adaptive.judge import is_due, review
from surrogate.designs.latin_hypercube import latin_hypercube
from surrogate.space.distributions import distribution
from surrogate.space.space import Parameter, Space

SPACE = Space(tuple(Parameter(f"x{k}", distribution("normal", mean=0.0, std=1.0)) for k in (1, 2)))


def bowl(coded):
    """Fails beyond the circle of radius 4.5: the probability is exp(-4.5^2 / 2) = 4.0e-5."""
    x, y = SPACE.decode(coded).values()
    return x**2 + y**2


def grown(of, rule, runs):
    coded, reviews = latin_hypercube(SPACE, runs=10, seed=2), list[Review]()
    while len(coded) < runs:
        ok = np.ones(len(coded), dtype=bool)
        answers = Answers(coded, ok, ok, {"y": of(coded)})
        if is_due(rule, reviews, len(coded)):
            reviews.append(review(rule, SPACE, answers))
        coded = np.vstack([coded, choose(rule, SPACE, answers, reviews[-1])])
    ok = np.ones(len(coded), dtype=bool)
    return coded, review(rule, SPACE, Answers(coded, ok, ok, {"y": of(coded)}))


def test_a_rare_event_all_around_is_found():
    rule = Rule(Aim(PROBABILITY, ("y",), 4.5**2), Until(40, "unsure"))
    coded, last = grown(bowl, rule, 40)
    assert last.estimate == pytest.approx(np.exp(-(4.5**2) / 2.0), rel=0.25)
    assert last.figure < last.estimate
    radius = np.sqrt(bowl(coded[10:]))
    assert np.median(np.abs(radius - 4.5)) < 0.5  # the chosen runs lie near the limit


def test_below_a_limit_is_the_other_side():
    def plane(coded):
        return sum(SPACE.decode(coded).values()) / 2.0**0.5

    rule = Rule(Aim(PROBABILITY, ("y",), -4.0, -1), Until(25, "unsure"))
    _, last = grown(plane, rule, 25)
    # two repeats of 2000 points a level: a coefficient of variation of some 0.2
    assert stats.norm.isf(last.estimate) == pytest.approx(4.0, abs=0.12)
