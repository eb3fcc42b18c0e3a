"""What tests of the bandage share: the command, and problems that are solved once in a session."""

import sys

import pytest

from surrogate_solvers.leg_bandage import cli
from surrogate_solvers.leg_bandage.equilibrium.model import MESHES, Mesh
from surrogate_solvers.leg_bandage.plugin import LegBandage


class Solutions:
    """`LegBandage._solve` that solves equal problems once.

    A problem is all that `_solve` takes: mesh, ends, skin, wrap, materials. That two solutions
    of one problem agree to the last digit is a test of its own.
    """

    def __init__(self):
        self._solve, self._solved = LegBandage._solve, {}

    def __call__(self, solver, leg, wrap, material, wrapping, further=()):
        key = (
            *(solver.mesh, solver.ends, solver.solver, wrap, material, wrapping, further),
            *(leg.length, leg.coefficients.tobytes(), leg.centre.tobytes()),
            *(leg.below, leg.above, leg.trend),
        )
        if key not in self._solved:
            model, u = self._solve(solver, leg, wrap, material, wrapping, further)
            self._solved[key] = model, u, model.problem.state()
        model, u, state = self._solved[key]
        model.problem.restore(state)
        return model, u


@pytest.fixture(scope="session")
def _solutions():
    return Solutions()


@pytest.fixture
def solved_once(_solutions, monkeypatch):
    """`LegBandage` takes the solutions of equal problems from earlier tests."""
    monkeypatch.setattr(LegBandage, "_solve", lambda self, *problem: _solutions(self, *problem))


@pytest.fixture
def result(solved_once):
    """One coarse run on the mean leg."""
    return LegBandage(mesh="coarse").run()


@pytest.fixture
def rough(monkeypatch):
    """Mesh "rough", half as fine as "coarse": for claims that hold on every mesh."""
    monkeypatch.setitem(MESHES, "rough", Mesh(12, 1, 12, 6))


@pytest.fixture
def rough_result(rough, solved_once):
    """One rough run on the mean leg."""
    return LegBandage(mesh="rough").run()


@pytest.fixture
def command(monkeypatch, capsys):
    """Runs the command; returns exit status, standard output, standard error."""

    def run(*words):
        monkeypatch.setattr(sys, "argv", ["leg-bandage", *map(str, words)])
        with pytest.raises(SystemExit) as stop:
            cli.main()
        return stop.value.code or 0, *capsys.readouterr()

    return run
