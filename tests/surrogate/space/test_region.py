"""Constraints of a space: the law that is left, equalities, regions that are next to nothing."""

import numpy as np
import pytest
from scipy import stats

from surrogate.errors import StudyError
from surrogate.space.constraint_text import parse
from surrogate.space.discrete import integers
from surrogate.space.distributions import distribution, uniform
from surrogate.space.space import Parameter, Space


def box(names, *texts, fixed=(), correlation=None):
    units = dict.fromkeys([*names, *(name for name, _ in fixed)], "")
    parameters = tuple(Parameter(name, uniform(0.0, 1.0)) for name in names)
    return Space(parameters, correlation, tuple(parse(text, units) for text in texts), fixed)


def test_samples_are_uniform_on_a_triangle():
    """On a + b <= 1/2 the density of a is 8 (1/2 - a): mean 1/6, F(a) = 1 - (1 - 2 a)^2."""
    space = box("ab", "a + b <= 0.5")
    a = space.decode(space.sample(4000, seed=1))["a"]
    assert stats.kstest(a, lambda x: 1.0 - (1.0 - 2.0 * x) ** 2).pvalue > 0.01
    assert not space.independent


def test_walks_are_uniform_too():
    """A cube of 0.06^5 of the box, 8e-7: uniform on [0, 0.06] in each direction."""
    space = box("abcde", "max(a, b, c, d, e) <= 0.08")
    physical = space.decode(space.sample(3000, seed=1))
    for name in "abcde":
        assert stats.kstest(physical[name][::3] / 0.08, "uniform").pvalue > 1e-3


def test_a_mixture_is_uniform_on_the_simplex():
    """Dirichlet(1, 1, 1, 1): each component follows Beta(1, 3); the sum is 1 to rounding."""
    space = box("abcd", "a + b + c + d = 1")
    coded = space.sample(4000, seed=2)
    physical = space.decode(coded)
    assert sum(physical.values()) == pytest.approx(np.ones(4000), abs=1e-12)
    assert space.contains(coded).all()
    for name in "abcd":
        assert stats.kstest(physical[name], stats.beta(1, 3).cdf).pvalue > 1e-3


def test_constants_are_folded_in():
    space = box("ab", "a + gap <= b", fixed=(("gap", 0.5),))
    physical = space.decode(space.sample(200, seed=0))
    assert (physical["a"] + 0.5 <= physical["b"]).all()


def test_the_law_that_remains_keeps_copula_and_integers():
    units = {"x": "", "n": ""}
    space = Space(
        (
            Parameter("x", distribution("normal", mean=0.0, std=1.0)),
            Parameter("n", integers((-3, 3))),
        ),
        ((1.0, 0.7), (0.7, 1.0)),
        (parse("x <= n", units),),
    )
    free = Space(space.parameters, space.correlation)
    physical, loose = (s.decode(s.sample(n, seed=3)) for s, n in ((space, 4000), (free, 40000)))
    kept = loose["x"] <= loose["n"]
    assert (physical["x"] <= physical["n"]).all()
    assert set(physical["n"]) <= set(range(-3, 4))
    assert physical["x"].mean() == pytest.approx(loose["x"][kept].mean(), abs=0.05)
    assert physical["n"].mean() == pytest.approx(loose["n"][kept].mean(), abs=0.1)


@pytest.mark.parametrize(
    "names, texts, said",
    [
        ("ab", ["a <= 0.9", "a * b >= 2"], r"constraint 'a \* b >= 2' leaves nothing"),
        ("ab", ["a <= 0.4", "b <= 0.4", "a + b >= 1"], "'a \\+ b >= 1' .* other constraints kept"),
        ("abcd", ["max(a, b, c, d) <= 0.01"], "less than 1e-06 of the box"),
        ("ab", ["a * b = 0.5"], "an equality must be linear"),
        ("ab", ["a + b = 5"], "leaves nothing"),
    ],
)
def test_constraints_that_cannot_be_are_told(names, texts, said):
    with pytest.raises(StudyError, match=said):
        box(names, *texts)


def test_equalities_need_uniform_ranges():
    units = {"a": "", "n": ""}
    parameters = (Parameter("a", uniform(0, 1)), Parameter("n", integers((0, 3))))
    with pytest.raises(StudyError, match="n is whole numbers 0 to 3, .* must be uniform"):
        Space(parameters, None, (parse("a + n = 1", units),))


def test_two_equalities_leave_a_plane():
    space = box("abcd", "a + b = 1", "c + d = 1")
    physical = space.decode(space.sample(100, seed=0))
    assert physical["a"] + physical["b"] == pytest.approx(np.ones(100))
    assert physical["c"] + physical["d"] == pytest.approx(np.ones(100))
    assert len(space.region.dependent) == 2
