"""Wrapping: a strip of true width and the asked stretch, turn upon turn."""

from dataclasses import replace

import numpy as np
import pytest

from surrogate.errors import SolverError
from surrogate_solvers.leg_bandage.equilibrium.model import MESHES, mesh_leg
from surrogate_solvers.leg_bandage.equilibrium.progressive import deformed_skin
from surrogate_solvers.leg_bandage.geometry.basis import shipped_basis
from surrogate_solvers.leg_bandage.geometry.bone import bone_envelope
from surrogate_solvers.leg_bandage.geometry.leg import Leg
from surrogate_solvers.leg_bandage.surfaces.rigid import Mandrel
from surrogate_solvers.leg_bandage.verification.mandrel import around
from surrogate_solvers.leg_bandage.wrapping.lay import element_rows, lay, mirrored
from surrogate_solvers.leg_bandage.wrapping.spiral import Wrap, wrap_for

CYLINDER = around(Mandrel(45, 45))
SPIRAL = Wrap(0, 200, 50, 1.3, 100, 0.5)


def test_helix_on_a_cylinder():
    """Unrolled, the strip is a rectangle: true width, right angles, length of the helix.

    Lines across keep their heading in space, not on the surface: 0.02 % of the rise.
    """
    bare = replace(SPIRAL, thickness=1e-6)
    laid = lay(CYLINDER, bare, 176, 20)
    helix = np.hypot(200, 4 * 2 * np.pi * 45)
    assert laid.lengths.sum() == pytest.approx(helix / 1.3, rel=1e-4)
    corners = np.array([[80.0, 0.0], [80.0, 20.0], [80.0, 10.0]])
    jet = laid.strip.at(corners, laid.X)
    beta = np.arctan(50 / (2 * np.pi * 45))
    rise = jet[1, 0, 2] - jet[0, 0, 2]
    assert rise == pytest.approx(100 * np.cos(beta), rel=3e-4)
    cosine = jet[2, 1] @ jet[2, 2] / np.linalg.norm(jet[2, 1]) / np.linalg.norm(jet[2, 2])
    assert abs(cosine) < 5e-4


def test_stretch_along_the_midline_is_as_asked_on_a_leg():
    """The lifted midline has stretch 1.3 in every row; rows have the same rest length."""
    leg = Leg.from_alphas(237.9, shipped_basis().mean).extended(85, 25)
    wrap = wrap_for(237.9, overlap=0.5, thickness=0.7)
    laid = lay(leg.surface, wrap, element_rows(leg.surface, wrap, 24), 12)
    rows = np.column_stack([np.arange(laid.strip.ns) + 0.5, np.full(laid.strip.ns, 6.0)])
    stretch = np.linalg.norm(laid.strip.at(rows, laid.X)[:, 1], axis=1) / laid.lengths.mean()
    assert stretch == pytest.approx(1.3, rel=0.02)
    assert stretch.mean() == pytest.approx(1.3, rel=2e-3)


