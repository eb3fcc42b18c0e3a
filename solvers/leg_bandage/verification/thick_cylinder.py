"""A thick soft cylinder in plane strain: pressed from outside, or by an elastic hoop band.

The tissue's answers are axisymmetric, so the exact ones come from one radial equation. The
annulus is meshed as a leg is, one element high. Units: N, mm, MPa.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.integrate import solve_bvp
from scipy.optimize import brentq
from scipy.optimize import newton as scalar_newton
from scipy.sparse import csr_array, eye_array, kron

from ..bandage.fabric import Fabric
from ..bandage.shell import Shell
from ..surfaces.strip import Strip
from ..tissue.mesh import LegMesh, cylindrical_surface, leg_mesh
from ..tissue.neo_hooke import Tissue
from .follower_pressure import skin_pressure
from .newton import held, newton

INNER, OUTER, KAPPA = 15.0, 47.0, 14.3
HEIGHT = 5.0


class Pressed(NamedTuple):
    """Radial displacements (mm) of hole and outside, and Newton's corrections (mm)."""

    inner: float
    outer: float
    corrections: tuple[float, ...] = ()


class Hoop(NamedTuple):
    """Outer radius (mm), stretch of the band, and its pressure (MPa)."""

    radius: float
    stretch: float
    pressure: float


def pressed_exactly(pressure: float, c10: float, pinned: bool = False) -> Pressed:
    """Radial equilibrium dP_R/dR + (P_R - P_T) / R = 0 of the compressible neo-Hookean tube.

    P_R, P_T are nominal stresses; the outer edge carries P_R = -pressure r / R, the hole is
    free or pinned. Solved by collocation to 1e-9.
    """

    def stresses(R, r, radial):
        hoop = r / R
        J = radial * hoop
        mean = (radial**2 + hoop**2 + 1) / 3
        shear = 2 * c10 * J ** (-2 / 3)
        pull = KAPPA * (J - 1)
        return shear * (radial - mean / radial) + pull * hoop, (
            shear * (hoop - mean / hoop) + pull * radial
        )

    def rates(R, y):
        r, nominal = y
        radial = scalar_newton(lambda x: stresses(R, r, x)[0] - nominal, R / r, tol=1e-14)
        return np.array([radial, (stresses(R, r, radial)[1] - nominal) / R])

    def ends(inside, outside):
        hole = inside[0] - INNER if pinned else inside[1]
        return np.array([hole, outside[1] + pressure * outside[0] / OUTER])

    R = np.linspace(INNER, OUTER, 41)
    found = solve_bvp(rates, ends, R, np.array([R, np.full_like(R, -pressure)]), tol=1e-9)
    return Pressed(found.y[0, 0] - INNER, found.y[0, -1] - OUTER)


def pressed(
    pressure: float, c10: float, pinned: bool = False, n_theta: int = 64, n_depth: int = 16
) -> Pressed:
    """The same tube by finite elements, the whole pressure in one step from rest."""
    leg = annulus(n_theta, n_depth)
    basis = held(leg.n_dofs, plane_strain_dofs(leg, pinned))
    parts = [Tissue(leg.mesh, c10, KAPPA), skin_pressure(leg, pressure)]
    u, corrections = newton(parts, basis)
    places = leg.mesh.p.T + u.reshape(-1, 3)
    inner, outer = (
        np.hypot(*places[nodes.ravel(), :2].T).mean() for nodes in (leg.nodes[:, 0], leg.skin)
    )
    return Pressed(inner - INNER, outer - OUTER, tuple(corrections))


def hooped_exactly(K1: float, layers: int, rest: float, c10: float) -> Hoop:
    """Layers of hoop band of rest radius `rest` on the incompressible annulus, hole free."""
    b = _banded(((layers * K1, rest),), c10)
    return Hoop(b, b / rest, layers * K1 * (b / rest - 1) / b)


def banded_exactly(bands: Sequence[tuple[float, float]], c10: float) -> list[Hoop]:
    """Hoop bands (K1, rest radius) over each other, the innermost first, pressure beneath each.

    A thin band of tension T_i on radius b carries T_i / b of the pressure beneath it to that
    above, p_i = p_(i+1) + T_i / b, so that p_i = (T_i + T_(i+1) + ...) / b.
    """
    b = _banded(bands, c10)
    shares = np.array([K1 * (b / rest - 1) / b for K1, rest in bands])
    beneath = np.cumsum(shares[::-1])[::-1]
    return [Hoop(b, b / rest, float(p)) for (_, rest), p in zip(bands, beneath, strict=True)]


