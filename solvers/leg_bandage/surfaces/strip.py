"""The bandage's mid-surface, and the control points that interpolate given values."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import solve_banded

from .interpolation import bspline, gather, tensor


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
