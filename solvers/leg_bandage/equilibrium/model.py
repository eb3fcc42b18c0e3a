"""The boundary value problem: a leg, a bandage laid on it, and what holds them.

Unknowns are displacements, leg nodes first, then the bandage's control points. Units: N,
mm, MPa.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from ..bandage.fabric import Fabric
from ..bandage.shell import Shell
from ..contact.law import ContactLaw
from ..contact.point_to_surface import Contact, Points
from ..geometry.leg import Leg
from ..surfaces.skin import Skin
from ..surfaces.strip import Strip
from ..tissue.mesh import LegMesh, leg_mesh
from ..tissue.neo_hooke import Tissue
from ..wrapping.lay import Lay
from ..wrapping.spiral import Wrap
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
    """Everything that is not geometry: fabric, tissue (MPa), friction, numerical contact."""

    fabric: Fabric
    c10: float = 0.005
    kappa: float = 14.3
    mu_skin: float = 0.2
    mu_bandage: float = 0.6
    penalty: float = 0.15
    ramp: float = 0.1
    elastic_slip: float = 0.05

    def law(self, mu: float) -> ContactLaw:
        """The contact law with a friction coefficient."""
        return ContactLaw(mu, self.penalty, self.ramp, self.elastic_slip)


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


@dataclass
class Model:
    """A leg with a bandage on it, ready to be solved."""

    mesh: LegMesh
    strip: Strip
    lay: Lay
    wrap: Wrap
    X: np.ndarray
    shell: Shell
    tissue: Tissue
    skin: Contact
    layers: Contact
    problem: Problem
    points: dict[str, np.ndarray] = field(default_factory=dict)

    @property
    def ndof(self) -> int:
        """Length of the vector of displacements."""
        return self.X.size


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
) -> Model:
    """Put the parts together; the bandage's rest length is that of the lay."""
    count = leg.mesh.nvertices
    strip = Strip(laid.strip.ns, laid.strip.nw, offset=count)
    X = np.vstack([leg.mesh.p.T, laid.X])
    size = (float(laid.lengths.sum()), wrap.width)
    shell = Shell(strip, size, material.fabric, X)
    tissue = Tissue(leg.mesh, material.c10, material.kappa, n_dofs=X.size)
    skin, layers, points = _contacts(leg, strip, laid, wrap, material, ends, X)
    fixed = leg.fixed_dofs(ends.leg)
    if ends.free == "held":
        last = count + np.arange(strip.ns * (strip.nw + 2), strip.size)
        fixed = np.concatenate([fixed, (3 * last[:, None] + np.arange(3)).ravel()])
    area = _nodal_area(leg, strip, laid, X)
    problem = Problem(
        inner=[tissue],
        contacts=[skin, layers],
        others=[shell],
        viscosity=Viscosity(area),
        fixed=fixed,
        ndof=X.size,
        solver=solver,
        tolerances=tolerances or Tolerances.on_mesh(float(area[count:].mean())),
    )
    return Model(leg, strip, laid, wrap, X, shell, tissue, skin, layers, problem, points)


def midpoints(strip: Strip) -> np.ndarray:
    """Strip parameters of all element midpoints, (ns * nw, 2)."""
    s, w = np.arange(strip.ns) + 0.5, np.arange(strip.nw) + 0.5
    return np.stack(np.meshgrid(s, w, indexing="ij"), -1).reshape(-1, 2)


def skin_parameters(leg: LegMesh, theta_z: np.ndarray) -> np.ndarray:
    """Parameters of the skin grid, in cells, of angles and heights (..., 2)."""
    step = leg.z[1] - leg.z[0]
    turns = theta_z[..., 0] * len(leg.theta) / (2 * np.pi)
    return np.stack([turns, (theta_z[..., 1] - leg.z[0]) / step], axis=-1)


def _contacts(leg, strip, laid, wrap, material, ends, X):
    """Contact with the skin and with the turn beneath, with zero gaps as laid."""
    nodes, weights = strip.stencil(laid.points.reshape(-1, 2))
    tied = _tied(strip, laid, wrap, ends)
    cover = laid.cover.ravel()
    area = laid.area.ravel()
    on_skin = np.flatnonzero(cover < 1 - 1e-6)
    on_turn = np.flatnonzero(cover > 1e-6)

    def contact(which, surface, xi, share, mu):
        points = Points(nodes[which], weights[0][which], share[which], tied[which])
        law = material.law(mu)
        part = Contact(points, surface, X, xi[which], np.zeros(len(which)), law)
        part.close()
        return part

    seeds = skin_parameters(leg, laid.skin).reshape(-1, 2)
    skin = contact(on_skin, Skin(leg.skin), seeds, area * (1 - cover), material.mu_skin)
    beneath = laid.beneath.reshape(-1, 2)
    layers = contact(on_turn, strip, beneath, area * cover, material.mu_bandage)
    return skin, layers, {"skin": on_skin, "layers": on_turn}


def _tied(strip, laid, wrap, ends):
    """Which contact points always stick: those near both ends."""
    row = wrap.stretch * laid.lengths.mean()
    rows = max(int(np.ceil(ends.tied / row)), 2)
    tied = np.zeros(laid.cover.shape, bool)
    tied[:rows] = True
    if ends.free == "clipped":
        tied[-rows:] = True
    return tied.ravel()


def _nodal_area(leg, strip, laid, X):
    """Laid area that belongs to each control point, and skin area to each node of it."""
    nodes, weights = strip.stencil(laid.points.reshape(-1, 2))
    shares = weights[0] * laid.area.reshape(-1, 1)
    area = np.bincount(nodes.ravel(), shares.ravel(), len(X))
    xi = np.stack(np.indices(leg.skin.shape), -1).reshape(-1, 2).astype(float)
    jet = Skin(leg.skin).at(xi, X)
    area[leg.skin.ravel()] = np.linalg.norm(np.cross(jet[:, 1], jet[:, 2]), axis=1)
    return area
