"""Shell problems with known answers: pinched cylinder, cantilever, off-axis tension.

The strip's uniform splines have control points beyond its edges; symmetry and support
conditions mirror them, with the sign that makes value or slope vanish. Units: N, mm, MPa.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.linalg import spsolve

from ..bandage.fabric import Fabric
from ..bandage.shell import Shell
from ..surfaces.strip import Strip, interpolate_strip
from .newton import held, newton, tangent_matrix


def isotropic(E: float, nu: float, thickness: float) -> Fabric:
    """A homogeneous isotropic sheet."""
    D = E * thickness**3 / 12 / (1 - nu**2)
    K = E * thickness
    return Fabric(K, K, nu, K / 2 / (1 + nu), D, D, D * (1 - nu) / 2, nu * D, thickness)


def laid(strip: Strip, size, surface=None) -> np.ndarray:
    """Control points (n, 3) of a strip laid on surface(s, w) -> (..., 3); default: flat."""
    s, w = (
        (np.arange(-1, n + 1) + 0.5) * extent / n
        for n, extent in zip((strip.ns, strip.nw), size, strict=True)
    )
    s, w = np.meshgrid(s, w, indexing="ij")
    if surface is None:
        return np.stack([s, w, np.zeros_like(s)], axis=-1).reshape(-1, 3)
    return interpolate_strip(surface(s, w)).reshape(-1, 3)


def pinched_cylinder(n: int) -> float:
    """Deflection under the load times E t / P, one eighth with n x n elements, linear.

    R = 300, L = 600, t = 3, E = 3e6, nu = 0.3, ends on rigid diaphragms. Reference 164.24
    (Belytschko et al. 1985, after the series of Lindberg, Olson and Cowper 1969).
    """
    R, L, E, t = 300.0, 600.0, 3e6, 3.0
    size = np.pi / 2 * R, L / 2
    strip = Strip(n, n)
    start = laid(
        strip, size, lambda s, w: np.stack([R * np.sin(s / R), w, R * np.cos(s / R)], axis=-1)
    )
    shell = Shell(strip, size, isotropic(E, 0.3, t), start)
    shell = Shell(strip, size, shell.fabric, start, natural=shell.strains(np.zeros(start.size)))
    basis = mirrored(
        strip,
        [
            Edge(axis=0, last=False, odd=(0,), even=(1, 2)),
            Edge(axis=0, last=True, odd=(2,), even=(0, 1)),
            Edge(axis=1, last=False, odd=(0, 2)),
            Edge(axis=1, last=True, odd=(1,), even=(0, 2)),
        ],
    )
    nodes, weights = (found[..., 0, :] for found in strip.stencil(np.array([[0.0, n]])))
    load = np.zeros(start.size)
    load[3 * nodes + 2] = -weights[0] / 4
    _, tangent = shell.linearise(np.zeros(start.size))
    K = basis.T @ tangent_matrix([shell], [tangent()], start.size) @ basis
    u = basis @ spsolve(K.tocsc(), basis.T @ load)
    return float(-weights[0] @ u[3 * nodes + 2] * E * t)


def cantilever(n: int, load: float = 4.0, steps: int = 10) -> np.ndarray:
    """Displacement (3,) of the tip of a strip 10 x 1 x 0.1, E = 1.2e6, sheared at its end.

    n elements along, one across; load in N, whole at `steps` increments. Reference for
    load = 4 N, that is P L^2 / (E I) = 4: (-3.286, 0, 6.698) mm (Sze, Liu and Lo 2004).
    """
    size = 10.0, 1.0
    strip = Strip(n, 1)
    start = laid(strip, size)
    shell = Shell(strip, size, isotropic(1.2e6, 0.0, 0.1), start, slack=False)
    clamped = 3 * np.arange(2 * 3)[:, None] + np.arange(3)
    basis = held(start.size, clamped.ravel())
    tip = np.array([[n, 0.5]])
    nodes, weights = (found[..., 0, :] for found in strip.stencil(tip))
    pull, u = np.zeros(start.size), None
    pull[3 * nodes + 2] = load * weights[0]
    for step in range(steps):
        u, _ = newton([shell], basis, pull * (step + 1) / steps, u)
    return (weights[0] @ u.reshape(-1, 3)[nodes]).ravel()


def off_axis_modulus(fabric: Fabric, angle: float, n: int = 4) -> float:
    """Stiffness (N/mm) seen by a small tension at `angle` (rad) to the warp, on a free patch.

    The tension enters as the dead load of a uniform stress on the patch's edges.
    """
    size = 20.0, 20.0
    strip = Strip(n, n)
    start = laid(strip, size)
    shell = Shell(strip, size, fabric, start)
    pull = np.array([np.cos(angle), np.sin(angle), 0])
    tension = 1e-7 * fabric.K1
    load = np.zeros(start.shape)
    for slope, direction in zip(shell.slopes[:2], pull[:2], strict=True):
        share = tension * direction * np.einsum("q,qa->a", shell.weights, slope)
        np.add.at(load, shell.points, share[:, None] * pull)
    plane = 3 * np.arange(len(start)) + 2
    corner = [0, 1, 3 * (len(start) - strip.nw - 2) + 1]
    u, _ = newton([shell], held(start.size, [*plane, *corner]), load.ravel(), tolerance=1e-12)
    l1, l2, shear = shell.strains(u)[:3].mean(axis=(1, 2))
    c, s = pull[:2]
    return tension / (c**2 * (l1 - 1) + s**2 * (l2 - 1) + c * s * shear)


class Edge(NamedTuple):
    """A condition on one edge of a strip.

    axis, last  which edge: across s (0) or w (1), at its start or its end
    odd         components of the displacement that vanish there
    even        components whose slope across the edge vanishes
    """

    axis: int
    last: bool
    odd: tuple[int, ...] = ()
    even: tuple[int, ...] = ()


def mirrored(strip: Strip, edges: Sequence[Edge]) -> csr_array:
    """Basis (n_dofs, n_free) whose outer control points mirror their inner neighbours."""
    shape = (strip.ns + 2, strip.nw + 2, 3)
    source, sign = np.arange(np.prod(shape)).reshape(shape), np.ones(shape)
    for edge in edges:
        components = [*edge.odd, *edge.even]
        signs = np.array([-1] * len(edge.odd) + [1] * len(edge.even))
        outer, inner = (-1, -2) if edge.last else (0, 1)
        there, here = [slice(None)] * 3, [slice(None)] * 3
        there[edge.axis], here[edge.axis] = outer, inner
        for component, factor in zip(components, signs, strict=True):
            there[2] = here[2] = component
            source[tuple(there)] = source[tuple(here)]
            sign[tuple(there)] = factor * sign[tuple(here)]
    free, column = np.unique(source, return_inverse=True)
    rows = np.arange(source.size)
    return csr_array((sign.ravel(), (rows, column.ravel())), shape=(source.size, len(free)))
