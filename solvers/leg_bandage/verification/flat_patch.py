"""The flat contact patch: a strip pressed by a uniform load onto a flat soft block.

The block rests on a plane between smooth walls, so that under a uniform pressure it only gets
thinner, every column alike. The strip lies on the middle of its upper face; the margin round it
carries the same pressure as a dead load, so that the exact answer stays uniform. Strip and
block have meshes of their own; the block's may be twisted under the strip, where its lines
then cross the strip's at that angle. `Skin` closes on itself in its first parameter, which a
flat one does not: a margin of two cells keeps every contact point away from that seam.
Units: N, mm, MPa.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq
from skfem import MeshHex

from ..bandage.fabric import Fabric
from ..bandage.shell import Shell
from ..contact.law import ContactLaw
from ..contact.point_to_surface import Contact, Points
from ..equilibrium.newton import Problem, Tolerances
from ..equilibrium.viscosity import Viscosity
from ..surfaces.skin import Skin
from ..surfaces.strip import Strip
from ..tissue.neo_hooke import Tissue
from ..wrapping.lay import shares
from .follower_pressure import bandage_pressure
from .plates import laid

SIDE, HEIGHT = 60.0, 30.0
MARGIN = 2
"""Cells of the block on each side of the strip."""
C10, KAPPA = 0.005, 0.05
"""MPa: tissue that can be compressed, or nothing between walls would move."""


class DeadLoad:
    """Forces (n_dofs,) that do not follow the motion, as a part. N."""

    def __init__(self, force: np.ndarray):
        self.force, self.rows, self.cols = force, np.zeros(0, np.int32), np.zeros(0, np.int32)

    def linearise(self, u):
        """Minus the load and an empty tangent."""
        return -self.force, lambda: np.zeros(0)


class Patch(NamedTuple):
    """What a pressed patch answers.

    pressure    (ns + 2, nw + 2) at the contact points, MPa
    settlement  (nx + 1, ny + 1) of the nodes of the block under the strip, mm
    reaction    of the floor, N
    """

    pressure: np.ndarray
    settlement: np.ndarray
    reaction: float


def settlement_exactly(pressure: float) -> float:
    """How far the upper face sinks, mm: uniaxial strain of `Tissue`'s energy, lateral stretch 1.

    With J = l the axial stress is c10 4/3 (l^(1/3) - l^(-5/3)) + kappa (l - 1) = -pressure.
    """

    def unbalanced(stretch):
        deviator = 4 / 3 * C10 * (stretch ** (1 / 3) - stretch ** (-5 / 3))
        return deviator + KAPPA * (stretch - 1) + pressure

    return HEIGHT * (1 - brentq(unbalanced, 0.3, 1.0, xtol=1e-14))


def press(
    pressure: float, cells=(8, 8, 3), elements=(11, 9), twist: float = 0.0, bending: float = 1e-3
) -> Patch:
    """A strip of `elements` on a block with `cells` under it and in depth, under `pressure` (MPa).

    twist    angle (rad) by which the block's lines are turned in its middle
    bending  stiffness of the strip, N mm
    """
    mesh, nodes = block(cells, twist)
    strip = Strip(*elements, offset=mesh.nvertices)
    X = np.vstack([mesh.p.T, laid(strip, (SIDE, SIDE)) + [0, 0, HEIGHT]])
    columns = [np.concatenate([[0.0], np.arange(n) + 0.5, [n]]) for n in elements]
    share = np.outer(*(shares(n) for n in elements)) * SIDE**2 / np.prod(elements)
    own, weights = strip.stencil(np.stack(np.meshgrid(*columns, indexing="ij"), -1).reshape(-1, 2))
    points = Points(own, weights[0], share.ravel(), np.zeros(share.size, bool))
    face = nodes[..., -1]
    contact = Contact(
        points,
        Skin(face),
        X,
        _nearest(points.at(X), X, face),
        np.zeros(share.size),
        ContactLaw(0.2),
    )
    contact.close()
    shell = Shell(strip, (SIDE, SIDE), Fabric(0.3, 0.3, 0, 0.1, bending, bending, bending / 2), X)
    tissue = Tissue(mesh, C10, KAPPA, n_dofs=X.size)
    others = [shell, bandage_pressure(shell, pressure), _on_margin(mesh, face, pressure, X.size)]
    problem = Problem(
        [tissue],
        [contact],
        others,
        Viscosity(np.ones(len(X))),
        _walls(nodes),
        X.size,
        tolerances=Tolerances(force=1e-8),
    )
    u, _ = problem.newton(np.zeros(X.size))
    contact.slide(u)
    u, _ = problem.newton(u)
    inside = (slice(MARGIN, -MARGIN),) * 2
    return Patch(
        contact.report(u)["p"].reshape(share.shape),
        -u.reshape(-1, 3)[face[inside], 2],
        float(tissue.linearise(u)[0][3 * nodes[..., 0].ravel() + 2].sum()),
    )


def block(cells, twist: float) -> tuple[MeshHex, np.ndarray]:
    """The block's mesh and its nodes (nx, ny, nz), numbered along x, y, z.

    Under the strip, x and y from 0 to SIDE, lie `cells`; there the lines are turned about
    the middle by `twist` (1 - a^2) (1 - b^2), a and b from -1 to 1 across the strip.
    """
    wide = [SIDE / n * np.arange(-MARGIN, n + MARGIN + 1) for n in cells[:2]]
    mesh = MeshHex.init_tensor(*wide, np.linspace(0, HEIGHT, cells[2] + 1))
    nodes = np.lexsort(np.round(mesh.p, 9)[::-1]).reshape([len(wide[0]), len(wide[1]), -1])
    a, b = 2 * mesh.p[:2] / SIDE - 1
    angle = twist * np.maximum(1 - a**2, 0) * np.maximum(1 - b**2, 0)
    c, s = np.cos(angle), np.sin(angle)
    turned = SIDE / 2 * (1 + np.array([c * a - s * b, s * a + c * b]))
    return MeshHex(np.vstack([turned, mesh.p[2:]]), mesh.t), nodes


def _on_margin(mesh, face, pressure, n_dofs):
    """The load on the cells of the upper face that the strip leaves bare."""
    corners = np.stack([face[:-1, :-1], face[1:, :-1], face[1:, 1:], face[:-1, 1:]], axis=-1)
    bare = np.ones(corners.shape[:2], bool)
    bare[MARGIN:-MARGIN, MARGIN:-MARGIN] = False
    quads = corners[bare]
    first, second = (mesh.p[:2, quads[:, k]] - mesh.p[:2, quads[:, 0]] for k in (1, 3))
    area = first[0] * second[1] - first[1] * second[0]
    force = np.zeros(n_dofs)
    np.add.at(force, 3 * quads + 2, -pressure * area[:, None] / 4)
    return DeadLoad(force)


def _walls(nodes):
    """Held dofs: normal to the floor and to the four walls."""
    return np.unique(
        np.concatenate(
            [
                3 * nodes[[0, -1]].ravel(),
                3 * nodes[:, [0, -1]].ravel() + 1,
                3 * nodes[..., 0].ravel() + 2,
            ]
        )
    )


def _nearest(places, X, nodes):
    """Parameters (n, 2) of the node that is nearest to each place."""
    away = np.linalg.norm(places[:, None] - X[nodes.ravel()], axis=-1)
    return np.column_stack(np.unravel_index(away.argmin(axis=1), nodes.shape)).astype(float)
