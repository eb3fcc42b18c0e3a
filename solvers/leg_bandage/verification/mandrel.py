"""Bandages on rigid mandrels and on a soft tube: problems with exact answers.

A ring is a strip of one turn whose two ends meet in a plane of symmetry: they may move in
that plane and not out of it, so that the strip is closed. Units: N, mm, MPa.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..bandage.fabric import Fabric
from ..bandage.shell import Shell
from ..contact.law import ContactLaw
from ..contact.point_to_surface import Contact
from ..equilibrium.facing import Facing, facing
from ..equilibrium.model import skin_parameters
from ..equilibrium.newton import Problem, Tolerances
from ..equilibrium.pseudo_transient import pseudo_transient
from ..equilibrium.viscosity import Viscosity
from ..surfaces.rigid import Mandrel
from ..surfaces.skin import Skin
from ..surfaces.strip import Strip
from ..tissue.mesh import LegMesh
from ..tissue.neo_hooke import Tissue
from ..wrapping.lay import Lay, lay
from ..wrapping.spiral import Wrap
from ..wrapping.turns import Turn


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


@dataclass(frozen=True)
class Band:
    """A bandage to be put on: how, of what fabric, and its elements along and across."""

    wrap: Wrap
    fabric: Fabric
    ns: int
    nw: int


@dataclass
class MandrelProblem:
    """Bandages on a body: shells and contacts, the first one first, and the problem they make.

    What belongs to one bandage and is asked of the problem is that of the first.
    """

    lays: tuple[Lay, ...]
    strips: tuple[Strip, ...]
    X: np.ndarray
    shells: tuple[Shell, ...]
    facings: tuple[Facing, ...]
    problem: Problem

    @property
    def strip(self) -> Strip:
        """Surface of the first bandage."""
        return self.strips[0]

    @property
    def shell(self) -> Shell:
        """The first bandage's fabric."""
        return self.shells[0]

    @property
    def skin(self) -> Contact:
        """The first bandage's contact with the body."""
        return self.facings[0].skin

    def carried(self, u: np.ndarray) -> float:
        """Sum of the contact pressures on the body, N."""
        contacts = [one.skin for one in self.facings]
        return float(sum(np.sum(one.report(u)["p"] * one.points.area) for one in contacts))

    def slide_to_rest(self, u=None, viscosity=5e-3):
        """Slide from the lay (or from u) and follow the bandages to rest: u (ndof,)."""
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
    over: Sequence[Band] = (),
) -> MandrelProblem:
    """Lay bandages on a mandrel; a ring is closed, otherwise both ends are held in place.

    between  the law of turn on turn; none: they do not feel each other
    over     further bandages
    """
    lays: list[Lay] = []
    for band in (Band(wrap, fabric, ns, nw), *over):
        lays.append(lay(around(mandrel), band.wrap, band.ns, band.nw, lays))
    fabrics = (fabric, *(band.fabric for band in over))
    widths = [band.wrap.width for band in (Band(wrap, fabric, ns, nw), *over)]
    X = np.vstack([laid.X for laid in lays])
    seeds = [laid.skin.reshape(-1, 2) for laid in lays]
    strips, shells, facings = _bands(lays, widths, fabrics, X, 0, mandrel, seeds, law, between)
    rows = [_rows(strip) for strip in strips]
    ends = np.concatenate([row[[0, 1, -2, -1]].ravel() for row in rows])
    fixed = 3 * ends + 1 if ring else (3 * ends[:, None] + np.arange(3)).ravel()
    contacts = [
        contact for one in facings for contact in ([one.skin] if between is None else one.contacts)
    ]
    problem = Problem(
        [],
        contacts,
        list(shells),
        Viscosity(_nodal_area(lays, strips, len(X))),
        fixed,
        X.size,
        solver,
        tolerances or Tolerances(force=1e-7, passing=1e-4),
    )
    return MandrelProblem(tuple(lays), strips, X, shells, facings, problem)


