"""Bandages on mandrels, cones and a soft tube: what they answer, and what they must.

Each function solves one problem and returns (ours, exact) or what a check looks at; tests
put tolerances on them, `benchmarks/verification_contact.py` prints them. Fabric without
cross contraction and with next to no bending stiffness. Units: N, mm, MPa, pressures in mmHg.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from ..bandage.fabric import Fabric
from ..bandage.products import NOMINAL, at_tension
from ..contact.law import ContactLaw
from ..contact.padding import Padding
from ..equilibrium.newton import Tolerances
from ..outputs.pressure_map import MMHG
from ..surfaces.rigid import Mandrel
from ..tissue.mesh import cylindrical_surface, leg_mesh
from ..wrapping.spiral import Wrap
from .mandrel import Band, MandrelProblem, Ring, ring_wrap, rings_on_tube, wrap_mandrel


def limp(tension: float) -> Fabric:
    """A fabric of a tension (N/mm at stretch 1.3) and nothing else to speak of."""
    return replace(at_tension(tension, NOMINAL), nu12=0.0, F1=1e-4, F2=1e-4, tau12=1e-4)


class Pressed(NamedTuple):
    """Mean pressure (mmHg) and its standard deviation over the mean."""

    mean: float
    scatter: float


def band_on_cylinder(tension: float, r: float = 45.0, width: float = 20.0) -> Pressed:
    """V2: one layer on a rigid cylinder; exact: Laplace's law T / r."""
    ring = wrap_mandrel(
        Mandrel(r, r), ring_wrap(width), limp(tension), ContactLaw(0.0), 48, 4, ring=True
    )
    u = ring.slide_to_rest()
    p = ring.skin.report(u)["p"]
    force = np.sum(p * ring.skin.points.area)
    return Pressed(float(force / (2 * np.pi * r * width) / MMHG), float(p.std() / p.mean()))


def spiral_on_cylinder(per_turn: int = 44, layers: int = 2, penalty: float = 0.15) -> float:
    """V2 and V4: mean over a turn (mmHg) of so many layers, 100 mm wide, on r = 45 mm.

    Upper layers reach the skin only through lower ones.
    """
    wrap, turns = _spiral(layers), 2 * layers
    spiral = wrap_mandrel(
        Mandrel(45, 45),
        wrap,
        limp(0.098),
        ContactLaw(0.2, penalty),
        turns * per_turn,
        20,
        between=ContactLaw(0.6, penalty),
    )
    return _mean_over_a_turn(spiral, spiral.slide_to_rest(), wrap, per_turn)


def spiral_exactly(layers: int = 2) -> tuple[float, float]:
    """n T cos^2(beta) / r for n = layers and for n = width / (pitch cos(beta)), mmHg.

    tan(beta) = pitch / (2 pi r); turns are pitch cos(beta) apart, so that the mean over a turn
    has 2.03 layers at pitch 50 mm.
    """
    return _helix_pressure(0.098, layers)


def two_bandages_on_cylinder(per_turn: int = 28) -> tuple[float, float]:
    """V2 of two bandages, the second over the first and round the other way: ours, exact, mmHg.

    Tensions 0.098 and 0.137 N/mm; exact is the sum of n T cos^2(beta) / r.
    """
    wrap = _spiral(2)
    problem = wrap_mandrel(
        Mandrel(45, 45),
        wrap,
        limp(0.098),
        ContactLaw(0.2),
        4 * per_turn,
        20,
        between=ContactLaw(0.6),
        over=[Band(replace(wrap, reversed=True), limp(0.137), 4 * per_turn, 20)],
    )
    exact = sum(_helix_pressure(tension, 2)[1] for tension in (0.098, 0.137))
    return _mean_over_a_turn(problem, problem.slide_to_rest(), wrap, per_turn), exact


class OnPadding(NamedTuple):
    """A band over padding: thickness of the padding (mm), stretch, pressure on the body (mmHg)."""

    thickness: float
    stretch: float
    pressure: float


