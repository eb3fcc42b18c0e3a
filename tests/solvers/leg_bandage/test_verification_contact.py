"""Bandages on rigid mandrels against Laplace's law, the capstan and the cone.

Exact answers only; stiffness is the contact's, so that penetration costs 0.2 % at most.
"""

from dataclasses import replace

import numpy as np
import pytest

from solvers.leg_bandage.bandages import NOMINAL, at_tension
from solvers.leg_bandage.friction import ContactLaw
from solvers.leg_bandage.leg_mesh import leg_mesh, tube
from solvers.leg_bandage.outputs import MMHG
from solvers.leg_bandage.solution import Tolerances
from solvers.leg_bandage.surfaces import Mandrel
from solvers.leg_bandage.verification.flat_patch import MARGIN, SIDE, press, settlement_exactly
from solvers.leg_bandage.verification.mandrel import ring_on_tube, ring_wrap, wind
from solvers.leg_bandage.wrapping import Wrap


def fabric(tension):
    """A fabric without cross contraction and with next to no bending stiffness."""
    return replace(at_tension(tension, NOMINAL), nu12=0.0, F1=1e-4, F2=1e-4, tau12=1e-4)


@pytest.mark.parametrize("tension, mmhg", [(0.059, 9.835), (0.098, 16.335), (0.137, 22.835)])
def test_band_on_rigid_cylinder(tension, mmhg):
    """V2, Laplace's law p = T / r for one layer on r = 45 mm, uniform up to the edges."""
    ring = wind(Mandrel(45, 45), ring_wrap(20), fabric(tension), ContactLaw(0.0), 48, 4, ring=True)
    u = ring.let_go()
    report = ring.skin.report(u)
    force = np.sum(report["p"] * ring.skin.points.area)
    assert force / (2 * np.pi * 45 * 20) / MMHG == pytest.approx(mmhg, rel=4e-3)
    assert report["p"].std() < 0.01 * report["p"].mean()


def test_spiral_on_rigid_cylinder():
    """V2 and V4: two layers at pitch 50 on r = 45 press n T cos^2(beta) / r = 31.68 mmHg.

    tan(beta) = pitch / (2 pi r). Turns are pitch cos(beta) apart, so that the mean over a
    turn has n = width / (pitch cos(beta)) = 2.03 layers. Upper layers reach the skin only
    through lower ones.
    """
    per_turn, wrap = 44, Wrap(0, 200, 50, 1.3, 100, 0.02)
    spiral = wind(Mandrel(45, 45), wrap, fabric(0.098), ContactLaw(0.2), 4 * per_turn, 20,
                  between=ContactLaw(0.6))
    u = spiral.let_go()
    row = spiral.skin.points.nodes[:, 0] // 22
    turn = (row >= 1.5 * per_turn) & (row < 2.5 * per_turn)
    force = np.sum((spiral.skin.report(u)["p"] * spiral.skin.points.area)[turn])
    beta = np.arctan(50 / (2 * np.pi * 45))
    two_layers = 2 * 0.098 * np.cos(beta) ** 2 / 45 / MMHG
    assert two_layers == pytest.approx(31.68, abs=0.01)
    exact = two_layers * 100 / (50 * np.cos(beta)) / 2
    assert force / (2 * np.pi * 45 * 50) / MMHG == pytest.approx(exact, rel=4e-3)


@pytest.mark.parametrize("a, b, ends", [(50, 44, (37.97, 25.87)), (55, 40, (50.54, 19.44))])
def test_frictionless_string_on_an_ellipse(a, b, ends):
    """V5: without friction the tension is uniform and p = T curvature at every point."""
    ring = wind(Mandrel(a, b), ring_wrap(10), fabric(0.098), ContactLaw(0.0), 96, 2, ring=True)
    u = ring.let_go()
    report = ring.skin.report(u)
    middle = np.column_stack([np.arange(96) + 0.5, np.ones(96)])
    tension = ring.shell.fabric.tension(ring.shell.at(u, middle).warp_stretch)
    assert np.ptp(tension) < 5e-3 * tension.mean()

    def curvature(angle):
        return a * b / (a**2 * np.sin(angle) ** 2 + b**2 * np.cos(angle) ** 2) ** 1.5

    ratio = report["p"] / (tension.mean() * curvature(report["xi"][:, 0]))
    assert np.abs(ratio - 1).mean() < 4e-3 and np.abs(ratio - 1).max() < 2e-2
    assert 2 * 0.098 / MMHG * curvature(np.array([0, np.pi / 2])) == pytest.approx(ends, abs=0.01)


@pytest.mark.parametrize("mu, ratio", [(0.1, 1.3691), (0.2, 1.8745), (0.3, 2.5663)])
def test_capstan(mu, ratio):
    """V6, Euler 1769: T2 / T1 = exp(mu theta) once the whole strip slides."""
    half_turn = Wrap(0, 1e-9, 2e-9, 1.1, 10, 1e-3)
    rope = wind(Mandrel(40, 40), half_turn, fabric(0.098), ContactLaw(mu), 60, 2)
    problem, u = rope.problem, np.zeros(rope.X.size)
    rope.skin.release(u)
    last = np.arange(rope.strip.size).reshape(62, 4)[-2:].ravel()
    for angle in 0.03 * np.arange(1, 13):
        c, s = np.cos(angle), np.sin(angle)
        turned = rope.X[last] @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])
        u = u.copy()
        u.reshape(-1, 3)[last] = turned - rope.X[last]
        problem.viscosity.coefficient, problem.viscosity.origin = 1e-8, u
        u, _ = problem.newton(u)
        rope.skin.accept(u)
    middle = np.column_stack([np.arange(60) + 0.5, np.ones(60)])
    field = rope.shell.at(u, middle)
    theta = np.arctan2(field.point[:, 1], field.point[:, 0])
    tension = rope.shell.fabric.tension(field.warp_stretch)
    inner = slice(5, 55)
    slope = np.polyfit(np.unwrap(theta)[inner], np.log(tension[inner]), 1)[0]
    assert np.exp(slope * np.pi) == pytest.approx(ratio, rel=1e-2)


