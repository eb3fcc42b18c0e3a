"""The published model at its own figures (Chassagne et al. 2018, Tables II and III)."""

import pytest

from surrogate.errors import SolverError
from surrogate_solvers.chassagne2018 import MEAN, SLOPES, Chassagne2018

solver = Chassagne2018()
CENTRE = {name: given.nominal for name, given in solver.inputs.items()}


def pressure(**changed):
    return solver(**{**CENTRE, **changed})["pressure_b1"]


def test_centre_is_the_mean():
    """Table III: 32.73 mmHg with every parameter at the centre of Table II."""
    assert pressure() == pytest.approx(32.73, abs=1e-12)


@pytest.mark.parametrize(
    "name, effect",
    [
        ("mu_skin", 2.7),
        ("tension", 11.54),
        ("leg_length", 2.85),
        ("alpha1", 4.54),
        ("alpha2", 3.92),
        ("alpha3", -1.74),
        ("alpha4", -0.51),
    ],
)
def test_effect_of_each_parameter(name, effect):
    """Table III: from the centre to either end of the range."""
    low, high = solver.inputs[name].range
    assert pressure(**{name: high}) - MEAN == pytest.approx(effect, abs=1e-12)
    assert pressure(**{name: low}) - MEAN == pytest.approx(-effect, abs=1e-12)


def test_variance_shares_of_the_published_coefficients():
    """Uniform inputs: share b_i^2 / sum b^2; skin friction and tension together 74.8 %."""
    total = sum(slope**2 for slope in SLOPES.values())
    assert SLOPES["tension"] ** 2 / total == pytest.approx(0.708926, abs=1e-6)
    assert SLOPES["alpha1"] ** 2 / total == pytest.approx(0.109724, abs=1e-6)


@pytest.mark.parametrize(
    "name, value", [("tension", 0.2), ("mu_skin", -0.1), ("alpha1", float("nan"))]
)
def test_outside_the_published_ranges(name, value):
    """The model is not extrapolated."""
    with pytest.raises(SolverError, match=f"{name}: .*not between"):
        pressure(**{name: value})
