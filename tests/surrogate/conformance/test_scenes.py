"""The check of solvers tells what is wrong with a geometry."""

from dataclasses import replace

import numpy as np
import pytest
from shown import Beam, Hollow

from surrogate.conformance import check_solver
from surrogate.errors import PluginError
from surrogate.scene import Line, Mark
from surrogate_solvers.laplace import Laplace
from surrogate_solvers.leg_bandage.plugin import LegBandage


class Changed(Beam):
    """The beam with a part of its scene replaced."""

    def __init__(self, **parts):
        self.parts = parts

    def scene(self, **inputs):
        return replace(super().scene(**inputs), **self.parts)


class Growing(Beam):
    """A beam of more points the longer it is."""

    def scene(self, load, length, colour):
        made = super().scene(load, length, colour)
        more = np.vstack([made.points] * (1 + int(length > 1.0)))
        coordinates = {k: np.resize(v, len(more)) for k, v in made.coordinates.items()}
        return replace(made, points=more, coordinates=coordinates)


@pytest.mark.parametrize("solver", (Beam(), Laplace()))
def test_solvers_with_a_geometry_pass(solver):
    check_solver(solver)


def test_the_contact_model_has_a_geometry_that_passes():
    check_solver(LegBandage(mesh="coarse"), runs=0)


@pytest.mark.parametrize(
    ("parts", "told"),
    (
        ({"points": np.zeros((27, 2))}, "give (n, 3)"),
        ({"triangles": [[0, 1, 99]]}, "name point 99; there are 27"),
        ({"triangles": [[0, 1]]}, "give (m, 3)"),
        ({"unit": "smoots"}, "pint does not know the unit 'smoots'"),
        ({"coordinates": {"x": [1.0]}}, "coordinate x has shape (1,)"),
        ({"periods": {"angle": 360.0}}, "there is no such coordinate"),
        ({"fields": ("sag",)}, "field sag: the solver has no such output"),
        ({"fields": ("tip",)}, "a number cannot colour a surface"),
        ({"coordinates": {}}, "its dimension x is no coordinate"),
        ({"lines": (Line("edge", [1.0, 2.0, 3.0]),)}, "line 'edge' has shape (3,)"),
        ({"lines": (Line("edge", [[np.nan] * 3]),)}, "a place is not finite"),
        ({"marks": (Mark("tip", [0.0, 0.0, 0.0], "bend"),)}, "no output that is one number"),
        ({"views": {}}, "it has no view"),
    ),
)
def test_every_mistake_is_a_sentence(parts, told):
    with pytest.raises(PluginError) as caught:
        check_solver(Changed(**parts), picklable=False)
    assert told in str(caught.value)


def test_too_many_points_are_refused():
    many = np.zeros((5001, 3))
    solver = Changed(points=many, coordinates={"x": many[:, 0], "y": many[:, 0]})
    with pytest.raises(PluginError, match="5001 points are more than a page turns in time"):
        check_solver(solver)


def test_only_places_may_follow_the_inputs():
    with pytest.raises(PluginError, match="only places may follow the inputs"):
        check_solver(Growing())


def test_a_point_may_be_without_a_geometry_but_not_the_nominal_one():
    with pytest.raises(PluginError, match="scene at the nominal point raised SolverError"):
        check_solver(Hollow())
