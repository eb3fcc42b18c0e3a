"""The boundary value problem: a leg, the bandages laid on it, and what holds them.

Unknowns are displacements, leg nodes first, then the control points of the bandages, the first
one first. Units: N, mm, MPa.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..bandage.fabric import Fabric
from ..bandage.shell import Shell
from ..contact.law import ContactLaw
from ..contact.padding import Padding
from ..contact.point_to_surface import Contact
from ..geometry.leg import Leg
from ..surfaces.skin import Skin
from ..surfaces.strip import Strip
from ..tissue.mesh import LegMesh, leg_mesh
from ..tissue.neo_hooke import Tissue
from ..wrapping.lay import Lay
from ..wrapping.spiral import Wrap
from .facing import Facing, facing
from .letting_go import Sheet, let_go
from .newton import Problem, Tolerances
from .viscosity import Viscosity


@dataclass(frozen=True)
class Mesh:
    """Sizes of a discretisation.

    around, deep, high  hexahedra of the leg in theta, depth and z; the bandage has as many
                        rows of elements in its narrowest turn as the leg around
    across              elements across the bandage's width
    """

    around: int
    deep: int
    high: int
    across: int


MESHES = {
    "coarse": Mesh(24, 2, 24, 12),
    "medium": Mesh(36, 3, 36, 18),
    "fine": Mesh(48, 4, 48, 24),
}
"""One mesh, 1, 1.5 and 2 times as fine in all directions."""

BELOW, ABOVE = 85.0, 25.0
"""How far the leg goes on beyond both cuts, mm: at least 20 mm more than the bandage."""


@dataclass(frozen=True)
class Material:
    """Everything that is not geometry: fabric, tissue (MPa), friction, contact, padding."""

    fabric: Fabric
    c10: float = 0.005
    kappa: float = 14.3
    mu_skin: float = 0.2
    mu_bandage: float = 0.6
    penalty: float = 0.15
    ramp: float = 0.1
    elastic_slip: float = 0.05
    padding: Padding | None = None

    @property
    def on_skin(self) -> ContactLaw:
        """The law between skin and bandage."""
        return ContactLaw(
            self.mu_skin, self.penalty, self.ramp, self.elastic_slip, padding=self.padding
        )

    @property
    def on_bandage(self) -> ContactLaw:
        """The law between turns, of one bandage or of two."""
        return ContactLaw(self.mu_bandage, self.penalty, self.ramp, self.elastic_slip)


@dataclass(frozen=True)
class Ends:
    """What holds the ends: of the bandage (rows tied, mm; free end) and of the leg.

    tied  laid length of the first end that sticks to the skin, mm
    free  `clipped`: the same length of the last end sticks to what lies beneath;
          `held`: the last control points stay where they were laid
    leg   `free`, `no_axial` or `pinned` cut faces
    """

    tied: float = 20.0
    free: str = "clipped"
    leg: str = "free"


@dataclass(frozen=True)
class Over:
    """A further bandage over those before it: where it is laid, how, and of what fabric."""

    lay: Lay
    wrap: Wrap
    fabric: Fabric


@dataclass
class Wrapped:
    """A bandage on the leg: its surface, how it was laid, and its parts of the problem."""

    strip: Strip
    lay: Lay
    wrap: Wrap
    shell: Shell
    facing: Facing


@dataclass
class Model:
    """A leg with bandages on it, ready to be solved.

    What belongs to one bandage and is asked of the model is that of the first.
    """

    mesh: LegMesh
    X: np.ndarray
    tissue: Tissue
    bandages: tuple[Wrapped, ...]
    problem: Problem

    @property
    def ndof(self) -> int:
        """Length of the vector of displacements."""
        return self.X.size

    @property
    def strip(self) -> Strip:
        """Surface of the first bandage."""
        return self.bandages[0].strip

    @property
    def lay(self) -> Lay:
        """Where the first bandage was laid."""
        return self.bandages[0].lay

    @property
    def wrap(self) -> Wrap:
        """How the first bandage was put on."""
        return self.bandages[0].wrap

    @property
    def shell(self) -> Shell:
        """The first bandage's fabric."""
        return self.bandages[0].shell

    @property
    def skin(self) -> Contact:
        """The first bandage's contact with the skin."""
        return self.bandages[0].facing.skin

    @property
    def layers(self) -> Contact:
        """The first bandage's contact with its own turns."""
        return self.bandages[0].facing.turns

    @property
    def points(self) -> dict[str, np.ndarray]:
        """Which of the first bandage's laid points are in `skin` and in `layers`."""
        return self.bandages[0].facing.points


def mesh_leg(leg: Leg, bone: Leg, mesh: Mesh) -> LegMesh:
    """The hexahedra of an extended leg around its bones.

    Lines of nodes run from the skin straight at the centre line of the bones, so that
    they cannot cross in a section that is star-shaped about it.
    """

    def inner(theta, z):
        skin = leg.surface(theta, z)[..., :2] - bone.centre_line(z)
        return bone.surface(np.arctan2(skin[..., 1], skin[..., 0]), z)

    z = np.linspace(*leg.span, mesh.high + 1)
    return leg_mesh(leg.surface, inner, z, mesh.around, mesh.deep)


