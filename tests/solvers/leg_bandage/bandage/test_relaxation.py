"""Prony series and the memory of a fabric, against its own definition."""

import numpy as np
import pytest

from surrogate.errors import SolverError
from surrogate_solvers.leg_bandage.bandage.memory import Memory
from surrogate_solvers.leg_bandage.bandage.products import NOMINAL, STRETCH, bandage
from surrogate_solvers.leg_bandage.bandage.relaxation import RELAXATIONS, Relaxation
from surrogate_solvers.leg_bandage.bandage.shell import Shell
from surrogate_solvers.leg_bandage.surfaces.strip import Strip


def force_of(memory: Memory, elastic):
    """N at the end of the step that the memory is in."""
    return memory.share * elastic + memory.carried


@pytest.mark.parametrize("steps", [[240.0], [1.0, 9.0, 80.0, 150.0], [60.0] * 4])
def test_a_held_stretch_relaxes_as_g_whatever_the_steps(steps):
    """g(240 min) of every kind of bandage, to rounding."""
    held = np.array([2.0, -0.3, 0.1])[:, None, None]
    for series in RELAXATIONS.values():
        memory = Memory.of(series, held)
        for step in steps:
            memory = memory.waiting(step).after(held)
        np.testing.assert_allclose(force_of(memory, held), series.at(240.0) * held, rtol=1e-13)


def test_a_force_that_rises_evenly_is_convolved_exactly():
    """N = c [g_inf t + sum g_i tau_i (1 - exp(-t / tau_i))] for N_e = c t."""
    series = Relaxation((0.3, 0.2), (5.0, 60.0))
    one = np.ones((3, 1, 1))
    memory = Memory.of(series, 0 * one)
    for step, now in ((4.0, 4.0), (26.0, 30.0)):
        memory = memory.waiting(step).after(now * one)
    exact = 0.5 * 30 + sum(
        g * tau * (1 - np.exp(-30 / tau)) for g, tau in zip((0.3, 0.2), (5.0, 60.0), strict=True)
    )
    assert force_of(memory, 30 * one).ravel() == pytest.approx([exact] * 3, rel=1e-13)


def test_a_change_at_once_is_elastic():
    """Standing up after four hours adds the elastic force, nothing relaxed."""
    held = np.full((3, 1, 1), 2.0)
    memory = Memory.of(RELAXATIONS["inelastic"], held).waiting(240.0).after(held)
    rise = force_of(memory, held + 0.5) - force_of(memory, held)
    np.testing.assert_allclose(rise, 0.5, rtol=1e-13)


def test_tangent_of_a_step_agrees_with_differences():
    """The tangent of a relaxing strip is that of its forces, to 1e-6 of its largest entry."""
    strip = Strip(3, 2)
    rng = np.random.default_rng(4)
    cells = np.stack(np.meshgrid(np.arange(5) - 0.5, np.arange(4) - 0.5, indexing="ij"), -1)
    flat = cells.reshape(-1, 2) * [13.0, 10.0]
    start = np.column_stack([flat, rng.normal(0, 0.2, len(flat))])
    shell = Shell(strip, (30.0, 20.0), NOMINAL, start, slack=False)
    u = rng.normal(0, 0.2, start.size)
    shell.relaxing(u, RELAXATIONS["inelastic"])
    shell.wait(30.0)
    u = u + rng.normal(0, 0.2, start.size)
    _, tangent = shell.linearise(u)
    matrix = np.zeros((start.size, start.size))
    np.add.at(matrix, (shell.rows, shell.cols), tangent())
    for dof in (0, 13, 31, 59):
        h = 1e-5 * np.eye(start.size)[dof]
        slope = (shell.linearise(u + h)[0] - shell.linearise(u - h)[0]) / 2e-5
        np.testing.assert_allclose(matrix[:, dof], slope, atol=1e-6 * np.abs(matrix).max())


def test_published_sizes():
    """Cotton loses 40 % in eight hours, most of it in the first quarter (Kumar et al. 2013)."""
    cotton = RELAXATIONS["inelastic"]
    assert cotton.at(480.0) == pytest.approx(0.60, abs=0.005)
    assert 1 - cotton.at(15.0) > (1 - cotton.at(480.0)) / 2
    assert RELAXATIONS["elastic"].at(480.0) > 0.85


@pytest.mark.parametrize(
    ("shares", "times"), [((0.5, 0.6), (1.0, 2.0)), ((0.1,), (0.0,)), ((0.1,), (1.0, 2.0))]
)
def test_series_that_cannot_be_are_refused(shares, times):
    """More than all lost, no time, a share without a time."""
    with pytest.raises(SolverError, match="relaxation"):
        Relaxation(shares, times)


def test_an_inelastic_bandage_locks():
    """Its slope at stretch 1.3 is 2.3 times the secant's, and grows."""
    curve = np.array(bandage("short_stretch").curve)
    at = np.searchsorted(curve[:, 0], STRETCH - 1e-9)
    slopes = np.diff(curve[:, 1]) / np.diff(curve[:, 0])
    assert curve[at, 1] == pytest.approx(1.0)
    assert slopes[at - 1 : at + 1].mean() * (STRETCH - 1) == pytest.approx(2.3, abs=0.05)
    assert np.all(np.diff(slopes) > 0)