def band_on_padding(
    laid_under: float, loose: float = 4.0, stiffness: float = 3e-4
) -> tuple[OnPadding, OnPadding]:
    """V16: a band of 0.098 N/mm over padding on a rigid cylinder r = 45 mm: ours, exact.

    laid_under  pressure at which the padding has the thickness over which the band is laid, MPa.

    Exact: T / (r + h) = P0 ((h0 / h)^3 - 1), T = K1 (1.3 (r + h) / (r + h laid) - 1). The body
    feels T / r.
    """
    r, width, tension = 45.0, 20.0, 0.098
    padding = Padding.laid_under(laid_under, loose, stiffness)
    wrap = replace(ring_wrap(width), above=padding.laid)
    ring = wrap_mandrel(
        Mandrel(r, r), wrap, limp(tension), ContactLaw(0.0, padding=padding), 48, 4, ring=True
    )
    u = ring.slide_to_rest()
    middle = np.column_stack([np.arange(48) + 0.5, np.full(48, 2.0)])
    field = ring.shell.at(u, middle)
    radius = np.linalg.norm(field.point[:, :2], axis=1).mean()
    pressure = ring.carried(u) / (2 * np.pi * r * width) / MMHG
    found = OnPadding(float(radius - r), float(field.warp_stretch.mean()), float(pressure))

    def stretch(h):
        return 1.3 * (r + h) / (r + padding.laid)

    def off(h):
        carried = stiffness * ((loose / h) ** 3 - 1)
        return tension / 0.3 * (stretch(h) - 1) / (r + h) - carried

    h = brentq(off, 0.1, loose)
    exact = OnPadding(h, stretch(h), tension / 0.3 * (stretch(h) - 1) / r / MMHG)
    return found, exact


def _spiral(layers: int) -> Wrap:
    """2 n turns: those in the middle lie under and over as many others as they can."""
    return Wrap(0, 200, 100 / layers, 1.3, 100, 0.02)


def _mean_over_a_turn(spiral: MandrelProblem, u: np.ndarray, wrap: Wrap, per_turn: int) -> float:
    """Mean pressure (mmHg) on r = 45 mm under the turn in the middle of the first bandage."""
    skin, columns = spiral.skin, spiral.strip.nw + 2
    row, middle = skin.points.nodes[:, 0] // columns, wrap.turns / 2
    turn = (row >= (middle - 0.5) * per_turn) & (row < (middle + 0.5) * per_turn)
    force = np.sum((skin.report(u)["p"] * skin.points.area)[turn])
    return float(force / (2 * np.pi * 45 * wrap.pitch) / MMHG)


def _helix_pressure(tension: float, layers: int) -> tuple[float, float]:
    beta = np.arctan(100 / layers / (2 * np.pi * 45))
    whole = layers * tension * np.cos(beta) ** 2 / 45 / MMHG
    return float(whole), float(whole / np.cos(beta))


class String(NamedTuple):
    """A frictionless string on an ellipse, each relative.

    tension  range of the tension over its mean
    mean     of |p / (T kappa) - 1|
    worst    of the same
    """

    tension: float
    mean: float
    worst: float


def string_on_ellipse(a: float, b: float) -> String:
    """V5: exact are a uniform tension T and p = T kappa at every point."""
    ring = wrap_mandrel(
        Mandrel(a, b), ring_wrap(10), limp(0.098), ContactLaw(0.0), 96, 2, ring=True
    )
    u = ring.slide_to_rest()
    report = ring.skin.report(u)
    middle = np.column_stack([np.arange(96) + 0.5, np.ones(96)])
    tension = ring.shell.fabric.tension(ring.shell.at(u, middle).warp_stretch)
    off = np.abs(report["p"] / (tension.mean() * curvature(a, b, report["xi"][:, 0])) - 1)
    return String(float(np.ptp(tension) / tension.mean()), float(off.mean()), float(off.max()))


def curvature(a: float, b: float, angle):
    """Of the ellipse (a cos, b sin) at a parameter angle, 1/mm."""
    return a * b / (a**2 * np.sin(angle) ** 2 + b**2 * np.cos(angle) ** 2) ** 1.5


def capstan(mu: float) -> float:
    """V6: T2 / T1 over half a turn once the whole strip slides; exact exp(mu pi) (Euler 1769)."""
    rope = wrap_mandrel(
        Mandrel(40, 40), Wrap(0, 1e-9, 2e-9, 1.1, 10, 1e-3), limp(0.098), ContactLaw(mu), 60, 2
    )
    problem, u = rope.problem, np.zeros(rope.X.size)
    rope.skin.slide(u)
    last = np.arange(rope.strip.size).reshape(62, 4)[-2:].ravel()
    for angle in 0.03 * np.arange(1, 13):
        c, s = np.cos(angle), np.sin(angle)
        turned = rope.X[last] @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])
        u = u.copy()
        u.reshape(-1, 3)[last] = turned - rope.X[last]
        problem.viscosity.coefficient, problem.viscosity.origin = 1e-8, u
        u, _ = problem.newton(u)
        rope.skin.accept(u)
    field = rope.shell.at(u, np.column_stack([np.arange(60) + 0.5, np.ones(60)]))
    theta = np.unwrap(np.arctan2(field.point[:, 1], field.point[:, 0]))
    tension = rope.shell.fabric.tension(field.warp_stretch)
    inner = slice(5, 55)
    return float(np.exp(np.pi * np.polyfit(theta[inner], np.log(tension[inner]), 1)[0]))


