"""Integers and listed values: coding, laws, quadrature, and what a study says wrongly."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from surrogate import Study
from surrogate.errors import StudyError
from surrogate.space.discrete import integers, listed
from surrogate.space.distributions import uniform
from surrogate.space.space import Parameter, Space

VALUES = st.lists(
    st.floats(-1e6, 1e6).map(lambda x: round(x, 3)), min_size=2, max_size=12, unique=True
)


@given(VALUES)
def test_decoding_gives_back_every_value_to_the_last_digit(values):
    parameter = Parameter("x", listed(values))
    rising = np.array(sorted(values))
    assert np.array_equal(parameter.decode(parameter.encode(rising)), rising)
    assert np.array_equal(parameter.snap(parameter.allowed), parameter.allowed)
    assert parameter.allowed[0] == -1.0 and parameter.allowed[-1] == 1.0


@given(VALUES, st.floats(-1, 1))
def test_decoding_gives_the_nearest_value(values, coded):
    parameter = Parameter("x", listed(values))
    x = min(values) + 0.5 * (coded + 1.0) * (max(values) - min(values))
    gaps = np.abs(np.array(values) - x)
    assert abs(parameter.decode(coded) - x) <= gaps.min() * (1.0 + 1e-9) + 1e-9


def test_coding_is_equation_8_so_that_a_slope_means_what_it_says():
    pipe = Parameter("pipe", listed([10, 12, 16, 20]), unit="mm")
    assert pipe.encode(12.0) == pytest.approx(2.0 * 2.0 / 10.0 - 1.0)


def test_values_are_equally_likely():
    teeth = Parameter("teeth", integers((1, 8)))
    u = (np.arange(800) + 0.5) / 800
    found, counts = np.unique(teeth.decode(teeth.quantile(u)), return_counts=True)
    assert found.tolist() == list(range(1, 9)) and (counts == 100).all()


def test_a_given_law_is_rounded():
    """P(X = k) = F(k + 1/2) - F(k - 1/2), F normal truncated to [-1/2, 10 + 1/2]."""
    law = integers((0, 10), "normal", mean=4.0, std=1.5)
    cut = stats.norm(4.0, 1.5)
    expected = np.diff(cut.cdf(np.arange(-0.5, 11.0)))
    assert law.probabilities == pytest.approx(expected / expected.sum(), rel=1e-12)


def test_quadrature_sums_over_the_values():
    """Mean and variance of whole numbers 1 to n: (n + 1) / 2 and (n^2 - 1) / 12."""
    for last in (8, 5000):
        teeth = Parameter("teeth", integers((1, last)))
        nodes, weights = teeth.quadrature(4)
        x = 1.0 + 0.5 * (nodes + 1.0) * (last - 1.0)
        assert weights.sum() == pytest.approx(1.0)
        assert weights @ x == pytest.approx(0.5 * (last + 1.0))
        assert weights @ (x - weights @ x) ** 2 == pytest.approx((last**2 - 1.0) / 12.0)


def test_a_space_contains_allowed_points_only():
    space = Space((Parameter("a", uniform(0, 1)), Parameter("n", integers((1, 3)))))
    coded = np.array([[0.3, 0.0], [0.3, 0.1], [1.2, 0.0]])
    assert space.contains(coded).tolist() == [True, False, False]
    assert space.contains(space.snap(coded)).tolist() == [True, True, False]


@pytest.mark.parametrize(
    "build, said",
    [
        (lambda: integers((1.5, 8)), "1.5 is no whole number"),
        (lambda: integers((8, 1)), "upside down"),
        (lambda: integers((0, 1e9)), "more than 10000 whole numbers"),
        (lambda: listed([10]), "two or more different numbers"),
        (lambda: listed([10, 12, 10]), "two or more different numbers"),
        (lambda: listed([1, 2, 500], "normal", mean=1, std=0.1), "gives 500 no probability"),
    ],
)
def test_mistakes_are_told(build, said):
    with pytest.raises(StudyError, match=said):
        build()


def study(parameters):
    return {
        "study": "s",
        "solver": "borehole",
        "parameters": parameters,
        "designs": {"train": {"method": "latin_hypercube", "runs": 12}},
        "surrogates": {"linear": "linear"},
    }


def test_a_study_reads_integers_and_values_in_its_own_unit():
    read = Study.from_mapping(
        study(
            {
                "Tu": {"range": [63070, 63080], "integer": True},
                "L": {"values": [1.6, 1.2, 1.4], "unit": "km"},
            }
        )
    )
    assert read.space["L"].law.values == pytest.approx([1200, 1400, 1600])
    assert read.space["Tu"].law.values.tolist() == list(range(63070, 63081))
    physical = read.space.decode(read.designs["train"].coded)
    assert set(physical["Tu"].tolist()) <= set(read.space["Tu"].law.values.tolist())


@pytest.mark.parametrize(
    "part, said",
    [
        ({"levels": [1200, 1400]}, r"levels are names; for numbers write values: \[1200, 1400\]"),
        ({"values": [1200, 1400], "range": [1200, 1400]}, "give values or a range, not both"),
        ({"integer": True}, "integer: true needs a range"),
        ({"values": [1200, 9000]}, "above the largest value that the solver accepts"),
    ],
)
def test_a_study_says_what_is_wrong(part, said):
    with pytest.raises(StudyError, match=said):
        Study.from_mapping(study({"L": part}))