def _bands(lays, widths, fabrics, X, offset, body, seeds, law, between):
    """Strips, shells and contacts of bandages whose control points begin at `offset` in X."""
    strips: list[Strip] = []
    shells, facings = [], []
    for laid, width, fabric, at in zip(lays, widths, fabrics, seeds, strict=True):
        strip = replace(laid.strip, offset=offset + sum(one.size for one in strips))
        strips.append(strip)
        shells.append(Shell(strip, (float(laid.lengths.sum()), width), fabric, X))
        loose = np.zeros(laid.area.size, bool)
        facings.append(facing(laid, strips, X, body, at, loose, law, between or law))
    return tuple(strips), tuple(shells), tuple(facings)


def _rows(strip):
    """Numbers of the control points (ns + 2, nw + 2)."""
    return strip.offset + np.arange(strip.size).reshape(strip.ns + 2, strip.nw + 2)


def _nodal_area(lays, strips, count):
    """Laid area that belongs to each control point."""
    area = np.zeros(count)
    for laid, strip in zip(lays, strips, strict=True):
        nodes, weights = strip.stencil(laid.points.reshape(-1, 2))
        area += np.bincount(nodes.ravel(), (weights[0] * laid.area.reshape(-1, 1)).ravel(), count)
    return area


@dataclass(frozen=True)
class Ring:
    """A closed ring over the whole height of a tube: fabric, elements around and across."""

    fabric: Fabric
    ns: int
    nw: int


def rings_on_tube(
    mesh: LegMesh,
    rings: Sequence[Ring],
    c10: float,
    kappa: float,
    law: ContactLaw,
    between: ContactLaw | None = None,
) -> tuple[MandrelProblem, Tissue]:
    """Closed rings, each over the one before, on a soft tube in plane strain, hole free.

    mesh is that of a straight tube; three nodes of its hole keep it from drifting. A ring is
    carried by the ring beneath at every point.
    """
    count, height = mesh.mesh.nvertices, mesh.z[-1] - mesh.z[0]
    radius = float(np.linalg.norm(mesh.mesh.p[:2, mesh.skin[0, 0]]))
    wrap = ring_wrap(height, height=mesh.z.mean())
    bare = [lay(around(Mandrel(radius, radius)), wrap, ring.ns, ring.nw) for ring in rings]
    lays = [
        replace(one, beneath=_on_ring(number, rings, one) if number else one.beneath)
        for number, one in enumerate(bare)
    ]
    X = np.vstack([mesh.mesh.p.T, *(laid.X for laid in lays)])
    seeds = [skin_parameters(mesh, laid.skin).reshape(-1, 2) for laid in lays]
    fabrics = [ring.fabric for ring in rings]
    strips, shells, facings = _bands(
        lays, [height] * len(rings), fabrics, X, count, Skin(mesh.skin), seeds, law, between
    )
    tissue = Tissue(mesh.mesh, c10, kappa, n_dofs=X.size)
    ends = np.concatenate([_rows(strip)[[0, 1, -2, -1]].ravel() for strip in strips])
    quarter = len(mesh.theta) // 4
    hole = mesh.nodes[:, 0]
    fixed = np.concatenate([
        mesh.fixed_dofs("no_axial", bone=False), 3 * ends + 1,
        3 * hole[0] + 1, 3 * hole[quarter], 3 * hole[2 * quarter] + 1,
    ])  # fmt: skip
    contacts = [facings[0].skin] + [contact for one in facings[1:] for contact in one.over]
    viscosity = Viscosity(_nodal_area(lays, strips, len(X)))
    problem = Problem([tissue], contacts, list(shells), viscosity, np.unique(fixed), X.size)
    return MandrelProblem(tuple(lays), strips, X, shells, facings, problem), tissue


def _on_ring(number, rings, laid):
    """The ring before carries ring `number` wholly, at the same angles and heights."""
    mine, beneath = rings[number], rings[number - 1]
    xi = laid.points * [beneath.ns / mine.ns, beneath.nw / mine.nw]
    return (Turn(number - 1, xi, np.ones(laid.area.shape)),)
