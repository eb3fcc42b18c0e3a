"""Structured hexahedra between a bone envelope and the skin.

The mesh is a tensor grid in (theta, depth, z), closed in theta and mapped along straight
lines from the bone to the skin, so that every leg has the same topology and the same
node numbers. Units: mm.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from skfem import ElementHex1, MeshHex

from surrogate.errors import SolverError, nearest

Surface = Callable[[np.ndarray, np.ndarray], np.ndarray]

END_CONDITIONS = {"free": (), "no_axial": (2,), "pinned": (0, 1, 2)}


@dataclass(frozen=True)
class LegMesh:
    """A leg's mesh with its grid.

    mesh    scikit-fem mesh with the boundaries `skin`, `bone`, `bottom`, `top`
    theta   (n_theta,) angles of the grid lines, from 0, without the closing 2 pi
    depth   (n_depth + 1,) place between bone (0) and skin (1)
    z       (n_z + 1,) heights of the layers
    nodes   (n_theta, n_depth + 1, n_z + 1) node numbers on the grid
    """

    mesh: MeshHex
    theta: np.ndarray
    depth: np.ndarray
    z: np.ndarray
    nodes: np.ndarray

    @property
    def skin(self) -> np.ndarray:
        """Node numbers on the skin, (n_theta, n_z + 1)."""
        return self.nodes[:, -1]

    @property
    def n_dofs(self) -> int:
        """Displacement unknowns; dof = 3 * node + component."""
        return 3 * self.mesh.nvertices

    def fixed_dofs(self, ends: str = "free", bone: bool = True) -> np.ndarray:
        """Sorted dofs that are held: the bone's, and those of the two cut faces.

        `ends` is `free`, `no_axial` (no displacement along z) or `pinned`.
        """
        if ends not in END_CONDITIONS:
            raise SolverError(f"ends: {nearest(ends, END_CONDITIONS)}")
        faces = np.concatenate([self.nodes[..., 0].ravel(), self.nodes[..., -1].ravel()])
        held = [3 * faces + component for component in END_CONDITIONS[ends]]
        if bone:
            held += [3 * self.nodes[:, 0].ravel() + component for component in range(3)]
        return np.unique(np.concatenate(held)) if held else np.empty(0, dtype=int)


def leg_mesh(
    skin: Surface, bone: Surface, z: np.ndarray, n_theta: int, n_depth: int, grading: float = 1.0
) -> LegMesh:
    """Mesh between two surfaces (theta, z) -> (..., 3) that share their angles and heights.

    z        (n_z + 1,) rising heights of the layers of nodes
    grading  thickness of the layer at the bone over that at the skin (above 1: finer skin)
    Raises SolverError when the skin does not lie outside the bone everywhere.
    """
    theta = 2 * np.pi * np.arange(n_theta) / n_theta
    z = np.asarray(z, dtype=float)
    depth = _graded(n_depth, grading)
    inner, outer = (surface(theta[:, None], z[None, :]) for surface in (bone, skin))
    points = inner[:, None] + depth[:, None, None] * (outer - inner)[:, None]
    nodes = np.arange(n_theta * (n_depth + 1) * len(z)).reshape(n_theta, n_depth + 1, len(z))
    mesh = MeshHex(np.ascontiguousarray(points.reshape(-1, 3).T), _hexahedra(nodes))
    _check_orientation(points)
    return LegMesh(_with_named_boundaries(mesh, nodes), theta, depth, z, nodes)


def cylindrical_surface(radius: float | Callable) -> Surface:
    """Straight cylinder about z; `radius` in mm, or a function of (theta, z)."""

    def surface(theta, z):
        theta, z = np.broadcast_arrays(theta, z)
        r = radius(theta, z) if callable(radius) else radius
        return np.stack([r * np.cos(theta), r * np.sin(theta), z], axis=-1)

    return surface


def _graded(n: int, grading: float) -> np.ndarray:
    """0 .. 1 in n steps whose lengths form a geometric series, first / last = `grading`."""
    ratio = grading ** (-1 / max(n - 1, 1))
    return np.concatenate([[0.0], np.cumsum(ratio ** np.arange(n)) / np.sum(ratio ** np.arange(n))])


def _hexahedra(nodes: np.ndarray) -> np.ndarray:
    """Vertices of the elements, (8, n_elements): reference axes are depth, theta, z."""
    turns, layers, heights = nodes.shape
    i, j, k = np.meshgrid(
        np.arange(turns), np.arange(layers - 1), np.arange(heights - 1), indexing="ij"
    )
    corners = ElementHex1.doflocs.astype(int)
    return np.array([nodes[(i + b) % turns, j + a, k + c].ravel() for a, b, c in corners])


def _with_named_boundaries(mesh: MeshHex, nodes: np.ndarray) -> MeshHex:
    """The mesh with its four boundaries, found by their nodes."""
    places = {
        "bone": nodes[:, 0],
        "skin": nodes[:, -1],
        "bottom": nodes[..., 0],
        "top": nodes[..., -1],
    }
    facets = mesh.facets
    named = {}
    for name, members in places.items():
        inside = np.zeros(mesh.nvertices, dtype=bool)
        inside[members] = True
        named[name] = np.flatnonzero(inside[facets].all(axis=0))
    return mesh.with_boundaries(named)


def _check_orientation(points: np.ndarray) -> None:
    """Raise unless the edge vectors at every grid point span a positive volume."""
    around = np.roll(points, -1, axis=0) - points
    outward, up = np.diff(points, axis=1), np.diff(points, axis=2)
    volume = np.einsum("...i,...i", np.cross(outward[:, :, :-1], around[:, :-1, :-1]), up[:, :-1])
    if not volume.min() > 0:
        turn, _, layer = np.unravel_index(volume.argmin(), volume.shape)
        raise SolverError(
            f"the bone reaches the skin at theta = {2 * np.pi * turn / len(points):.2f} rad, "
            f"layer {layer} from below; make the bone thinner there or the layers of z rising"
        )
