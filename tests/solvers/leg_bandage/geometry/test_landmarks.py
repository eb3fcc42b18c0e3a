"""Point B1 by both rules, and the sensor disc, on shapes whose answer is known."""

import numpy as np
import pytest
from scipy.optimize import minimize_scalar
from scipy.special import ellipe, ellipeinc

from surrogate.errors import SolverError
from surrogate_solvers.leg_bandage.geometry import section
from surrogate_solvers.leg_bandage.geometry.basis import shipped_basis
from surrogate_solvers.leg_bandage.geometry.cohort import load_cohort
from surrogate_solvers.leg_bandage.geometry.landmarks import (
    MEDIAL,
    Disc,
    b1_height,
    extreme_girths,
    sensor,
)
from surrogate_solvers.leg_bandage.geometry.leg import Leg

LENGTH, Z = 200.0, np.linspace(0, 200.0, 100)


def round_leg(radius):
    coefficients = np.zeros((100, 11))
    coefficients[:, 0] = radius
    return Leg.from_sections(LENGTH, coefficients, np.zeros((100, 2)))


def reconstructed(cohort):
    basis = shipped_basis()
    alphas = basis.project(cohort.snapshots().T)
    return [Leg.from_alphas(*leg) for leg in zip(cohort.length, alphas, strict=True)]


def test_girth_rule_on_a_cone():
    """On a cone the girth grows evenly: 20 % of the difference is 20 % of the height."""
    leg = round_leg(30 + 0.1 * Z)
    assert b1_height(leg) == pytest.approx(40.0, abs=1e-6)
    expected = [2 * np.pi * 30, 0, 2 * np.pi * 50, 200]
    np.testing.assert_allclose(extreme_girths(leg), expected, rtol=1e-7, atol=1e-6)


def test_girth_rule_above_a_narrowest_girth_inside_the_leg():
    """r = 30 + (z - 50)^2 / 800: narrowest at 50, widest 58.125 at the top, B1 at 50 + 67.08."""
    leg = round_leg(30 + (Z - 50) ** 2 / 800)
    assert b1_height(leg) == pytest.approx(50 + np.sqrt(0.2 * 150**2), abs=1e-4)


def test_profile_rule_finds_the_most_hollow_level():
    """A quartic profile with r'' = (1 - u^2) / 1000, u = (z - 60) / 60: the rule stops where
    r'' / (1 + r'^2)^1.5 is largest, a little off u = 0; both derivatives are closed forms."""
    bend = np.poly1d([-1 / 3600, 120 / 3600, 0.0]) / 1000
    slope = bend.integ() - 0.02
    radius = slope.integ() + 40
    exact = minimize_scalar(
        lambda z: -bend(z) / (1 + slope(z) ** 2) ** 1.5,
        bounds=(20, 90),
        method="bounded",
        options={"xatol": 1e-6},
    ).x
    assert b1_height(round_leg(radius(Z)), "profile") == pytest.approx(exact, abs=1e-3)


def test_rules_agree_over_the_cohort():
    """Both rules put B1 at about 0.24 of the length, within 23 mm of each other on every leg."""
    legs = reconstructed(load_cohort("train")) + reconstructed(load_cohort("val"))
    length = np.array([leg.length for leg in legs])
    girth = np.array([b1_height(leg) for leg in legs])
    profile = np.array([b1_height(leg, "profile") for leg in legs])
    assert np.mean(girth / length) == pytest.approx(0.24, abs=0.01)
    assert np.mean(profile / length) == pytest.approx(0.24, abs=0.01)
    assert abs(np.mean(girth - profile)) < 1.0
    assert np.abs(girth - profile).max() < 23.0


def test_b1_scales_with_length():
    alphas = shipped_basis().mean
    for rule in ("girth", "profile"):
        low, high = (b1_height(Leg.from_alphas(L, alphas), rule) for L in (150, 300))
        assert high == pytest.approx(2 * low, rel=1e-9)


def test_disc_integrates_over_a_cylinder_exactly():
    """On a cylinder the disc unrolls: mean of s^2, z^2 and s^2 z^2 are R^2/4, R^2/4, R^4/24."""
    theta, z, weights = Disc(MEDIAL, 100.0).points(round_leg(45.0 + 0 * Z))
    s, t = 45 * (theta - MEDIAL), z - 100
    assert weights.sum() == pytest.approx(1)
    np.testing.assert_allclose(
        [weights @ s**2, weights @ t**2, weights @ (s * t) ** 2],
        [25**2 / 4, 25**2 / 4, 25**4 / 24],
        rtol=1e-6,
    )


def test_disc_walks_true_arc_lengths_on_an_ellipse():
    """From the end of the long axis (46) of a 46 x 44 ellipse, arc length by E(phi, m)."""
    a, b = 46.0, 44.0
    around = np.linspace(0, 2 * np.pi, 400, endpoint=False)
    radii = a * b / np.hypot(b * np.cos(around), a * np.sin(around))
    coefficients = np.tile(section.fit_series(around, radii), (100, 1))
    leg = Leg.from_sections(LENGTH, coefficients, np.zeros((100, 2)))
    theta, z, _ = Disc(MEDIAL, 100.0).points(leg, rings=1, spokes=4)
    # The parameter of the ellipse runs from the short axis: E(pi/2) - E(pi/2 - t).
    t = np.arctan2(a * np.sin(theta - np.pi), b * np.cos(theta - np.pi))
    m = 1 - b**2 / a**2
    arc = a * (ellipe(m) - ellipeinc(np.pi / 2 - t, m))
    np.testing.assert_allclose(np.hypot(arc, z - 100), 25 / np.sqrt(2), rtol=1e-4)


def test_mask_covers_the_area_of_the_disc():
    leg = Leg.from_alphas(237.6, shipped_basis().mean)
    theta = np.radians(np.arange(0, 360, 1.0))[:, None]
    z = np.arange(0, 200, 1.0)
    area = np.linalg.norm(
        np.cross(leg.surface(theta, z, 1, 0), leg.surface(theta, z, 0, 1)), axis=-1
    ) * np.radians(1.0)
    covered = area[sensor(leg).mask(leg, theta, z)].sum()
    assert covered == pytest.approx(np.pi * 25**2, rel=0.03)


def test_legs_without_b1_are_refused():
    with pytest.raises(SolverError, match="no calf"):
        b1_height(round_leg(45.0 + 0 * Z))
    with pytest.raises(SolverError, match="upside down"):
        b1_height(round_leg(50 - 0.1 * Z))
    with pytest.raises(SolverError, match="did you mean 'girth'"):
        b1_height(round_leg(30 + 0.1 * Z), "grith")
