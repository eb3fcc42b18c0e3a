"""Dependence read from data: back to the copula that made them; none where there is none."""

import numpy as np
import pytest

from surrogate.space.dependence import dependence, holm, positive_definite
from surrogate.space.distributions import distribution, uniform
from surrogate.space.space import Parameter, Space

SPACE = Space(
    (
        Parameter("a", uniform(0, 1)),
        Parameter("b", distribution("lognormal", mean=2, std=1)),
        Parameter("c", uniform(0, 5)),
        Parameter("kind", levels=("x", "y")),
    ),
    ((1.0, 0.7, 0.0, 0.0), (0.7, 1.0, 0.0, 0.0), (0.0, 0.0, 1.0, 0.0), (0.0, 0.0, 0.0, 1.0)),
)


def test_the_copula_comes_back():
    """Standard error of the correlation from 4000 points: about 0.01."""
    found = np.array(dependence(SPACE, SPACE.sample(4000, seed=1)))
    assert found[0, 1] == pytest.approx(0.7, abs=0.03)
    assert found[0, 2] == found[1, 2] == 0.0 and (found[3] == [0, 0, 0, 1]).all()


def test_independent_inputs_are_seldom_taken_to_be_dependent():
    """At most one table in a hundred, for all pairs together; 300 tables."""
    free = Space(tuple(Parameter(f"x{j}", uniform(0, 1)) for j in range(5)))
    found = [dependence(free, free.sample(30, seed=k)) is not None for k in range(300)]
    assert np.mean(found) <= 0.025


def test_holm_is_the_published_procedure():
    """Steps down through 0.05/4, 0.05/3 and stops at 0.03 > 0.05/2."""
    assert holm(np.array([0.01, 0.04, 0.03, 0.005]), 0.05).tolist() == [True, False, False, True]
    assert holm(np.array([0.001, 0.002]), 0.05).all()


def test_a_matrix_that_is_none_becomes_one():
    matrix = np.array([[1.0, 0.9, -0.9], [0.9, 1.0, 0.9], [-0.9, 0.9, 1.0]])
    found = positive_definite(matrix)
    assert np.linalg.eigvalsh(found)[0] > 0 and (np.diag(found) == 1.0).all()
    good = np.array([[1.0, 0.5], [0.5, 1.0]])
    assert (positive_definite(good) == good).all()