@pytest.mark.parametrize("tension, radius", [(0.098, 45.0), (0.137, 35.0)])
@pytest.mark.parametrize("alpha", [0.08, 0.12])
def test_hoop_on_a_cone_slides_below_tan_alpha(alpha, tension, radius):
    """V7: a hoop on a cone slides exactly when mu < tan(alpha), whatever T and r.

    10 % below, it is still creeping after eight steps at ever smaller viscosity; 10 %
    above, it rests after less than the elastic slip and its own settling.
    """
    limits = Tolerances(force=1e-7, passing=1e-4, rest=1e-9, steps=8, viscosity=(1e-4, 0.5))
    moved = {}
    for share in (0.9, 1.1):
        law = ContactLaw(share * np.tan(alpha))
        hoop = wind(Mandrel(radius, radius, np.tan(alpha)), ring_wrap(20, height=60.0),
                    fabric(tension), law, 48, 4, ring=True, tolerances=limits)
        u = np.zeros(hoop.X.size)
        hoop.skin.release(u)
        for _ in range(8):
            hoop.problem.viscosity.coefficient, hoop.problem.viscosity.origin = 1e-4, u
            u, _ = hoop.problem.newton(u)
            hoop.skin.accept(u)
        moved[share] = np.ptp([0.0, u.reshape(-1, 3)[:, 2].min()])
    assert moved[1.1] < 0.08
    assert moved[0.9] > 0.6


def test_edge_stretches_on_a_cone():
    """V7: stretch across the width is lambda0 (1 + y sin(alpha) / r), as laid."""
    hoop = wind(Mandrel(40, 40, np.tan(0.1)), ring_wrap(20, height=60.0), fabric(0.098),
                ContactLaw(0.2), 48, 4, ring=True)
    at = np.column_stack([np.full(3, 20.5), [0.0, 2.0, 4.0]])
    field = hoop.shell.at(np.zeros(hoop.X.size), at)
    radius = np.linalg.norm(field.point[1, :2])
    exact = 1.3 * (1 + np.array([-10, 0, 10]) * np.sin(0.1) / radius)
    assert np.allclose(field.warp_stretch, exact, rtol=1e-3)


@pytest.mark.parametrize("K1, radius, stretch, mmhg", [(0.196667, 46.70512, 1.291844, 9.2175)])
def test_hoop_band_in_contact_with_a_soft_tube(K1, radius, stretch, mmhg):
    """V3 through contact: a band on a soft annulus, T = K1 (b / r0 - 1), p = T / b.

    The same ring is the curved patch test V8: bandage and skin do not match (44 rows
    on 36 cells round the tube, 5 on 4 along it), and the exact pressure is uniform.
    """
    mesh = leg_mesh(tube(47.0), tube(15.0), np.linspace(0, 20, 5), 36, 10)
    cloth = replace(fabric(0.3 * K1), F1=0.01, F2=0.01, tau12=0.01)
    ring, _ = ring_on_tube(mesh, cloth, 0.005, 14.3, ContactLaw(0.2), 44, 5)
    start, _ = ring.problem.newton(np.zeros(ring.X.size))
    u = ring.let_go(start)
    field = ring.shell.at(u, np.column_stack([np.arange(44) + 0.5, np.full(44, 2.5)]))
    skin = (ring.X + u.reshape(-1, 3))[mesh.skin[:, 2]]
    assert np.linalg.norm(skin[:, :2], axis=1).mean() == pytest.approx(radius, abs=0.02)
    assert field.warp_stretch.mean() == pytest.approx(stretch, rel=1e-3)
    report = ring.skin.report(u)
    area = 2 * np.pi * np.linalg.norm(skin[:, :2], axis=1).mean() * 20
    force = np.sum(report["p"] * ring.skin.points.area)
    assert force / area / MMHG == pytest.approx(mmhg, rel=0.01)
    assert report["p"].std() < 0.02 * report["p"].mean()


@pytest.mark.parametrize("cells, elements, twist, settled", [
    ((8, 8, 3), (11, 9), 0.0, 0.03),
    ((8, 8, 3), (11, 9), 0.5, 0.03),
    ((6, 7, 3), (9, 10), 0.5, 0.03),
    ((16, 16, 4), (21, 19), 0.5, 0.01),
])
def test_flat_patch(cells, elements, twist, settled):
    """V8, flat: a uniform load on the strip reaches a soft block as a uniform pressure.

    Meshes do not match, and are turned against each other by up to `twist` rad (29 degrees).
    Pressure is uniform to 0.3 % rms and 2 % at every contact point. The skin's cubic passes
    1 / 24 of a cell's load over the strip's edge, so that the block sinks deeper than the
    exact uniaxial strain by 2 % on 8 cells and 0.6 % on 16: the settlement is a convergence,
    the pressure is the patch test. The floor carries the whole load.
    """
    load = 30 * MMHG
    patch = press(load, cells, elements, twist)
    off = patch.pressure / load - 1
    assert off.std() < 3e-3 and np.abs(off).max() < 2e-2
    sunk = patch.settlement / settlement_exactly(load) - 1
    assert abs(sunk.mean()) < settled and sunk.std() < 0.04
    area = np.prod([SIDE + 2 * MARGIN * SIDE / n for n in cells[:2]])
    assert patch.reaction == pytest.approx(load * area, rel=1e-3)
