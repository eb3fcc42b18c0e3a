"""Padding by van Wyk's law."""

import numpy as np
import pytest

from surrogate_solvers.leg_bandage.contact.law import ContactLaw
from surrogate_solvers.leg_bandage.contact.padding import Padding, thickness


def test_thickness_is_the_inverse_of_the_pressure():
    """p = P0 ((h0 / h)^3 - 1); half as thick carries seven P0."""
    assert thickness(7 * 3e-4, 4.0, 3e-4) == pytest.approx(2.0)
    padding = Padding.laid_under(4e-3, 4.0, 3e-4)
    p, _ = padding.pressure(np.zeros(1), np.zeros(1, bool))
    assert p[0] == pytest.approx(4e-3, rel=1e-12)


def test_slope_is_the_derivative_and_loose_padding_carries_nothing():
    """Against differences, flat padding and bonded padding that is lifted included."""
    padding = Padding(4.0, 3e-4, 1.5)
    gap = np.array([-1.3, -1.0, 0.0, 1.0, 2.4, 3.0])
    for bonded in (np.zeros(6, bool), np.ones(6, bool)):
        p, slope = padding.pressure(gap, bonded)
        step = (
            padding.pressure(gap + 1e-6, bonded)[0] - padding.pressure(gap - 1e-6, bonded)[0]
        ) / 2e-6
        assert step == pytest.approx(slope, rel=1e-6)
        assert (p[:-1] > 0).all() and (p[-1] < 0) == bonded[-1]


def test_the_law_of_contact_takes_the_padding_in_place_of_the_penalty():
    """Friction stays Coulomb's on the padding's pressure."""
    padding = Padding(4.0, 3e-4, 1.5)
    gap = np.linspace(-1, 3, 9)
    law = ContactLaw(0.2, padding=padding)
    open_ = np.zeros(9, bool)
    assert np.array_equal(law.pressure(gap, open_)[0], padding.pressure(gap, open_)[0])
