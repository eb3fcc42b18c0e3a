"""The geometry inside the scripts that rebuild the leg data; no package is downloaded here."""

import sys
from pathlib import Path

import numpy as np
import pytest

TOOLS = Path(__file__).parents[2] / "tools"


@pytest.fixture(scope="module", autouse=True)
def tools_on_path():
    sys.path.insert(0, str(TOOLS))
    yield
    sys.path.remove(str(TOOLS))


CORNERS = np.array([[x, y, z] for x in (-1.0, 1) for y in (-1.0, 1) for z in (-1.0, 1)])
QUADS = np.array(
    [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
)


def test_first_subdivision_of_a_cube():
    """Catmull and Clark 1978: corners go to 5/9, edges to 3/4, faces stay at 1; 24 quads."""
    from body_model import catmull_clark

    operator, quads = catmull_clark(QUADS, 8)
    points = operator @ CORNERS
    np.testing.assert_allclose(np.abs(points[:8]), 5 / 9)
    np.testing.assert_allclose(
        np.sort(np.abs(points[8:20]), axis=1), [[0, 0.75, 0.75]] * 12, atol=1e-15
    )
    np.testing.assert_allclose(np.abs(points[20:]).sum(axis=1), 1)
    assert quads.shape == (24, 4)


def test_rim_of_an_open_surface_is_a_cubic_spline():
    """A flat square stays flat; its corners go to 3/4 of themselves plus an eighth of each side."""
    from body_model import catmull_clark

    square = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    operator, _ = catmull_clark(np.array([[0, 1, 2, 3]]), 4)
    points = operator @ square
    np.testing.assert_allclose(points[0], [1 / 8, 1 / 8, 0])
    np.testing.assert_allclose(points[8], [0.5, 0.5, 0])


def test_cut_through_a_box():
    """A plane cuts a 2 x 2 x 2 box in a square of girth 8."""
    from slicing import cut, segments

    triangles = CORNERS[np.concatenate([QUADS[:, [0, 1, 2]], QUADS[:, [0, 2, 3]]])]
    ends = segments(triangles, 0.3)
    assert np.linalg.norm(np.diff(ends, axis=1), axis=-1).sum() == pytest.approx(8)
    assert np.abs(cut(triangles, 0.3)).max(axis=1) == pytest.approx(1)


def test_hull_of_a_square_and_its_series():
    """A 2 x 2 square about (3, 4): mean radius (4 / pi) ln(1 + sqrt 2), order 4 alone."""
    from build_bones import hull_series

    square = np.array([[2.0, 3], [4, 3], [4, 5], [2, 5], [3, 4]])
    centroid, series = hull_series(square)
    np.testing.assert_allclose(centroid, [3, 4])
    assert series[0] == pytest.approx(4 / np.pi * np.log(1 + np.sqrt(2)), rel=1e-4)
    assert np.abs(np.delete(series, [0, 4])).max() < 1e-12
    assert series[4] < 0


def test_fourier_section_of_an_off_centre_polygon():
    """A regular 720-gon of radius 40 about (5, -7) is a circle there, whatever its own origin."""
    from build_cohort import fourier_section

    angle = 2 * np.pi * np.arange(720) / 720
    points = np.column_stack([5 + 40 * np.cos(angle), -7 + 40 * np.sin(angle)])
    series, centre = fourier_section(points[np.random.default_rng(0).permutation(720)])
    np.testing.assert_allclose(centre, [5, -7], atol=1e-9)
    np.testing.assert_allclose(series, [40] + [0] * 10, atol=1e-3)