def build(
    leg: LegMesh,
    laid: Lay,
    wrap: Wrap,
    material: Material,
    ends: Ends,
    solver: str = "auto",
    tolerances: Tolerances | None = None,
    over: Sequence[Over] = (),
) -> Model:
    """Put the parts together; a bandage's rest length is that of its lay.

    over  further bandages, the one next to the first before those over it
    """
    count = leg.mesh.nvertices
    sheets = (Over(laid, wrap, material.fabric), *over)
    X = np.vstack([leg.mesh.p.T, *(sheet.lay.X for sheet in sheets)])
    tissue = Tissue(leg.mesh, material.c10, material.kappa, n_dofs=X.size)
    bandages: list[Wrapped] = []
    for sheet in sheets:
        strips = [one.strip for one in bandages]
        bandages.append(_wrapped(leg, strips, sheet, material, ends, X))
    fixed = leg.fixed_dofs(ends.leg)
    if ends.free == "held":
        last = np.concatenate([_last_row(one.strip) for one in bandages])
        fixed = np.concatenate([fixed, (3 * last[:, None] + np.arange(3)).ravel()])
    area = _nodal_area(leg, bandages, X)
    problem = Problem(
        inner=[tissue],
        contacts=[contact for one in bandages for contact in one.facing.contacts],
        others=[one.shell for one in bandages],
        viscosity=Viscosity(area),
        fixed=fixed,
        ndof=X.size,
        solver=solver,
        tolerances=tolerances or Tolerances.on_mesh(float(area[count:].mean())),
    )
    sheets = [
        Sheet(one.strip, one.lay, one.wrap, one.facing, _on_skin(leg, one.lay)) for one in bandages
    ]
    problem.let_go = lambda u: let_go(sheets, X + u.reshape(-1, 3))
    return Model(leg, X, tissue, tuple(bandages), problem)


def _wrapped(leg, strips, sheet, material, ends, X):
    """A bandage over those of `strips`."""
    laid, wrap = sheet.lay, sheet.wrap
    offset = leg.mesh.nvertices + sum(strip.size for strip in strips)
    strip = replace(laid.strip, offset=offset)
    return Wrapped(
        strip,
        laid,
        wrap,
        Shell(strip, (float(laid.lengths.sum()), wrap.width), sheet.fabric, X),
        facing(
            laid,
            [*strips, strip],
            X,
            Skin(leg.skin),
            _on_skin(leg, laid),
            _tied(laid, wrap, ends),
            material.on_skin,
            material.on_bandage,
        ),
    )


def _on_skin(leg, laid):
    """Parameters of the laid points on the skin, (points, 2)."""
    return skin_parameters(leg, laid.skin).reshape(-1, 2)


def _last_row(strip):
    """Control points of the free end."""
    return strip.offset + np.arange(strip.ns * (strip.nw + 2), strip.size)


def midpoints(strip: Strip) -> np.ndarray:
    """Strip parameters of all element midpoints, (ns * nw, 2)."""
    s, w = np.arange(strip.ns) + 0.5, np.arange(strip.nw) + 0.5
    return np.stack(np.meshgrid(s, w, indexing="ij"), -1).reshape(-1, 2)


def skin_parameters(leg: LegMesh, theta_z: np.ndarray) -> np.ndarray:
    """Parameters of the skin grid, in cells, of angles and heights (..., 2)."""
    step = leg.z[1] - leg.z[0]
    turns = theta_z[..., 0] * len(leg.theta) / (2 * np.pi)
    return np.stack([turns, (theta_z[..., 1] - leg.z[0]) / step], axis=-1)


def _tied(laid, wrap, ends):
    """Which contact points always stick: those near both ends."""
    row = wrap.stretch * laid.lengths.mean()
    rows = max(int(np.ceil(ends.tied / row)), 2)
    tied = np.zeros(laid.cover.shape, bool)
    tied[:rows] = True
    if ends.free == "clipped":
        tied[-rows:] = True
    return tied.ravel()


def _nodal_area(leg, bandages, X):
    """Laid area that belongs to each control point, and skin area to each node of it."""
    area = np.zeros(len(X))
    for one in bandages:
        nodes, weights = one.strip.stencil(one.lay.points.reshape(-1, 2))
        shares = weights[0] * one.lay.area.reshape(-1, 1)
        area += np.bincount(nodes.ravel(), shares.ravel(), len(X))
    xi = np.stack(np.indices(leg.skin.shape), -1).reshape(-1, 2).astype(float)
    jet = Skin(leg.skin).at(xi, X)
    area[leg.skin.ravel()] = np.linalg.norm(np.cross(jet[:, 1], jet[:, 2]), axis=1)
    return area