def _banded(bands: Sequence[tuple[float, float]], c10: float) -> float:
    """Outer radius (mm) at which the annulus holds the bands.

    Balance of p = sum of K1 (b / rest - 1) / b with the annulus's outside pressure
    p = -mu [ln(R / r) + d / (2 r^2)] taken from hole to outside, d = R^2 - r^2, mu = 2 c10.
    """

    def outside_pressure(b):
        d = OUTER**2 - b**2
        a = np.sqrt(INNER**2 - d)
        rise = np.log(OUTER / b) + d / (2 * b**2) - np.log(INNER / a) - d / (2 * a**2)
        return -2 * c10 * rise

    def band_pressure(b):
        return sum(K1 * (b / rest - 1) / b for K1, rest in bands)

    smallest = np.sqrt(OUTER**2 - INNER**2)
    return float(
        brentq(lambda b: outside_pressure(b) - band_pressure(b), smallest + 1e-3, OUTER, xtol=1e-12)
    )


def hooped(
    K1: float,
    layers: int,
    rest: float,
    c10: float,
    kappa: float = KAPPA,
    n_theta: int = 48,
    n_depth: int = 12,
) -> Hoop:
    """The same by tissue and shell bonded together, in one step from the undeformed tube.

    The strip closes on itself: its control points follow the skin nodes, which are the
    midpoints of its elements.
    """
    leg = annulus(n_theta, n_depth)
    strip = Strip(n_theta, 1, offset=leg.mesh.nvertices)
    follow = csr_array(kron(bonded(leg, strip), eye_array(3)))
    start = (follow @ leg.mesh.p.T.ravel()).reshape(-1, 3)
    stiffness = layers * K1
    fabric = Fabric(stiffness, stiffness, 0.0, stiffness, 1e-9, 1e-9, 1e-9)
    band = Shell(strip, (2 * np.pi * rest, HEIGHT), fabric, start)
    tissue = Tissue(leg.mesh, c10, kappa, start.size)
    basis = csr_array(follow @ held(leg.n_dofs, plane_strain_dofs(leg, False)))
    u, _ = newton([tissue, band], basis)
    places = (start + u.reshape(-1, 3))[leg.skin.ravel()]
    radius, stretch = np.hypot(*places[:, :2].T).mean(), band.strains(u)[0].mean()
    return Hoop(radius, stretch, stiffness * (stretch - 1) / radius)


def annulus(n_theta: int, n_depth: int) -> LegMesh:
    """The tube, one element high, with its finer layers at the hole."""
    return leg_mesh(
        cylindrical_surface(OUTER),
        cylindrical_surface(INNER),
        np.array([0, HEIGHT]),
        n_theta,
        n_depth,
        0.3,
    )


def plane_strain_dofs(leg: LegMesh, pinned: bool) -> np.ndarray:
    """No axial displacement, and two symmetry planes against rigid motion."""
    quarter = len(leg.theta) // 4
    across = 3 * leg.nodes[[0, 2 * quarter]].ravel() + 1, 3 * leg.nodes[quarter].ravel()
    return np.unique(np.concatenate([leg.fixed_dofs("no_axial", bone=pinned), *across]))


def bonded(leg: LegMesh, strip: Strip) -> csr_array:
    """Nodes and control points (leg nodes + control points, leg nodes) from leg nodes."""
    n_theta, n_nodes = len(leg.theta), leg.mesh.nvertices
    around = np.arange(n_theta)
    midpoint = np.zeros((n_theta, n_theta))
    for shift, weight in ((-1, 0.125), (0, 0.75), (1, 0.125)):
        midpoint[around, (around + shift) % n_theta] += weight
    ring = np.linalg.inv(midpoint)[(np.arange(n_theta + 2) - 1) % n_theta]
    across = np.array([[1.5, -0.5], [0.5, 0.5], [-0.5, 1.5]])
    control = np.zeros((n_theta + 2, 3, n_nodes))
    for k in range(2):
        control[:, :, leg.skin[:, k]] = ring[:, None, :] * across[:, k, None]
    return csr_array(np.vstack([np.eye(n_nodes), control.reshape(strip.size, n_nodes)]))
