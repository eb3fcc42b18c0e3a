"""Contact laws: formulas at their joints and slopes as derivatives."""

import numpy as np
import pytest

from surrogate_solvers.leg_bandage.contact.law import ContactLaw

LAW = ContactLaw(mu=0.2, penalty=0.15, ramp=0.1, elastic_slip=0.05)


def test_pressure_is_a_penalty_with_a_smooth_start():
    """p = eps (-g) below -d, 0 above d, eps d / 4 at 0; dp/dg is its derivative."""
    gap = np.array([-0.3, -0.1, 0.0, 0.1, 0.4])
    p, _ = LAW.pressure(gap, bonded=np.zeros(5, bool))
    assert p == pytest.approx([0.045, 0.015, 0.15 * 0.1 / 4, 0.0, 0.0])
    g = np.linspace(-0.3, 0.3, 101) + 1e-4
    up, _ = LAW.pressure(g + 1e-7, np.zeros(101, bool))
    down, _ = LAW.pressure(g - 1e-7, np.zeros(101, bool))
    assert LAW.pressure(g, np.zeros(101, bool))[1] == pytest.approx((up - down) / 2e-7, abs=1e-7)


def test_held_points_pull_as_well_as_push():
    """p = -eps g on both sides."""
    p, slope = LAW.pressure(np.array([-0.1, 0.1]), np.array([True, True]))
    assert p == pytest.approx([0.015, -0.015]) and slope == pytest.approx([-0.15, -0.15])


def test_friction_saturates_at_coulomb():
    """psi(s) s = y (2 - y), y = s / e, then 1; psi' is its derivative; what stays is e."""
    slip = np.array([0.0125, 0.025, 0.05, 0.5, 3.0])
    psi, bend = LAW.friction_factor(slip)
    assert psi * slip == pytest.approx([0.4375, 0.75, 1.0, 1.0, 1.0])
    h = 1e-8
    numeric = (
        LAW.friction_factor(slip[[0, 1, 3, 4]] + h)[0]
        - LAW.friction_factor(slip[[0, 1, 3, 4]] - h)[0]
    ) / (2 * h)
    assert bend[[0, 1, 3, 4]] == pytest.approx(numeric, rel=1e-5)
    assert LAW.kept(slip) * slip == pytest.approx(np.minimum(slip, 0.05))
