"""Fields whose pattern moves: pulses and edges with known displacements."""

import numpy as np
import pytest
from scipy.stats import qmc

from surrogate.errors import FitError
from surrogate.fitting.fit import fit, q2
from surrogate.regressors.drift import drift
from surrogate.regressors.gaussian_process import GaussianProcess
from surrogate.regressors.registered import Registered
from surrogate.regressors.warps import Basis, Rows, origins, register
from surrogate.space.distributions import uniform
from surrogate.space.space import Parameter, Space

TIMES = np.linspace(0.0, 1.0, 101)
SPACE = Space(tuple(Parameter(name, uniform(-1.0, 1.0)) for name in ("x1", "x2")))


def points(n, seed):
    return 2.0 * qmc.Sobol(2, seed=seed).random(64)[:n] - 1.0


def arrivals(x):
    """When the pulse comes: late with x1, and not in a straight line with x2."""
    return 0.5 + 0.22 * x[:, 0] + 0.05 * x[:, 1] ** 2


def pulses(x, width=0.025):
    """Pulses of a width that is small beside their shifts; their height hangs on x2."""
    return (1.0 + 0.3 * x[:, 1:]) * np.exp(-(((TIMES - arrivals(x)[:, None]) / width) ** 2))


@pytest.fixture(scope="module")
def fits():
    coded = points(40, seed=1)
    return {
        registered: fit(SPACE, coded, pulses(coded), GaussianProcess(registration=registered))
        for registered in (False, True)
    }


def test_pulses_that_move_in_time_are_learnt_when_they_are_registered(fits):
    """Modes alone cannot follow a pulse; aligned ones are of rank one, by their formula."""
    new = points(64, seed=2)
    modes, registered = (q2(pulses(new), fits[key].predict(new)) for key in (False, True))
    assert modes < 0.8
    assert registered > 0.995
    assert fits[True].q2 > 0.98 > fits[False].q2
    assert len(fits[True].estimator.aligned_.modes_) < 8 < len(fits[False].estimator.modes_)


def test_drift_is_the_shift_and_stretch_of_the_inputs():
    """f = pulse((t - 1/2 - 0.2 x1) exp(-0.3 x2)): shift 0.2 of x1, stretch 0.3 of x2."""
    x = points(64, seed=3)
    place = (TIMES - 0.5 - 0.2 * x[:, :1]) * np.exp(-0.3 * x[:, 1:])
    fields = np.exp(-((place / 0.08) ** 2)) - 0.5 * np.exp(-(((place - 0.2) / 0.05) ** 2))
    found, lowered = drift(x, fields[:, None], TIMES)
    np.testing.assert_allclose(found.shift, [0.2, 0.0], atol=0.01)
    np.testing.assert_allclose(found.stretch, [0.0, 0.3], atol=0.02)
    assert lowered < 0.5
    np.testing.assert_allclose(
        found.back(x, found.forth(x, TIMES)), np.tile(TIMES, (64, 1)), atol=1e-14
    )


def test_a_displacement_is_found_and_undone():
    """A field read at r + u(r) is aligned, to a fifth of u: smoothness costs a part of it."""
    grid = np.linspace(0.0, 1.0, 81)
    shift = 0.02 * np.sin(2.0 * np.pi * grid) * np.cos(np.linspace(0.0, 1.0, 12))[:, None]
    template = np.sin(14.0 * grid) + np.zeros((1, 12, 1))
    at = origins(grid, shift[None], grid[None, None])
    np.testing.assert_allclose(at + _lines(grid, shift, at), grid + 0.0 * at, atol=1e-10)
    fields = Rows.through(grid, np.sin(14.0 * at))
    basis = Basis.of((12,), 81)
    found = register(fields, template, basis, np.zeros((1, 10, 12)))
    inside = slice(8, -8)
    np.testing.assert_allclose(
        basis.displacements(found)[0][:, inside], shift[:, inside], atol=0.2 * 0.02
    )


def _lines(grid, shift, at):
    return np.array([np.interp(one, grid, row) for one, row in zip(at[0], shift, strict=True)])


def test_intervals_of_a_registered_field_hold_new_runs(fits):
    """95 % intervals, uncertain places of the pulse included, hold at least 90 % of its values."""
    new = points(64, seed=2)
    low, high = fits[True].interval(new)
    slack = 1e-3
    inside = (pulses(new) >= low - slack) & (pulses(new) <= high + slack)
    assert inside.mean() > 0.9
    assert (high - low).max() < 1.0


def test_indices_of_a_registered_field_are_those_of_its_modes(fits):
    """Both have the runs' fields; what moves does not change whose variance it is."""
    mine, plain = (fits[key].estimator.sobol_indices() for key in (True, False))
    np.testing.assert_allclose(mine.total, plain.total, atol=1e-12)


def test_a_registered_field_says_that_it_cannot_be_exported(fits):
    with pytest.raises(FitError, match="take `registration` out of the surrogate's options"):
        fits[True].portable()


def test_the_dimension_that_the_pattern_moves_along_is_found():
    """A front along the second of two dimensions; the first has its own, fixed profile."""
    coded = points(40, seed=1)
    front = np.tanh((TIMES[::2] - arrivals(coded)[:, None]) / 0.03)
    fields = front[:, None, :] * (1.0 + np.linspace(0.0, 1.0, 9))[None, :, None]
    found = Registered(GaussianProcess()).fit(coded, fields)
    assert found.axis_ == 1
    new = points(64, seed=2)
    expected = np.tanh((TIMES[::2] - arrivals(new)[:, None]) / 0.03)
    assert q2(expected, found.predict(new)[:, 0]) > 0.99


def test_a_field_that_does_not_vary_stays_as_it_is():
    coded = points(10, seed=1)
    found = Registered(GaussianProcess()).fit(coded, np.tile(np.sin(TIMES), (10, 1)))
    np.testing.assert_allclose(found.predict(coded[:3]), np.tile(np.sin(TIMES), (3, 1)), atol=1e-12)
