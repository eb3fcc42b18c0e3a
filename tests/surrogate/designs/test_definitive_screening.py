"""Conference matrices and definitive screening designs."""

import itertools

import numpy as np
import pytest

from surrogate.designs.conference import conference
from surrogate.designs.definitive_screening import definitive_screening
from surrogate.designs.model import Model
from surrogate.errors import DesignError
from surrogate.space.distributions import uniform
from surrogate.space.space import Parameter, Space


@pytest.mark.parametrize("least", range(2, 71, 2))
def test_conference_matrices(least):
    """C'C = (m - 1) I, zeros on the diagonal alone, the order even and near."""
    c = conference(least)
    np.testing.assert_array_equal(c.T @ c, (len(c) - 1) * np.eye(len(c)))
    np.testing.assert_array_equal(c == 0, np.eye(len(c), dtype=bool))
    assert least <= len(c) <= least + 4


def test_none_of_order_22_or_34():
    """21 and 33 are no sums of two squares (Belevitch 1950)."""
    assert len(conference(22)) == 24
    assert len(conference(34)) > 34


@pytest.mark.parametrize("k, runs", [(4, 9), (5, 13), (6, 13), (7, 17), (8, 17), (12, 25)])
def test_runs_are_the_published_ones(cube, k, runs):
    """2 k + 1 for an even number of parameters, 2 k + 3 for an odd one."""
    coded = definitive_screening(cube(k))
    assert coded.shape == (runs, k)
    assert not coded[-1].any()
    assert set(np.unique(coded)) == {-1.0, 0.0, 1.0}


@pytest.mark.parametrize("k", [4, 6, 7, 12])
def test_main_effects_are_clear_of_the_second_order(cube, k):
    """Orthogonal to one another, to every interaction and to every square."""
    coded = definitive_screening(cube(k))
    np.testing.assert_array_equal(coded.T @ coded, (coded**2).sum(axis=0) * np.eye(k))
    second = [
        coded[:, i] * coded[:, j] for i, j in itertools.combinations_with_replacement(range(k), 2)
    ]
    np.testing.assert_array_equal(coded.T @ np.array(second).T, 0.0)


@pytest.mark.parametrize("k", [6, 8])
def test_any_three_parameters_carry_a_full_quadratic(cube, k):
    """The projection property from six parameters on (Jones and Nachtsheim 2011, section 4)."""
    coded = definitive_screening(cube(k))
    model = Model(cube(3), "quadratic")
    for three in itertools.combinations(range(k), 3):
        assert np.linalg.matrix_rank(model.matrix(coded[:, three])) == 10


def test_two_levels_have_no_middle():
    """Levels at their ends, by signs of which no others are better; the rows still mirror."""
    ranges = [Parameter(f"x{i}", uniform(0.0, 1.0)) for i in range(4)]
    levels = [Parameter(name, levels=("low", "high")) for name in "ab"]
    coded = definitive_screening(Space((*ranges, *levels)))
    assert coded.shape == (14, 6)
    np.testing.assert_array_equal(np.abs(coded[:, 4:]), 1.0)
    np.testing.assert_array_equal(coded[0::2], -coded[1::2])
    half = np.vstack([conference(6), np.zeros(6)])
    places = [(4, 4), (5, 5), (6, 4), (6, 5)]
    best = 0.0
    for signs in itertools.product([-1.0, 1.0], repeat=4):
        half[tuple(np.transpose(places))] = signs
        best = max(best, np.linalg.det(half.T @ half))
    assert np.linalg.det(coded.T @ coded) == pytest.approx(2**6 * best)


def test_fake_factors_add_two_runs_each(cube):
    """And the matrix stays orthogonal."""
    assert len(definitive_screening(cube(6), fake_factors=2)) == 17


def test_levels_are_refused(mixed, unbounded):
    """Three levels, no ends."""
    with pytest.raises(DesignError, match="posture"):
        definitive_screening(mixed)
    with pytest.raises(DesignError, match="c10"):
        definitive_screening(unbounded)