@pytest.mark.parametrize("overlap, layers", [(0.5, 2.0), (2 / 3, 3.0)])
def test_number_of_layers(overlap, layers):
    """Half overlap gives two layers, two thirds three, away from the ends and the edges."""
    wrap = replace(SPIRAL, pitch=100 * (1 - overlap))
    laid = lay(CYLINDER, wrap, int(44 * wrap.turns), 12)
    middle = slice(laid.strip.ns // 2 - 20, laid.strip.ns // 2 + 20)
    top = laid.layers[middle, 2]
    assert top == pytest.approx(layers, abs=0.05)
    assert laid.cover[middle, -2] == pytest.approx(0, abs=1e-6)


def test_a_turn_lies_one_thickness_above_the_turn_beneath():
    """Where it is wholly covered, a point is lifted by 3/2 thicknesses, its support by 1/2."""
    laid = lay(CYLINDER, SPIRAL, 176, 20)
    whole = laid.cover > 1 - 1e-9
    whole[:100] = False
    above = laid.strip.at(laid.points[whole], laid.X)[:, 0]
    beneath = laid.strip.at(laid.beneath[0].xi[whole], laid.X)[:, 0]
    radius = [np.linalg.norm(p[:, :2], axis=1) for p in (above, beneath)]
    deep = (laid.beneath[0].xi[whole][:, 1] > 11.5) & (laid.beneath[0].xi[whole][:, 1] < 18)
    assert deep.sum() > 50
    assert (radius[0] - radius[1])[deep] == pytest.approx(0.5, abs=0.02)


def test_layers_do_not_hang_on_where_elements_end():
    """A turn covers 1 - q of the next and 1 - 2 q of the one after, q = pitch cos(beta) / width.

    An edge of the turn beneath lies between two elements (even numbers) or amid one (odd).
    """
    q = 0.5 / np.hypot(1, 50 / (2 * np.pi * 45))
    expected = 1 + (1 - q) + (1 - 2 * q)
    for nw in (10, 11, 12, 13):
        laid = lay(CYLINDER, SPIRAL, 176, nw)
        middle = slice(66, 110)
        mean = np.average(laid.layers[middle], weights=laid.area[middle])
        assert mean == pytest.approx(expected, abs=0.01)


def test_areas_of_contact_points_add_up():
    """The points' shares of area make up the laid strip (exact for a uniform density)."""
    laid = lay(CYLINDER, replace(SPIRAL, thickness=1e-6), 176, 20)
    helix = np.hypot(200, 4 * 2 * np.pi * 45)
    assert laid.area.sum() == pytest.approx(helix * 100, rel=1e-3)


def test_the_other_way_round_is_the_mirror_image():
    """On a leg and on its mirror image; X and skin are mirrored, everything else is the same."""
    leg = Leg.from_alphas(237.9, shipped_basis().mean).extended(85, 25)
    wrap = wrap_for(237.9, overlap=0.5, thickness=0.7)
    laid = lay(mirrored(leg.surface), wrap, 60, 8)
    back = lay(leg.surface, replace(wrap, reversed=True), 60, 8)
    assert np.allclose(laid.X * [1, -1, 1], back.X)
    assert np.array_equal(back.theta, -laid.theta) and back.strip.flip
    assert np.array_equal(back.layers, laid.layers)


def test_a_bandage_lies_over_all_that_is_beneath():
    """Two bandages of half overlap make four layers, and shares of what carries add up to one."""
    first = lay(CYLINDER, SPIRAL, 176, 10)
    for way in (False, True):
        wrap = replace(SPIRAL, reversed=way, thickness=1.0)
        second = lay(CYLINDER, wrap, 176, 12, [first])
        middle = slice(75, 101)
        layers = second.layers[middle, 2]
        assert layers.min() == pytest.approx(4) and layers.mean() < 4.1
        assert second.cover[middle] == pytest.approx(1, abs=1e-6)
        four = middle.start + np.flatnonzero(layers < 4 + 1e-9)
        top = second.strip.at(second.points[four, 2], second.X)[:, 0]
        assert np.linalg.norm(top[:, :2], axis=1) == pytest.approx(45 + 2 * 0.5 + 1.5, abs=0.02)


def test_too_short_a_leg():
    """A leg that takes less than one turn is refused with the number of turns."""
    with pytest.raises(SolverError, match="0.7 turns"):
        wrap_for(75.0, overlap=0.5)


def test_deformed_skin_is_the_leg_when_nothing_has_moved():
    """The bicubic skin of the medium mesh (10 degrees, 10 mm) against the leg's own surface.

    The shin is its sharpest place; the mean distance is what the pressure sees.
    """
    leg = Leg.from_alphas(237.9, shipped_basis().mean).extended(85, 25)
    mesh = mesh_leg(leg, bone_envelope(leg), MESHES["medium"])
    surface = deformed_skin(mesh, np.zeros(mesh.n_dofs))
    rng = np.random.default_rng(0)
    theta, z = rng.uniform(0, 12, 200), rng.uniform(-50, 230, 200)
    off = np.linalg.norm(surface(theta, z) - leg.surface(theta, z), axis=1)
    assert off.max() < 0.4 and off.mean() < 0.05
    for order in ((1, 0), (0, 1)):
        exact = leg.surface(theta, z, *order)
        slope = np.abs(surface(theta, z, *order) - exact)
        assert slope.max() < 0.2 * np.abs(exact).max() and slope.mean() < 0.01 * np.abs(exact).max()
