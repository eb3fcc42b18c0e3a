"""The skin: a smooth interpolant of the leg's outer nodes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from .interpolation import cubic_convolution, gather, tensor


@dataclass(frozen=True)
class Skin:
    """C1 bicubic interpolant of a node grid, periodic along the first parameter.

    nodes (n_theta, n_z) are node numbers; parameters count cells: node (i, j) is at
    (i, j). Along z the grid goes on straight beyond its first and last nodes.
    """

    nodes: np.ndarray
    flip: ClassVar[bool] = False

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
