import itertools

import numpy as np
import pytest

from surrogate.designs.box_behnken import BLOCKS, box_behnken
from surrogate.designs.central_composite import central_composite
from surrogate.designs.full_factorial import full_factorial
from surrogate.designs.plackett_burman import constructible, plackett_burman, saturated
from surrogate.errors import DesignError


def quadratic(coded):
    """Model matrix of a full quadratic: 1, x, x_i x_j, x^2."""
    k = coded.shape[1]
    pairs = [coded[:, i] * coded[:, j] for i, j in itertools.combinations(range(k), 2)]
    return np.column_stack([np.ones(len(coded)), coded, *pairs, coded**2])


def variance_spread(coded, radius):
    """Smallest and largest prediction variance over random directions at one radius."""
    direction = np.random.default_rng(0).normal(size=(400, coded.shape[1]))
    points = radius * direction / np.linalg.norm(direction, axis=1, keepdims=True)
    F = quadratic(coded)
    f = quadratic(points)
    variance = (f @ np.linalg.inv(F.T @ F) * f).sum(axis=1)
    return variance.min(), variance.max()


@pytest.mark.parametrize("k", [3, 4, 5, 6, 7, 9, 10])
def test_box_behnken_run_counts(reference, cube, k):
    """Box and Behnken 1960, table 4."""
    assert len(box_behnken(cube(k), center_points=0)) == reference["box_behnken"][str(k)]


@pytest.mark.parametrize("k", BLOCKS)
def test_box_behnken_estimates_every_quadratic_term(cube, k):
    """Levels are -1, 0, 1; each parameter is in as many runs; linear terms are orthogonal."""
    coded = box_behnken(cube(k), center_points=1)
    assert set(np.unique(coded)) == {-1.0, 0.0, 1.0}
    assert len(set((coded != 0).sum(axis=0))) == 1
    assert np.linalg.matrix_rank(quadratic(coded)) == (k + 1) * (k + 2) // 2
    np.testing.assert_array_equal(coded.T @ coded, np.diag(np.diag(coded.T @ coded)))


@pytest.mark.parametrize("k", [4, 7])
def test_box_behnken_for_4_and_7_parameters_is_rotatable(cube, k):
    """Box and Behnken 1960: exactly rotatable for 4 and 7, not for 3."""
    low, high = variance_spread(box_behnken(cube(k), center_points=3), 1.0)
    assert high - low < 1e-12 * high
    low, high = variance_spread(box_behnken(cube(3), center_points=3), 1.0)
    assert high - low > 1e-3 * high


@pytest.mark.parametrize("k", [2, 8, 13])
def test_box_behnken_that_is_not_published(cube, k):
    """8 parameters have no published design; the message names the alternatives."""
    with pytest.raises(DesignError, match=f"for {k} parameters .* central_composite"):
        box_behnken(cube(k))


@pytest.mark.parametrize("k", [2, 3, 4, 5, 6])
def test_rotatable_alpha(reference, cube, k):
    """Box and Hunter 1957: alpha is the fourth root of the number of corners."""
    coded = central_composite(cube(k), center_points=1)
    assert coded.shape == (2**k + 2 * k + 1, k)
    assert np.abs(coded).max() == 1.0
    corner = np.abs(coded[0, 0])
    assert 1.0 / corner == pytest.approx(reference["rotatable_alpha"][str(k)], rel=1e-14)


@pytest.mark.parametrize(
    "k, cube_part", [(2, "full"), (4, "full"), (5, "fraction"), (6, "fraction"), (8, "fraction")]
)
def test_rotatable_variance_depends_on_radius_only(cube, k, cube_part):
    """Box and Hunter 1957: the definition of rotatability, at two radii."""
    coded = central_composite(cube(k), cube=cube_part, center_points=3)
    for radius in (0.4, 0.9):
        low, high = variance_spread(coded, radius)
        assert high - low < 1e-10 * high
    low, high = variance_spread(central_composite(cube(k), alpha="face", cube=cube_part), 0.9)
    assert high - low > 1e-3 * high


def test_face_centred_has_three_levels(cube):
    """alpha = 1: corners and star at the ends of the ranges."""
    coded = central_composite(cube(3), alpha="face", center_points=0)
    assert set(np.unique(coded)) == {-1.0, 0.0, 1.0} and len(coded) == 14


def test_spherical_points_lie_on_one_sphere(cube):
    """alpha = sqrt(k): corners and star are equally far from the centre."""
    radius = np.linalg.norm(central_composite(cube(3), alpha="spherical", center_points=0), axis=1)
    np.testing.assert_allclose(radius, 1.0, rtol=1e-14)


