"""The bandage as a Kirchhoff-Love strip x(s, w) on its own flat rest coordinates.

The position is a C1 surface of cardinal quadratic B-splines (`surfaces.Strip`) whose control
points are the unknowns: nine an element. With a1 = x,s, a2 = x,w, n their unit normal:

    l1 = |a1|, l2 = |a2|, sin(gamma) = a1.a2 / (l1 l2),      k_ab = x,ab . n

and the energy per undeformed area is `Fabric`'s. Derivatives follow Kiendl et al. 2009; in
terms of Z = (a1, a2, x,11, x,22, x,12) force and tangent are linear maps of dW/dZ and
d2W/dZ2 that are the same for all elements, so assembly is one matrix product. README.md
has the formulas. Units: N, mm, MPa.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..algebra.system import Tangent
from ..surfaces.interpolation import bspline, tensor
from ..surfaces.strip import Strip
from .fabric import Fabric
from .kirchhoff_love import TWIST, energy, frame, gradient_and_hessian, membrane_forces
from .memory import Memory
from .relaxation import Relaxation

CHUNK = 4096  # elements whose second derivatives are held at a time: 20 kB each


class Fields(NamedTuple):
    """The bandage at some of its points, each (n, 3) or (n,)."""

    point: np.ndarray
    along: np.ndarray
    across: np.ndarray
    normal: np.ndarray
    warp_stretch: np.ndarray
    weft_stretch: np.ndarray
    shear: np.ndarray


class Shell:
    """A strip of fabric as a mechanical part (fixed pattern, residual, tangent).

    strip    the B-spline surface and the numbers of its control points
    size     (length, width) at rest, mm
    fabric   elastic constants
    start    (n_nodes, 3) places of all nodes of the model at u = 0; dof = 3 * node + component
    natural  (6, 4, n_elements) values of (l1, l2, sin(gamma), k11, k22, 2 k12) at the
             quadrature points that cost no energy; default: flat and unstretched
    slack    leave negative geometric stiffness out of the tangent, so that a bandage in
             compression, which wrinkles, keeps a positive tangent; the residual is the same

    `memory` is what a fabric that relaxes remembers of its forces; None: it is elastic.
    """

    def __init__(self, strip: Strip, size, fabric: Fabric, start, natural=None, slack=True):
        self.strip, self.fabric, self.slack = strip, fabric, slack
        self.memory: Memory | None = None
        self.start, self.n_dofs = np.asarray(start, dtype=float), np.size(start)
        self.steps = np.array([size[0] / strip.ns, size[1] / strip.nw])
        cells = np.stack(np.meshgrid(np.arange(strip.ns), np.arange(strip.nw), indexing="ij"), -1)
        self.points = strip.cell_nodes(cells.reshape(-1, 2))
        self.values, self.slopes, self.weights = _shapes(self.steps)
        flat = np.array([1.0, 1, 0, 0, 0, 0])[:, None, None]
        self.natural = np.broadcast_to(
            flat if natural is None else natural, (6, len(self.weights), len(self.points))
        )
        self._force_map, self._tangent_map = _maps(self.slopes, self.weights, fabric.bending)
        self.rows, self.cols = self._pattern()

    def linearise(self, u: np.ndarray) -> tuple[np.ndarray, Tangent]:
        """Residual (n_dofs,) and tangent, values (n_elements * 729,): made together."""
        places = self.start + u.reshape(-1, 3)
        forces = np.empty((9, len(self.points), 3))
        values = np.empty((81, len(self.points), 9))
        for first in range(0, len(self.points), CHUNK):
            chunk = slice(first, first + CHUNK)
            Z = _derivatives(self.slopes, places[self.points[chunk]])
            memory = None if self.memory is None else self.memory.part(chunk)
            gradient, hessian = gradient_and_hessian(
                Z, self.natural[..., chunk], self.fabric, self.slack, memory
            )
            n = Z.shape[2]
            forces[:, chunk] = (self._force_map @ gradient.reshape(-1, 3 * n)).reshape(9, n, 3)
            values[:, chunk] = (self._tangent_map @ hessian.reshape(-1, 9 * n)).reshape(81, n, 9)
        dofs = 3 * self.points.T[:, :, None] + np.arange(3)
        residual = np.bincount(dofs.ravel(), forces.ravel(), minlength=self.n_dofs)
        return residual, values.ravel

    def relaxing(self, u: np.ndarray, series: Relaxation) -> None:
        """Let the fabric relax from the state u on, in which it has just been stretched."""
        self.memory = Memory.of(series, self._elastic(u))

    def wait(self, minutes: float) -> None:
        """Begin a step of so many minutes; only for a fabric that relaxes."""
        if self.memory is not None:
            self.memory = self.memory.waiting(minutes)

    def accept(self, u: np.ndarray) -> None:
        """End the step in the state u."""
        if self.memory is not None:
            self.memory = self.memory.after(self._elastic(u))

    def _elastic(self, u: np.ndarray) -> np.ndarray:
        return membrane_forces(self.strains(u), self.natural, self.fabric)[0]

    def energy(self, u: np.ndarray) -> float:
        """Energy that an elastic fabric would store, N mm."""
        Z = _derivatives(self.slopes, (self.start + u.reshape(-1, 3))[self.points])
        return float(self.weights @ energy(Z, self.natural, self.fabric).sum(axis=1))

    def at(self, u: np.ndarray, xi: np.ndarray) -> Fields:
        """The deformed bandage at parameters xi (n, 2), counted in elements."""
        jet = self.strip.at(xi, self.start + u.reshape(-1, 3))
        along, across = jet[:, 1] / self.steps[0], jet[:, 2] / self.steps[1]
        warp, weft = (np.linalg.norm(a, axis=1) for a in (along, across))
        normal = np.cross(along, across)
        normal /= np.linalg.norm(normal, axis=1, keepdims=True)
        shear = np.einsum("ni,ni->n", along, across) / (warp * weft)
        return Fields(jet[:, 0], along, across, normal, warp, weft, shear)

    def strains(self, u: np.ndarray) -> np.ndarray:
        """l1, l2, sin(gamma), k11, k22, 2 k12 at the quadrature points, (6, 4, n_elements)."""
        places = self.start + u.reshape(-1, 3)
        return frame(_derivatives(self.slopes, places[self.points])).strains

    def _pattern(self) -> tuple[np.ndarray, np.ndarray]:
        """Triplet pattern in the order of the tangent values: (a, b, element, i, j)."""
        dofs = (3 * self.points.T[:, :, None] + np.arange(3)).astype(np.int32)
        shape = (9, 9, len(self.points), 3, 3)
        rows = np.broadcast_to(dofs[:, None, :, :, None], shape)
        cols = np.broadcast_to(dofs[None, :, :, None, :], shape)
        return rows.ravel(), cols.ravel()


def _shapes(steps: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Shape functions (4 points, 9), their derivatives (5, 4, 9) for Z, weights (4,) in mm^2."""
    gauss = 0.5 + np.array([-1, 1]) / np.sqrt(12)
    s, w = (axis.ravel() for axis in np.meshgrid(gauss, gauss))
    N, d1, d2, d11, d22, d12 = tensor(bspline(s), bspline(w))
    hs, hw = steps
    slopes = np.stack([d1 / hs, d2 / hw, d11 / hs**2, d22 / hw**2, d12 / (hs * hw)])
    return N, slopes, np.full(4, hs * hw / 4)


def _maps(slopes, weights, bending) -> tuple[np.ndarray, np.ndarray]:
    """Linear maps from dW/dZ to forces, (9, 20), and from d2W/dZ2 to tangents, (81, 68)."""
    weighted = slopes * weights[:, None]
    forces = weighted.transpose(2, 0, 1).reshape(9, -1)
    pairs = [(0, 0), (0, 1), (1, 0), (1, 1)]
    mixed = [(2 + r, i) for r in range(3) for i in range(2)]
    pairs += mixed + [(i, r) for r, i in mixed]
    blocks = [np.einsum("qa,qb->qab", weighted[m], slopes[n]) for m, n in pairs]
    stiffness = bending * TWIST[:, None] * TWIST
    blocks.append(np.einsum("rs,rqa,sqb->qab", stiffness, weighted[2:], slopes[2:]))
    return forces, np.stack(blocks).reshape(-1, 81).T.copy()


def _derivatives(slopes: np.ndarray, places: np.ndarray) -> np.ndarray:
    """Z (5, 4 points, n_elements, 3) from control points (n_elements, 9, 3)."""
    n = len(places)
    local = places.transpose(1, 0, 2).reshape(9, -1)
    return (slopes.reshape(20, 9) @ local).reshape(5, 4, n, 3)
