"""The bandage's elastic constants and its named presets."""

from dataclasses import replace

import numpy as np
import pytest

from surrogate.errors import SolverError
from surrogate_solvers.leg_bandage.bandage.fabric import WRINKLING, Fabric
from surrogate_solvers.leg_bandage.bandage.products import BANDAGES, NOMINAL, at_tension, bandage

CURVE = ((1.0, 0.0), (1.1, 0.05), (1.3, 0.098), (1.6, 0.13), (1.7, 0.2))
REST = dict(K2=0.1, nu12=0.3, G=0.05, F1=0.01, F2=0.01, tau12=0.01)


def test_membrane_stiffness_inverts_the_orthotropic_compliance():
    """Chassagne et al. 2018, equation 5: strain = [[1/K1, -nu12/K1], [-nu12/K1, 1/K2]] N."""
    fabric = Fabric(K1=0.33, **REST)
    Q11, Q12, Q22 = fabric.membrane
    compliance = np.array([[1 / 0.33, -0.3 / 0.33], [-0.3 / 0.33, 1 / 0.1]])
    np.testing.assert_allclose([[Q11, Q12], [Q12, Q22]] @ compliance, np.eye(2), atol=1e-14)


def test_secant_tension_is_exact_at_stretch_1_3():
    """Chassagne et al. 2018, equation 10: T = K1 (stretch - 1) with K1 = T(1.3) / 0.3."""
    for tension in (0.059, 0.098, 0.137):
        assert at_tension(tension).tension(1.3) == pytest.approx(tension, rel=1e-14)


def test_tension_curve_passes_through_its_points_and_rises_smoothly():
    """Fritsch and Carlson 1980: the interpolant of rising data rises; it is C1 throughout."""
    fabric = Fabric(K1=0.33, curve=CURVE, **REST)
    stretch, tension = np.array(CURVE).T
    np.testing.assert_allclose(fabric.tension(stretch), tension, atol=1e-15)
    fine = np.linspace(0.8, 2.0, 4801)
    values = fabric.tension(fine)
    assert np.all(np.diff(values) > 0)
    slope = np.diff(values) / np.diff(fine)
    assert np.abs(np.diff(slope)).max() < 0.01


def test_warp_force_and_slope_are_derivatives():
    """Central differences of warp energy and force, with and without a curve."""
    stretch = np.array([0.95, 1.05, 1.2, 1.45, 1.66, 1.9])
    for fabric in (Fabric(K1=0.33, **REST), Fabric(K1=0.33, curve=CURVE, **REST)):
        ahead, behind = (fabric.warp_energy(stretch + h) for h in (1e-5, -1e-5))
        np.testing.assert_allclose(
            fabric.warp_force(stretch)[0], (ahead - behind) / 2e-5, rtol=1e-7
        )
        ahead, behind = (fabric.warp_force(stretch + h)[0] for h in (1e-6, -1e-6))
        np.testing.assert_allclose(
            fabric.warp_force(stretch)[1], (ahead - behind) / 2e-6, rtol=1e-7
        )


def test_curve_is_scaled_to_the_asked_tension():
    """A scaled curve keeps its stretches and meets the tension at 1.3."""
    fabric = at_tension(0.06, Fabric(K1=0.33, curve=CURVE, **REST))
    assert fabric.tension(1.3) == pytest.approx(0.06, rel=1e-14)
    assert [point[0] for point in fabric.curve] == [point[0] for point in CURVE]


@pytest.mark.parametrize("name", sorted(BANDAGES))
def test_named_bandages_lie_in_the_printed_range_and_say_what_is_assumed(name):
    """Chassagne et al. 2018, Table I: 0.059..0.137 N/mm; nothing else is printed."""
    found = bandage(name)
    assert 0.059 <= found.fabric.tension(1.3) <= 0.137
    assert {"K1", "K2", "nu12", "G", "F1", "F2", "tau12", "thickness"} <= set(found.sources)
    assert all(text.startswith("assumed") for text in found.sources.values())


def test_bending_pressure_is_negligible():
    """F1 / r^3 at r = 45 mm is about 0.004 mmHg: bending hardly presses."""
    assert NOMINAL.F1 / 45**3 / 1.33322e-4 == pytest.approx(0.004, abs=0.001)


@pytest.mark.parametrize(
    ("values", "word"),
    [
        ({"K1": 0.0}, "K1"),
        ({"K2": 0.1, "nu12": 2.0}, "nu12"),
        ({"F12": 0.05}, "F12"),
        ({"curve": ((1.0, 0.1), (1.1, 0.2), (1.2, 0.3))}, "start"),
        ({"curve": ((1.0, 0.0), (1.1, 0.2), (1.2, 0.1))}, "rising"),
    ],
)
def test_impossible_fabrics_are_refused_with_the_reason(values, word):
    """The sentence names the constant and what it must be."""
    with pytest.raises(SolverError, match=word):
        Fabric(**{"K1": 0.33, **REST, **values})


def test_unknown_bandage_names_the_nearest():
    """A misspelt name is answered with the right one."""
    with pytest.raises(SolverError, match="did you mean 'biflex_16'"):
        bandage("biflex16")


@pytest.mark.parametrize("curve", [(), ((1.0, 0.0), (1.2, 0.03), (1.5, 0.2))])
def test_wrinkled_fabric_keeps_tension_and_loses_compression(curve):
    """Force and stiffness are derivatives of the energy; in tension nothing changes.

    Fully wrinkled, the stiffness is the stated share of what it was at stretch 1, and
    the force has lost (1 - share) K1 (e^2 / (4 d)) up to e = -2 d, with d = WRINKLING.
    """
    plain = replace(NOMINAL, curve=curve)
    soft = replace(plain, wrinkled=0.05)
    stretch = np.linspace(0.8, 1.4, 241)
    force, slope = soft.warp_force(stretch)
    h = 1e-6
    energy = (soft.warp_energy(stretch + h) - soft.warp_energy(stretch - h)) / (2 * h)
    forces = (soft.warp_force(stretch + h)[0] - soft.warp_force(stretch - h)[0]) / (2 * h)
    smooth = np.abs(stretch - 1) > 1e-3
    assert np.allclose(energy[smooth], force[smooth], atol=1e-8)
    assert np.allclose(forces[smooth], slope[smooth], atol=1e-5)
    tense = stretch >= 1
    assert np.array_equal(force[tense], plain.warp_force(stretch[tense])[0])
    first = plain._tension_and_slope(np.array([1.0]))[1][0]
    assert soft._tension_and_slope(np.array([0.9]))[1][0] == pytest.approx(0.05 * first)
    assert soft.tension(0.96) == pytest.approx(first * (-0.04 + 0.95 * 0.02))


@pytest.mark.parametrize("curve", [(), CURVE])
def test_force_is_the_derivative_of_the_energy_while_wrinkling(curve):
    """Both the wrinkling range, 0 to -2 WRINKLING of strain, and what lies beyond it.

    There the wrinkled fabric stores less energy than the plain one, by what it spares.
    """
    plain = replace(NOMINAL, curve=curve)
    soft = replace(plain, wrinkled=0.05)
    stretch = 1 - WRINKLING * np.array([0.2, 0.7, 1.3, 1.8, 2.5, 4.0, 10.0])
    h = 1e-6
    ahead, behind = soft.warp_energy(stretch + h), soft.warp_energy(stretch - h)
    np.testing.assert_allclose(soft.warp_force(stretch)[0], (ahead - behind) / (2 * h), rtol=1e-6)
    assert np.all(soft.warp_energy(stretch) < plain.warp_energy(stretch))
