"""Newton, cut-backs and the way to rest, on a ring round a rigid cylinder."""

import gc
import weakref
from dataclasses import replace

import numpy as np
import pytest

from surrogate_solvers.leg_bandage.bandage.products import at_tension
from surrogate_solvers.leg_bandage.contact.law import ContactLaw
from surrogate_solvers.leg_bandage.equilibrium.newton import NotConverged, Problem, Tolerances
from surrogate_solvers.leg_bandage.equilibrium.pseudo_transient import pseudo_transient
from surrogate_solvers.leg_bandage.surfaces.rigid import Mandrel
from surrogate_solvers.leg_bandage.verification.mandrel import ring_wrap, wrap_mandrel


@pytest.fixture
def ring():
    """A band on an elliptic cylinder, free to slide but not yet in equilibrium."""
    wrapped = wrap_mandrel(
        Mandrel(50, 44),
        ring_wrap(20),
        at_tension(0.098),
        ContactLaw(0.2),
        48,
        4,
        ring=True,
        tolerances=Tolerances(force=1e-9, passing=1e-9),
    )
    wrapped.skin.slide(np.zeros(wrapped.X.size))
    return wrapped


def test_newton_ends_quadratically(ring, monkeypatch):
    """V11: near the end the order of convergence is above 1.7 (rounding left out)."""
    problem, sizes = ring.problem, []
    problem.viscosity.coefficient = 1e-4
    measured = Problem._size
    monkeypatch.setattr(
        Problem, "_size", lambda self, r: sizes.append(measured(self, r)) or sizes[-1]
    )
    problem.newton(np.zeros(ring.X.size))
    assert sizes[-1] < 1e-9
    last = [size for size in sizes if size > 1e-10][-3:]
    assert np.log(last[2] / last[1]) < 1.7 * np.log(last[1] / last[0])


def test_a_failed_step_is_undone_and_repeated_with_more_viscosity(ring, monkeypatch):
    """Cut-back: state restored, viscosity raised, the same end reached."""
    before = ring.problem.state()
    whole, _ = pseudo_transient(ring.problem, np.zeros(ring.X.size), 1e-3)
    ring.problem.restore(before)
    calls, newton = [], Problem.newton

    def shaky(self, u, force=None):
        calls.append(self.viscosity.coefficient)
        if len(calls) == 2:
            self.contacts[0].accept(u + 0.1)
            raise NotConverged(1.0, 0)
        return newton(self, u, force)

    monkeypatch.setattr(Problem, "newton", shaky)
    u, viscous_traction = pseudo_transient(ring.problem, np.zeros(ring.X.size), 1e-3)
    assert calls[2] > calls[1]
    assert viscous_traction < ring.problem.tolerances.rest
    assert np.abs(u - whole).max() < 0.01
    assert ring.problem.cost.cut_backs == 1


class Factors:
    """Something large in a step."""


@pytest.mark.parametrize("largest", [0.5, 0.0])
def test_what_a_failed_step_held_goes_with_it(ring, monkeypatch, largest):
    """Without the garbage collector, after a run that recovers and after one that fails.

    largest: viscosity that may be tried, MPa/mm.
    """
    problem, newton, held = ring.problem, Problem.newton, []
    problem.tolerances = replace(problem.tolerances, viscosity=(1e-6, largest))

    def shaky(self, u, force=None):
        factors = Factors()
        held.append(weakref.ref(factors))
        if len(held) == 2:
            raise NotConverged(1.0, 0)
        return newton(self, u, force)

    monkeypatch.setattr(Problem, "newton", shaky)
    gc.disable()
    try:
        if largest:
            pseudo_transient(problem, np.zeros(ring.X.size), 1e-3)
        else:
            with pytest.raises(NotConverged, match="residual 1"):
                pseudo_transient(problem, np.zeros(ring.X.size), 1e-3)
        assert len(held) >= 2 and all(factors() is None for factors in held)
    finally:
        gc.enable()


def test_no_steps_left_is_not_rest(ring):
    """Steps that run out raise; a moving bandage is never returned."""
    ring.problem.tolerances = Tolerances(steps=1)
    with pytest.raises(NotConverged):
        pseudo_transient(ring.problem, np.zeros(ring.X.size), 1e-3)
