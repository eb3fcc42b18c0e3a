"""The smooth skin of a leg and its derivatives, against plane and solid geometry."""

import numpy as np
import pytest
from scipy.special import ellipe

from surrogate.errors import SolverError
from surrogate_solvers.leg_bandage.geometry import section
from surrogate_solvers.leg_bandage.geometry.basis import shipped_basis
from surrogate_solvers.leg_bandage.geometry.cohort import load_cohort
from surrogate_solvers.leg_bandage.geometry.leg import Leg

THETA = np.linspace(0, 2 * np.pi, 60, endpoint=False)[:, None]


@pytest.fixture(scope="module")
def mean_leg():
    return Leg.from_alphas(237.6, shipped_basis().mean)


def leg_of(function, length=200.0, sections=100):
    """A leg whose sections have radius function(theta, z)."""
    theta = np.linspace(0, 2 * np.pi, 400, endpoint=False)
    radii = [function(theta, z) * np.ones_like(theta) for z in np.linspace(0, length, sections)]
    return Leg.from_sections(
        length, section.fit_series(theta, np.array(radii)), np.zeros((sections, 2))
    )


def test_cylinder():
    leg = leg_of(lambda theta, z: 45.0)
    np.testing.assert_allclose(leg.curvature(THETA, np.linspace(-40, 240, 9)), 1 / 45, rtol=1e-11)
    np.testing.assert_allclose(leg.girth(np.array([0.0, 77.0])), 2 * np.pi * 45, rtol=1e-12)


def test_limacon():
    """r = a + b cos t: curvature (a^2 + 2 b^2 + 3 a b cos t) / (a^2 + b^2 + 2 a b cos t)^1.5."""
    a, b, t = 45.0, 12.0, np.linspace(0, 2 * np.pi, 37)
    leg = leg_of(lambda theta, z: a + b * np.cos(theta))
    exact = (a**2 + 2 * b**2 + 3 * a * b * np.cos(t)) / (a**2 + b**2 + 2 * a * b * np.cos(t)) ** 1.5
    np.testing.assert_allclose(leg.curvature(t, 60.0), exact, rtol=1e-10)


def test_nearly_circular_ellipse():
    """Ellipse 46 x 44: curvature a b / (a^2 sin^2 t + b^2 cos^2 t)^1.5, girth 4 a E(e)."""
    a, b = 46.0, 44.0
    leg = leg_of(lambda t, z: a * b / np.hypot(b * np.cos(t), a * np.sin(t)))
    girth = 4 * a * ellipe(1 - b**2 / a**2)
    np.testing.assert_allclose(leg.girth(100.0), girth, rtol=1e-6)
    np.testing.assert_allclose(
        leg.curvature([0.0, np.pi / 2], 100.0), [a / b**2, b / a**2], rtol=2e-3
    )


def test_cone():
    """r = 30 + 0.1 z: a straight generator inside, second derivative zero."""
    leg = leg_of(lambda theta, z: 30 + 0.1 * z)
    z = np.linspace(0, 200, 7)
    np.testing.assert_allclose(
        leg.radius(THETA, z), np.broadcast_to(30 + 0.1 * z, (60, 7)), rtol=1e-10
    )
    np.testing.assert_allclose(leg.radius(0.3, z, d_z=1), 0.1, rtol=1e-8)
    np.testing.assert_allclose(leg.radius(0.3, z, d_z=2), 0.0, atol=1e-9)


@pytest.mark.parametrize("d_theta, d_z", [(1, 0), (2, 0), (0, 1), (0, 2), (1, 1)])
def test_derivatives_against_differences(mean_leg, d_theta, d_z):
    """Central differences, inside the leg and in both extensions."""
    z, h = np.array([-60.0, -10.0, 3.0, 111.0, 230.0, 245.0, 300.0]), 1e-4
    lower = (d_theta - 1, d_z) if d_theta else (d_theta, d_z - 1)
    step = (h, 0) if d_theta else (0, h)
    ahead = mean_leg.surface(THETA + step[0], z + step[1], *lower)
    behind = mean_leg.surface(THETA - step[0], z - step[1], *lower)
    np.testing.assert_allclose(
        mean_leg.surface(THETA, z, d_theta, d_z), (ahead - behind) / (2 * h), atol=2e-6
    )


@pytest.mark.parametrize("cut", [0.0, 237.6])
def test_extension_is_twice_continuously_differentiable(mean_leg, cut):
    for order, tolerance in ((0, 1e-6), (1, 1e-8), (2, 1e-6)):
        under, over = (mean_leg.numbers(cut + e, order) for e in (-1e-7, 1e-7))
        np.testing.assert_allclose(under, over, atol=tolerance)


def test_extension_stays_a_leg():
    """80 mm beyond both cuts of every shipped leg the girth stays within 15 % of the cut's."""
    cohort, basis = load_cohort("train"), shipped_basis()
    for length, alphas in zip(cohort.length, basis.training, strict=True):
        leg = Leg.from_alphas(length, alphas).extended(80, 80)
        assert leg.span == pytest.approx((-80, length + 80))
        for cut, end in zip((0.0, length), leg.span, strict=True):
            assert leg.girth(end) == pytest.approx(float(leg.girth(cut)), rel=0.15)


def test_spline_passes_through_the_sections_to_their_noise():
    """0.05 mm is far below the 0.11 mm that five harmonics miss of a section."""
    cohort = load_cohort("train")
    for length, coefficients, centre in zip(
        cohort.length, cohort.coefficients, cohort.centre, strict=True
    ):
        leg = Leg.from_sections(length, coefficients, centre)
        given = section.radius(coefficients, THETA)
        assert np.abs(leg.radius(THETA, leg.z) - given).max() < 0.05
        assert np.abs(leg.centre_line(leg.z) - centre).max() < 0.05


def test_size_scales_with_length_at_the_same_shape():
    """The snapshot is U / L: twice the length, twice every radius, half the curvature."""
    alphas = shipped_basis().mean
    small, large = Leg.from_alphas(150, alphas), Leg.from_alphas(300, alphas)
    np.testing.assert_allclose(large.radius(THETA, 120.0), 2 * small.radius(THETA, 60.0))
    np.testing.assert_allclose(large.curvature(THETA, 120.0), small.curvature(THETA, 60.0) / 2)


def test_wrong_sections_are_refused_with_a_sentence():
    with pytest.raises(SolverError, match="give \\(S, 11\\) and \\(S, 2\\)"):
        Leg.from_sections(200.0, np.zeros((100, 13)), np.zeros((100, 2)))
    with pytest.raises(SolverError, match="9 sections are too few"):
        Leg.from_sections(200.0, np.ones((9, 11)), np.zeros((9, 2)))
    with pytest.raises(SolverError, match="5 alphas for a basis of 4 modes"):
        Leg.from_alphas(200.0, (-0.7, 0.0, 0.0, 0.0, 0.0))
