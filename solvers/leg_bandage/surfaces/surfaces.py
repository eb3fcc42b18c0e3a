"""Parametric surfaces that contact projects onto: skin, bandage, rigid mandrels.

A surface answers ``at(xi, x)``: for parameters xi (n, 2) and nodal positions x (nodes, 3)
it returns its jet (n, 6, 3): point, d1, d2, d11, d22, d12; and ``stencil(xi)`` tells
which nodes move it and by which weights: nodes (n, k), weights (6, n, k). Rigid surfaces
have k = 0. The normal is d1 x d2 and must point towards the body outside.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import solve_banded

from .interpolation import bspline, cubic_convolution, tensor


@dataclass(frozen=True)
class Skin:
    """C1 bicubic interpolant of a node grid, periodic along the first parameter.

    nodes (n_theta, n_z) are node numbers; parameters count cells: node (i, j) is at
    (i, j). Along z the grid goes on straight beyond its first and last nodes.
    """

    nodes: np.ndarray

    def cell(self, xi):
        """Cell of each parameter pair, (n, 2) integers (unwrapped)."""
        i, j = np.floor(xi).astype(np.int64).T
        return np.column_stack([i, np.clip(j, 0, self.nodes.shape[1] - 2)])

    def cell_nodes(self, cell):
        """Node numbers (n, 16) that move the surface inside a cell."""
        i = (cell[:, :1] + np.arange(-1, 3)) % self.nodes.shape[0]
        j = np.clip(cell[:, 1:], 1, self.nodes.shape[1] - 3) + np.arange(-1, 3)
        return self.nodes[i[:, :, None], j[:, None, :]].reshape(len(cell), 16)

    def stencil(self, xi):
        """Nodes (n, 16) and weights (6, n, 16) of the jet."""
        cell = self.cell(xi)
        t = xi - cell
        along = [self._straight_ends(weights, cell[:, 1]) for weights in cubic_convolution(t[:, 1])]
        return self.cell_nodes(cell), tensor(cubic_convolution(t[:, 0]), along)

    def _straight_ends(self, w, j):
        """Weights (4, n) in cells j where the node outside the grid is 2 first - second."""
        first, last = j == 0, j == self.nodes.shape[1] - 2
        if not (first | last).any():
            return w
        zero = np.zeros_like(w[0])
        low = np.stack([w[1] + 2 * w[0], w[2] - w[0], w[3], zero])
        high = np.stack([zero, w[0], w[1] - w[3], w[2] + 2 * w[3]])
        return np.where(first, low, np.where(last, high, w))

    def at(self, xi, x):
        """Jet (n, 6, 3) at parameters (n, 2) for nodal positions x."""
        return gather(*self.stencil(xi), x)


@dataclass(frozen=True)
class Strip:
    """The bandage's mid-surface: cardinal quadratic B-splines on ns x nw elements.

    Control point (i, j), i < ns + 2, j < nw + 2, is node ``offset + i * (nw + 2) + j``;
    parameters count elements from the first end and from the lower edge. `flip` turns
    the normal round. Outside its rim the surface is continued as a polynomial.
    """

    ns: int
    nw: int
    offset: int = 0
    flip: bool = False

    @property
    def size(self) -> int:
        """Number of control points."""
        return (self.ns + 2) * (self.nw + 2)

    def cell(self, xi):
        """Element of each parameter pair, (n, 2) integers."""
        return np.clip(np.floor(xi).astype(np.int64), 0, [self.ns - 1, self.nw - 1])

    def cell_nodes(self, cell):
        """Control points (n, 9) of an element."""
        i = cell[:, :1] + np.arange(3)
        j = cell[:, 1:] + np.arange(3)
        nodes = self.offset + i[:, :, None] * (self.nw + 2) + j[:, None, :]
        return nodes.reshape(len(cell), 9)

    def stencil(self, xi):
        """Nodes (n, 9) and weights (6, n, 9) of the jet."""
        cell = self.cell(xi)
        t = xi - cell
        return self.cell_nodes(cell), tensor(bspline(t[:, 0]), bspline(t[:, 1]))

    def at(self, xi, x):
        """Jet (n, 6, 3) at parameters (n, 2) for control positions x (all nodes)."""
        return gather(*self.stencil(xi), x)


class Rigid:
    """What surfaces share that no node moves."""

    @staticmethod
    def cell(xi):
        """All in one cell, (n, 2)."""
        return np.zeros(xi.shape, np.int64)

    @staticmethod
    def cell_nodes(cell):
        """No nodes, (n, 0)."""
        return np.zeros((len(cell), 0), int)

    @staticmethod
    def stencil(xi):
        """No nodes (n, 0) and no weights (6, n, 0)."""
        return np.zeros((len(xi), 0), int), np.zeros((6, len(xi), 0))


@dataclass(frozen=True)
class Mandrel(Rigid):
    """Rigid cone with elliptic sections: semi-axes a + slope z and b + slope z, mm.

    Parameters are (angle, z). A cylinder has a = b and slope 0; a cone of half angle
    alpha has slope = tan(alpha).
    """

    a: float
    b: float
    slope: float = 0.0

    def at(self, xi, x=None):
        """Jet (n, 6, 3) at parameters (n, 2)."""
        theta, z = xi.T
        c, s, zero = np.cos(theta), np.sin(theta), np.zeros_like(z)
        A, B, k = self.a + self.slope * z, self.b + self.slope * z, self.slope
        jet = [
            (A * c, B * s, z),
            (-A * s, B * c, zero),
            (k * c, k * s, zero + 1),
            (-A * c, -B * s, zero),
            (zero, zero, zero),
            (-k * s, k * c, zero),
        ]
        return np.stack([np.column_stack(row) for row in jet], axis=1)


@dataclass(frozen=True)
class Plane(Rigid):
    """Rigid plane through `origin` spanned by two unit vectors; normal first x second."""

    origin: tuple[float, float, float]
    first: tuple[float, float, float]
    second: tuple[float, float, float]

    def at(self, xi, x=None):
        """Jet (n, 6, 3) at parameters (n, 2), in mm along both directions."""
        e1, e2 = np.asarray(self.first, float), np.asarray(self.second, float)
        jet = np.zeros((len(xi), 6, 3))
        jet[:, 0] = np.asarray(self.origin) + xi @ np.stack([e1, e2])
        jet[:, 1], jet[:, 2] = e1, e2
        return jet


def gather(nodes, weights, x):
    """Jet (n, 6, 3) from nodes (n, k), weights (6, n, k) and positions x (nodes, 3)."""
    return np.matmul(weights.transpose(1, 0, 2), x[nodes])


def interpolate_strip(values):
    """Control points of the strip that takes given values at all element midpoints.

    values (ns + 2, nw + 2, 3) belong to the midpoints of the elements and of one more
    ring of elements around them; the strip is continued straight beyond that ring.
    """
    for axis in (0, 1):
        n = values.shape[axis]
        matrix = np.zeros((3, n))
        matrix[1] = 0.75
        matrix[0, 2:] = matrix[2, :-2] = 0.125
        matrix[1, 0] = matrix[1, -1] = 1.0
        moved = np.moveaxis(values, axis, 0).reshape(n, -1)
        solved = solve_banded((1, 1), matrix, moved)
        values = np.moveaxis(solved.reshape(np.moveaxis(values, axis, 0).shape), 0, axis)
    return values