def test_fraction_keeps_the_quadratic_model(cube):
    """A resolution V cube: 64 corners instead of 128 for 7 parameters, all terms estimable."""
    coded = central_composite(cube(7), cube="fraction")
    assert len(coded) == 64 + 14 + 1
    assert np.linalg.matrix_rank(quadratic(coded)) == 36


@pytest.mark.parametrize(
    "options, said",
    [
        ({"alpha": "rotateable"}, "did you mean 'rotatable'"),
        ({"alpha": 0.5}, "alpha: 0.5"),
        ({"cube": "half"}, "cube: 'half'"),
        ({"center_points": 1.5}, "center_points: 1.5"),
    ],
)
def test_central_composite_mistakes(cube, options, said):
    """Sentences with the value and what is allowed."""
    with pytest.raises(DesignError, match=said):
        central_composite(cube(3), **options)


@pytest.mark.parametrize("method", [box_behnken, central_composite])
def test_levels_have_no_middle(mixed, unbounded, method):
    """Categorical and unbounded parameters are refused by name."""
    with pytest.raises(DesignError, match="bandage: .*(?s:.)*posture: "):
        method(mixed)
    with pytest.raises(DesignError, match="c10: "):
        method(unbounded)


@pytest.mark.parametrize("runs", [12, 20, 24])
def test_plackett_burman_first_rows(reference, runs):
    """Plackett and Burman 1946: published first rows; the last run is all minus."""
    columns = saturated(runs)
    row = "".join("+" if value > 0 else "-" for value in columns[0])
    assert row == reference["plackett_burman"][str(runs)]
    assert (columns[-1] == -1).all()


@pytest.mark.parametrize("runs", [n for n in range(4, 101, 4) if constructible(n)])
def test_plackett_burman_columns_are_orthogonal(runs):
    """Hadamard: X'X = N I, and each column is balanced."""
    columns = saturated(runs)
    np.testing.assert_array_equal(columns.T @ columns, runs * np.eye(runs - 1))
    np.testing.assert_array_equal(columns.sum(axis=0), 0)


def test_orders_without_a_construction():
    """Up to 100 only 52, 92 and 100 need constructions that are not here."""
    assert [n for n in range(4, 101, 4) if not constructible(n)] == [52, 92, 100]


@pytest.mark.parametrize(
    "k, runs", [(3, 4), (4, 8), (11, 12), (12, 16), (23, 24), (25, 28), (50, 56)]
)
def test_plackett_burman_run_counts(cube, k, runs):
    """The next multiple of 4 above k; 56 where 52 has no construction."""
    coded = plackett_burman(cube(k), center_points=1)
    assert coded.shape == (runs + 1, k) and not coded[-1].any()


def test_plackett_burman_projects_onto_three_factors():
    """Box and Tyssedal 1996: 12 runs hold a full 2^3 in any three columns (strength 2,
    projectivity 3)."""
    columns = saturated(12)
    for chosen in itertools.combinations(range(11), 3):
        assert len(np.unique(columns[:, chosen], axis=0)) == 8


def test_plackett_burman_sizes(cube):
    """A larger size may be asked for; others are refused."""
    assert len(plackett_burman(cube(5), runs=12)) == 12
    for runs in (6, 14, 52):
        with pytest.raises(DesignError, match=f"runs: .*{runs}"):
            plackett_burman(cube(5), runs=runs)


def test_full_factorial_levels(cube, mixed):
    """Counts by parameter, the first changing fastest; categorical ones take all levels."""
    coded = full_factorial(cube(3), levels={"A": 3, "C": 4})
    assert len(coded) == 3 * 2 * 4 == len(np.unique(coded, axis=0))
    np.testing.assert_array_equal(coded[:4, 0], [-1, 0, 1, -1])
    coded = full_factorial(mixed, levels=3, center_points=1)
    assert len(coded) == 3 * 2 * 3 * 3 + 6
    assert set(mixed.decode(coded)["posture"]) == {"lying", "sitting", "standing"}
    np.testing.assert_array_equal(coded[-6:, [0, 3]], 0)


@pytest.mark.parametrize(
    "options, said",
    [
        ({"levels": 1}, "levels of tension: 1"),
        ({"levels": {"tensoin": 3}}, "did you mean 'tension'"),
        ({"levels": {"posture": 2}}, "must be 3"),
        ({"levels": 2000}, "runs; use"),
    ],
)
def test_full_factorial_mistakes(mixed, options, said):
    """Levels that a parameter cannot have, and designs no one could run."""
    with pytest.raises(DesignError, match=said):
        full_factorial(mixed, **options)
