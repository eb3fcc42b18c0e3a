import numpy as np
import pytest
from scipy.spatial import distance

from surrogate.designs.axial_points import axial_points
from surrogate.designs.center_points import center_points
from surrogate.designs.central_composite import central_composite
from surrogate.designs.fold_over import fold_over
from surrogate.designs.fractional_factorial import fractional_factorial
from surrogate.designs.full_factorial import full_factorial
from surrogate.designs.latin_hypercube import latin_hypercube
from surrogate.designs.space_filling import space_filling
from surrogate.errors import DesignError


def test_full_fold_over_frees_main_effects_from_interactions(cube):
    """Main effects of the folded 2^(7-4) are orthogonal to every two-factor interaction."""
    space = cube(7)
    coded = fractional_factorial(space, resolution=3, center_points=1)
    added = fold_over(space, coded)
    assert added.shape == (8, 7)  # the centre point is not repeated
    both = np.vstack([coded, added])
    pairs = (both[:, :, None] * both[:, None, :])[:, *np.triu_indices(7, 1)]
    np.testing.assert_array_equal(both.T @ pairs, 0)


def test_fold_over_on_one_parameter_frees_its_interactions(cube):
    """Folding A: A and all A:x are orthogonal to each other and to the other main effects."""
    space = cube(7)
    coded = fractional_factorial(space, resolution=3)
    both = np.vstack([coded, fold_over(space, coded, parameter="A")])
    a = both[:, [0]] * np.column_stack([np.ones(16), both[:, 1:]])
    np.testing.assert_array_equal(a.T @ both[:, 1:], 0)
    np.testing.assert_array_equal(a.T @ a, 16 * np.eye(7))


def test_fold_over_mistakes(cube, mixed):
    """Nothing to add, an unknown parameter, three levels."""
    with pytest.raises(DesignError, match="adds nothing"):
        fold_over(cube(3), full_factorial(cube(3)))
    with pytest.raises(DesignError, match="parameter: 'Z' is unknown"):
        fold_over(cube(3), full_factorial(cube(3)), parameter="Z")
    coded = latin_hypercube(mixed, runs=6, seed=0)
    with pytest.raises(DesignError, match="posture"):
        fold_over(mixed, coded)
    folded = fold_over(mixed, coded, parameter="bandage")
    np.testing.assert_array_equal(folded[:, 1], -coded[:, 1])


def test_center_points(cube, mixed, unbounded):
    """The middle of ranges and the median, at each combination of levels."""
    np.testing.assert_array_equal(center_points(cube(3), None, runs=2), np.zeros((2, 3)))
    added = center_points(mixed, None, runs=2)
    assert added.shape == (12, 4) and len(np.unique(added, axis=0)) == 6
    decoded = mixed.decode(added)
    np.testing.assert_allclose(decoded["tension"], 0.098)
    assert set(zip(decoded["bandage"], decoded["posture"], strict=True)) == {
        (a, b) for a in ("biflex_16", "biflex_17") for b in ("lying", "sitting", "standing")
    }
    assert unbounded.decode(center_points(unbounded, None))["c10"][0] == pytest.approx(5.0)
    with pytest.raises(DesignError, match="runs: 0"):
        center_points(cube(3), None, runs=0)


def test_factorial_with_axial_points_is_central_composite(cube):
    """A two-level factorial grown by a star and a centre is the face-centred design."""
    space = cube(3)
    coded = full_factorial(space)
    grown = np.vstack([coded, axial_points(space, coded), center_points(space, coded)])
    np.testing.assert_array_equal(grown, central_composite(space, alpha="face"))


def test_axial_points_options(cube, mixed, unbounded):
    """alpha inside the range, a star at each level, ends needed for alpha = 1."""
    added = axial_points(cube(2), None, alpha=0.5)
    np.testing.assert_array_equal(added, [[-0.5, 0], [0.5, 0], [0, -0.5], [0, 0.5]])
    assert axial_points(mixed, None).shape == (6 * 4, 4)
    assert axial_points(unbounded, None, alpha=0.5).shape == (4, 2)
    with pytest.raises(DesignError, match="c10"):
        axial_points(unbounded, None)
    with pytest.raises(DesignError, match="alpha: 1.5"):
        axial_points(cube(2), None, alpha=1.5)
    levels = type(mixed)(mixed.parameters[1:3])
    with pytest.raises(DesignError, match="all of these have levels"):
        axial_points(levels, None)


def test_added_points_fill_the_gaps(cube):
    """Farther from all that is there than any of 200 random additions of as many points."""
    space = cube(3)
    rng = np.random.default_rng(0)
    there = rng.uniform(-1.0, 1.0, (20, 3))
    added = space_filling(space, there, runs=8, seed=0)

    def apart(more):
        table = distance.cdist(more, np.vstack([there, more]))
        return table[table > 0].min()

    assert added.shape == (8, 3)
    assert apart(added) > 1.5 * max(apart(rng.uniform(-1, 1, (8, 3))) for _ in range(200))
    np.testing.assert_array_equal(added, space_filling(space, there, runs=8, seed=0))


def test_the_emptiest_place_is_taken_first(cube):
    """One point to add to three corners of a square: the fourth."""
    there = np.array([[-1.0, -1.0], [-1.0, 1.0], [1.0, -1.0]])
    added = space_filling(cube(2), there, runs=1, seed=0)
    assert np.linalg.norm(added - 1.0) < 0.15