def slide_down_cone(alpha: float, share: float, tension: float, radius: float) -> float:
    """V7: how far (mm) a hoop slides down a cone at mu = share tan(alpha) in eight steps.

    Exact: it rests when share is above 1 and never does below, whatever T and r.
    """
    limits = Tolerances(force=1e-7, passing=1e-4, rest=1e-9, steps=8, viscosity=(1e-4, 0.5))
    hoop = wrap_mandrel(
        Mandrel(radius, radius, np.tan(alpha)),
        ring_wrap(20, height=60.0),
        limp(tension),
        ContactLaw(share * np.tan(alpha)),
        48,
        4,
        ring=True,
        tolerances=limits,
    )
    u = np.zeros(hoop.X.size)
    hoop.skin.slide(u)
    for _ in range(8):
        hoop.problem.viscosity.coefficient, hoop.problem.viscosity.origin = 1e-4, u
        u, _ = hoop.problem.newton(u)
        hoop.skin.accept(u)
    return float(np.ptp([0.0, u.reshape(-1, 3)[:, 2].min()]))


def stretches_on_cone(alpha: float = 0.1) -> tuple[np.ndarray, np.ndarray]:
    """V7: stretch of lower edge, midline and upper edge as laid, ours and exact.

    Exact is 1.3 (1 + y sin(alpha) / r), y from the midline.
    """
    hoop = wrap_mandrel(
        Mandrel(40, 40, np.tan(alpha)),
        ring_wrap(20, height=60.0),
        limp(0.098),
        ContactLaw(0.2),
        48,
        4,
        ring=True,
    )
    at = np.column_stack([np.full(3, 20.5), [0.0, 2.0, 4.0]])
    field = hoop.shell.at(np.zeros(hoop.X.size), at)
    radius = np.linalg.norm(field.point[1, :2])
    return field.warp_stretch, 1.3 * (1 + np.array([-10, 0, 10]) * np.sin(alpha) / radius)


class OnTube(NamedTuple):
    """A band on a soft tube: radius (mm), stretch, pressure (mmHg), its scatter over its mean."""

    radius: float
    stretch: float
    pressure: float
    scatter: float


def band_on_soft_tube(K1: float) -> OnTube:
    """V3 through contact, V8 curved: T = K1 (b / r0 - 1), p = T / b on a tube of c10 = 5 kPa.

    Bandage and skin do not match: 44 rows on 36 cells round the tube, 5 on 4 along it.
    `thick_cylinder.hooped_exactly` has the answer; its pressure is uniform.
    """
    return bands_on_soft_tube(K1)[0]


def bands_on_soft_tube(*K1: float) -> list[OnTube]:
    """V3 of bands over each other, the innermost first, each with the pressure beneath it.

    Their meshes match neither the skin nor each other. `thick_cylinder.banded_exactly` has the
    answer: p_i = (T_i + T_(i+1) + ...) / b.
    """
    mesh = leg_mesh(
        cylindrical_surface(47.0), cylindrical_surface(15.0), np.linspace(0, 20, 5), 36, 10
    )
    fabrics = [replace(limp(0.3 * one), F1=0.01, F2=0.01, tau12=0.01) for one in K1]
    meshes = [(44, 5), (50, 6), (40, 5)]
    rings = [Ring(fabric, *size) for fabric, size in zip(fabrics, meshes, strict=False)]
    problem, _ = rings_on_tube(mesh, rings, 0.005, 14.3, ContactLaw(0.2))
    start, _ = problem.problem.newton(np.zeros(problem.X.size))
    u = problem.slide_to_rest(start)
    skin = (problem.X + u.reshape(-1, 3))[mesh.skin[:, 2]]
    radius = float(np.linalg.norm(skin[:, :2], axis=1).mean())
    found = []
    for ring, shell, contact in zip(rings, problem.shells, problem.problem.contacts, strict=True):
        middle = np.column_stack([np.arange(ring.ns) + 0.5, np.full(ring.ns, ring.nw / 2)])
        p = contact.report(u)["p"]
        force = np.sum(p * contact.points.area)
        found.append(
            OnTube(
                radius,
                float(shell.at(u, middle).warp_stretch.mean()),
                float(force / (2 * np.pi * radius * 20) / MMHG),
                float(p.std() / p.mean()),
            )
        )
    return found
