"""Bandages on rigid mandrels and on a soft tube: problems with exact answers.

A ring is a strip of one turn whose two ends meet in a plane of symmetry: they may move in
that plane and not out of it, so that the strip is closed. Units: N, mm, MPa.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..bandage.fabric import Fabric
from ..bandage.shell import Shell
from ..contact.law import ContactLaw
from ..contact.point_to_surface import Contact, Points
from ..equilibrium.model import skin_parameters
from ..equilibrium.newton import Problem, Tolerances
from ..equilibrium.pseudo_transient import pseudo_transient
from ..equilibrium.viscosity import Viscosity
from ..surfaces.rigid import Mandrel
from ..surfaces.skin import Skin
from ..surfaces.strip import Strip
from ..tissue.mesh import LegMesh
from ..tissue.neo_hooke import Tissue
from ..wrapping.lay import lay
from ..wrapping.spiral import Wrap


def around(mandrel: Mandrel):
    """The mandrel as a surface (theta, z, d_theta, d_z) to wrap."""

    def surface(theta, z, d_theta=0, d_z=0):
        theta, z = np.broadcast_arrays(theta, z)
        jet = mandrel.at(np.column_stack([np.ravel(theta), np.ravel(z)]))
        return jet[:, d_theta + 2 * d_z].reshape(*theta.shape, 3)

    return surface


def ring_wrap(width: float, stretch: float = 1.3, height: float = 0.0) -> Wrap:
    """One whole turn without a climb, of no thickness worth mentioning."""
    return Wrap(height, height + 1e-9, 1e-9, stretch, width, thickness=1e-3)


@dataclass
class MandrelProblem:
    """A bandage on a rigid mandrel: its shell, its contacts and the problem they make."""

    strip: Strip
    X: np.ndarray
    area: np.ndarray
    shell: Shell
    skin: Contact
    layers: Contact | None
    problem: Problem

    def slide_to_rest(self, u=None, viscosity=5e-3):
        """Slide from the lay (or from u) and follow the bandage to rest: u (ndof,)."""
        u = np.zeros(self.X.size) if u is None else u
        for contact in self.problem.contacts:
            contact.slide(u)
        return pseudo_transient(self.problem, u, viscosity)[0]


def wrap_mandrel(
    mandrel: Mandrel,
    wrap: Wrap,
    fabric: Fabric,
    law: ContactLaw,
    ns: int,
    nw: int,
    between: ContactLaw | None = None,
    ring: bool = False,
    solver: str = "auto",
    tolerances: Tolerances | None = None,
) -> MandrelProblem:
    """Lay a bandage on a mandrel; a ring is closed, otherwise both ends are held in place."""
    laid = lay(around(mandrel), wrap, ns, nw)
    strip, X = laid.strip, laid.X
    shell = Shell(strip, (float(laid.lengths.sum()), wrap.width), fabric, X)
    nodes, weights = strip.stencil(laid.points.reshape(-1, 2))
    cover, area = laid.cover.ravel(), laid.area.ravel()

    def contact(surface, xi, share, which, rule):
        points = Points(
            nodes[which], weights[0][which], (share * area)[which], np.zeros(len(which), bool)
        )
        part = Contact(points, surface, X, xi.reshape(-1, 2)[which], np.zeros(len(which)), rule)
        part.close()
        return part

    skin = contact(mandrel, laid.skin, 1 - cover, np.flatnonzero(cover < 1 - 1e-6), law)
    layers = None
    if between is not None:
        layers = contact(strip, laid.beneath, cover, np.flatnonzero(cover > 1e-6), between)
    nodal = np.bincount(nodes.ravel(), (weights[0] * area[:, None]).ravel(), len(X))
    rows = np.arange(strip.size).reshape(strip.ns + 2, strip.nw + 2)
    ends = rows[[0, 1, -2, -1]].ravel()
    fixed = 3 * ends + 1 if ring else (3 * ends[:, None] + np.arange(3)).ravel()
    contacts = [skin] if layers is None else [skin, layers]
    problem = Problem(
        [],
        contacts,
        [shell],
        Viscosity(nodal),
        fixed,
        X.size,
        solver,
        tolerances or Tolerances(force=1e-7, passing=1e-4),
    )
    return MandrelProblem(strip, X, laid.area, shell, skin, layers, problem)


def ring_on_tube(
    mesh: LegMesh, fabric: Fabric, c10: float, kappa: float, law: ContactLaw, ns: int, nw: int
) -> tuple[MandrelProblem, Tissue]:
    """A closed ring over the whole height of a soft tube in plane strain, hole free.

    mesh is that of a straight tube; three nodes of its hole keep it from drifting.
    """
    count, height = mesh.mesh.nvertices, mesh.z[-1] - mesh.z[0]
    radius = float(np.linalg.norm(mesh.mesh.p[:2, mesh.skin[0, 0]]))
    laid = lay(around(Mandrel(radius, radius)), ring_wrap(height, height=mesh.z.mean()), ns, nw)
    strip, X = Strip(ns, nw, offset=count), np.vstack([mesh.mesh.p.T, laid.X])
    nodes, weights = strip.stencil(laid.points.reshape(-1, 2))
    points = Points(nodes, weights[0], laid.area.ravel(), np.zeros(laid.area.size, bool))
    seeds = skin_parameters(mesh, laid.skin).reshape(-1, 2)
    skin = Contact(points, Skin(mesh.skin), X, seeds, np.zeros(len(nodes)), law)
    skin.close()
    shell = Shell(strip, (float(laid.lengths.sum()), height), fabric, X)
    tissue = Tissue(mesh.mesh, c10, kappa, n_dofs=X.size)
    nodal = np.bincount(nodes.ravel(), (weights[0] * laid.area.reshape(-1, 1)).ravel(), len(X))
    rows = count + np.arange(strip.size).reshape(ns + 2, nw + 2)
    quarter = len(mesh.theta) // 4
    hole = mesh.nodes[:, 0]
    fixed = np.concatenate([
        mesh.fixed_dofs("no_axial", bone=False), 3 * rows[[0, 1, -2, -1]].ravel() + 1,
        3 * hole[0] + 1, 3 * hole[quarter], 3 * hole[2 * quarter] + 1,
    ])  # fmt: skip
    problem = Problem([tissue], [skin], [shell], Viscosity(nodal), np.unique(fixed), X.size)
    return MandrelProblem(strip, X, laid.area, shell, skin, None, problem), tissue
