"""Geometries as polynomials: exact where they are polynomials, and their error is told."""

import numpy as np
import pytest
from shown import Beam, Hollow

from surrogate.errors import FitError
from surrogate.fitting.geometry import geometry
from surrogate.scene import Scene
from surrogate.space.distributions import distribution, uniform
from surrogate.space.space import Parameter, Space
from surrogate.stages.scene import scene
from surrogate_solvers.leg_bandage.plugin import LegBandage

SPACE = Space(
    (
        Parameter("colour", uniform(0.0, 1.0)),
        Parameter("length", uniform(0.5, 2.0), unit="m"),
        Parameter("load", uniform(0.0, 100.0), unit="N"),
    )
)


def scene_at(solver, space, coded, fixed=None):
    values = {name: column[0] for name, column in space.decode(coded[None]).items()}
    return solver.scene(**{**(fixed or {}), **values})


def test_a_polynomial_geometry_is_exact():
    """load * length^3 bends the beam: degree four in two parameters, colour moves nothing."""
    found = geometry(Beam().scene, SPACE, {})
    assert found.active == (1, 2)
    for coded in np.random.default_rng(1).uniform(-1, 1, (20, 3)):
        own = scene_at(Beam(), SPACE, coded).parts
        for mine, its in zip(found.at(coded), own, strict=True):
            assert np.abs(mine - its).max() < 1e-9 * found.size
    assert found.parts[0].error < 1e-9


def test_a_geometry_that_nothing_moves_is_kept_as_it_is():
    space = Space((Parameter("colour", uniform(0.0, 1.0)),))
    found = geometry(Beam().scene, space, {"load": 10.0, "length": 1.0})
    assert found.active == ()
    own = Beam().scene(load=10.0, length=1.0, colour=0.5)
    assert np.array_equal(found.at(np.array([0.3]))[0], own.parts[0])


def test_the_error_of_a_curved_geometry_is_told():
    """A circle's arc is no polynomial of its angle; new points miss by no more than told."""

    def arc(angle):
        at = angle * np.linspace(0, 1, 6)
        points = np.column_stack([np.cos(at), np.sin(at), np.zeros(6)])
        return Scene(points, [[0, 1, 2], [3, 4, 5]])

    space = Space((Parameter("angle", uniform(0.0, 2 * np.pi)),))
    found = geometry(arc, space, {})
    error = found.parts[0].error
    assert 1e-9 < error < 1e-2
    seen = [
        np.abs(found.at(coded)[0] - scene_at(_Of(arc), space, coded).parts[0]).max()
        for coded in np.random.default_rng(2).uniform(-0.99, 0.99, (50, 1))
    ]
    assert max(seen) < 3 * error


class _Of:
    def __init__(self, scene):
        self.scene = scene


def test_unbounded_and_categorical_parameters_have_a_geometry():
    def block(height, kind):
        size = {"low": 1.0, "mid": 3.0, "high": 2.0}[kind]
        return Scene([[0, 0, 0], [size, 0, 0], [0, size, height]], [[0, 1, 2]])

    space = Space(
        (
            Parameter("height", distribution("normal", mean=5.0, std=1.0)),
            Parameter("kind", levels=("low", "mid", "high")),
        )
    )
    found = geometry(block, space, {})
    for kind in (-1.0, 0.0, 1.0):
        coded = np.array([0.2, kind])
        own = scene_at(_Of(block), space, coded).parts[0]
        assert np.abs(found.at(coded)[0][:, :2] - own[:, :2]).max() < 1e-6


def test_the_leg_is_exact():
    """Its skin is linear in the shape modes and in its length, so quadratic in both."""
    solver = LegBandage(mesh="coarse")
    space = Space(
        (
            Parameter("leg_length", uniform(185.0, 290.0), unit="mm"),
            Parameter("alpha1", uniform(-0.9, -0.5)),
            Parameter("alpha2", uniform(-0.07, 0.11)),
            Parameter("tension", uniform(0.06, 0.13), unit="N/mm"),
        )
    )
    fixed = {name: one.nominal for name, one in solver.inputs.items() if name not in space.names}
    found = geometry(solver.scene, space, fixed)
    assert found.active == (0, 1, 2)
    assert found.parts[0].error < 1e-9
    coded = np.array([0.7, -0.6, 0.4, 0.0])
    own = scene_at(solver, space, coded, fixed).parts
    skin, rim, turns, sensor = found.at(coded)
    assert np.abs(skin - own[0]).max() < 1e-9
    assert np.abs(rim - own[1]).max() < 0.2  # degrees, and parts of the length
    assert np.abs(turns - own[2]).max() < 2.0


def test_too_few_points_with_a_geometry_cost_the_geometry_only():
    with pytest.raises(FitError, match="have a geometry|has a geometry"):
        geometry(Hollow().scene, SPACE, {})
    assert scene(Hollow().scene, SPACE, {}).startswith("The geometry is not shown: ")
    assert scene(None, SPACE, {}) is None


def test_a_broken_scene_costs_the_geometry_only():
    def broken(**inputs):
        raise ZeroDivisionError("division by zero")

    assert scene(broken, SPACE, {}) == (
        "The geometry is not shown: `scene` raised ZeroDivisionError: division by zero."
    )
