"""Pressure along the leg: places, means under sensors, intervals of B, C and D."""

import numpy as np
import pytest

from surrogate_solvers.leg_bandage.geometry.basis import shipped_basis
from surrogate_solvers.leg_bandage.geometry.landmarks import b1_height
from surrogate_solvers.leg_bandage.geometry.leg import Leg
from surrogate_solvers.leg_bandage.prediction.along import curve_of, reading_error
from surrogate_solvers.leg_bandage.prediction.points import (
    KNEE_GIRTH,
    KNEE_HEIGHT,
    ONE_LAYER,
    bilinear,
    local_laplace,
    places,
    under_sensor,
)
from surrogate_solvers.leg_bandage.prediction.shape import Shape


def cone(length=240.0, low=35.0, high=55.0):
    """A leg with circles for sections, widest at the top."""
    series = np.zeros((100, 11))
    series[:, 0] = np.linspace(low, high, 100)
    return Leg.from_sections(length, series, np.zeros((100, 2)))


def test_places_on_a_cone():
    """Narrowest at the lower end, widest at the upper; girth 2 pi r; D as on a common leg."""
    found = places(cone())
    assert list(found) == ["B", "B1", "C", "D"]
    assert (found["B"].height, found["B"].read) == (0.0, 25.0)
    assert found["B1"].height == pytest.approx(0.2 * 240)
    assert found["C"].height == pytest.approx(240.0) and found["C"].read == 240 - ONE_LAYER
    assert found["C"].carried == pytest.approx((35 + 20 * 165 / 240) / 55)
    assert found["D"].height == pytest.approx(240 * KNEE_HEIGHT) and not found["D"].known
    assert found["D"].carried == pytest.approx(found["C"].carried / KNEE_GIRTH)
    known = places(cone(), (330.0, 300.0))["D"]
    assert (known.height, known.girth, known.known) == (330.0, 300.0, True)


def test_places_on_the_mean_leg():
    leg = Leg.from_alphas(237.6, shipped_basis().mean)
    found = places(leg)
    heights = [found[name].height for name in ("B", "B1", "C", "D")]
    assert heights == sorted(heights) and found["B1"].height == b1_height(leg)


def test_bilinear_closes_around_and_is_exact_for_planes():
    """a + b z + c cos(theta) at grid angles; half-way between 355 and 0 degrees their mean."""
    theta, height = np.arange(0.0, 360.0, 5.0), np.linspace(0, 1, 51)
    field = 3 + 2 * height + np.cos(np.radians(theta))[:, None]
    at = bilinear(theta, height, field, np.array([-5.0, 355.0, 357.5, 725.0]), np.full(4, 0.333))
    c = np.cos(np.radians(5.0))
    np.testing.assert_allclose(at, 3.666 + np.array([c, c, (1 + c) / 2, c]), rtol=1e-12)


def test_mean_under_the_sensor_of_a_pressure_that_rises_with_height():
    """A linear pressure has the value of the middle of the disc."""
    theta, height = np.arange(0.0, 360.0, 5.0), np.linspace(0, 1, 51)
    field = np.broadcast_to(40 - 20 * height, (72, 51))
    leg = cone()
    assert under_sensor(theta, height, field, leg, 100.0) == pytest.approx(40 - 20 * 100 / 240)


def test_laplace_on_a_cone():
    """2 T / r of the horizontal section: r = 35 + 20 z / L at the middle, within 0.5 %."""
    assert local_laplace(cone(), 120.0) == pytest.approx(2 / 45 / 1.33322e-4, rel=0.005)


def test_curve_around_the_leg():
    """p = 20 + 5 cos(theta): mean 20, range 15 to 25 on a grid that has both ends."""
    theta = np.radians(np.arange(0.0, 360.0, 5.0))
    curve = curve_of((20 + 5 * np.cos(theta))[:, None] * np.ones(3), np.array([0, 0.5, 1]), 240.0)
    np.testing.assert_allclose(curve.mean, 20)
    np.testing.assert_allclose((curve.lowest, curve.highest), [[15] * 3, [25] * 3])
    np.testing.assert_allclose(curve.height, [0, 120, 240])


def test_turned_shape_is_the_same_skin_seen_from_another_front():
    """Turning twice by half is turning once; r(theta - t) on the skin; girths stay."""
    leg = Leg.from_alphas(237.6, shipped_basis().mean)
    shape = Shape(leg, leg)
    once, twice = shape.turned(0.3), shape.turned(0.15).turned(0.15)
    np.testing.assert_allclose(once.scanned.coefficients, twice.scanned.coefficients, atol=1e-10)
    np.testing.assert_allclose(
        once.scanned.surface(1.0 - 0.3, 120.0)[:2],
        np.array([[np.cos(0.3), np.sin(0.3)], [-np.sin(0.3), np.cos(0.3)]])
        @ leg.surface(1.0, 120.0)[:2],
        atol=1e-8,
    )
    np.testing.assert_allclose(once.scanned.girth(leg.z), leg.girth(leg.z), rtol=1e-9)
    np.testing.assert_allclose(shape.turned(0.0).fitted.alphas, leg.alphas, atol=1e-3)


def test_errors_of_the_points():
    """B is told better than C, and a pressure that is carried up worse than one that is read."""
    assert 0.05 < reading_error("B", False) < reading_error("C", False) < 0.25
    assert reading_error("C", True) > reading_error("C", False)
    assert reading_error("D", True) > reading_error("C", False)
