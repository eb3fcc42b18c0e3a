"""Which nodes may couple through contact: a sparsity pattern that outlives small moves.

Each point couples its own nodes with those of the cells that its projection may reach.
While projections wander less than `REACH` cells from where the pattern was laid out it is
kept, so that the order of elimination is too; what a point then couples beyond it is left
out of the tangent. That is a weight which starts from zero at a cell's border with zero slope,
and the residual has it in full.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_array

MARGIN = 0.2
"""Cells: a projection closer to a border than this couples with both sides from the start."""
REACH = 0.6
"""Cells that a projection may wander before the pattern has to be laid out anew."""


class PatternOutgrown(Exception):
    """A projection wandered too far: lay the pattern out anew and analyse again."""


class ContactPattern:
    """Pairs of nodes that points may couple, laid out around projections xi (n, 2).

    own (n, k) are the nodes of the points, `surface` says which nodes move its cells; n may
    be 0, a part of the bandage that faces nothing.
    rows, cols  (nnz,) int32 triplets of dofs: 3 x 3 blocks of pairs of nodes
    """

    def __init__(self, own: np.ndarray, surface, xi: np.ndarray):
        self._own, self._surface, self._laid = own, surface, xi.copy()
        corners = np.array([(0, 0), (-1, -1), (-1, 1), (1, -1), (1, 1)]) * MARGIN
        windows = [surface.cell(xi + corner) for corner in corners]
        self._count = 1 + max(int(self._nodes(window).max(initial=-1)) for window in windows)
        pattern = sum(_pairs(self._nodes(window), self._count) for window in windows)
        pattern.sort_indices()
        row = np.repeat(np.arange(self._count), np.diff(pattern.indptr))
        self._keys = row * self._count + pattern.indices
        c, d = np.divmod(np.arange(9), 3)
        self.rows = (3 * row[:, None] + c).ravel().astype(np.int32)
        self.cols = (3 * pattern.indices[:, None] + d).ravel().astype(np.int32)
        self._home = self._cells = windows[0]
        self._place = self._find(slice(None), self._cells)

    def assemble(self, xi: np.ndarray, weights: np.ndarray, tangent: np.ndarray) -> np.ndarray:
        """Values (nnz,) of sum_p B' D B with B (n, 3, m) on own and surface nodes, D (n, 9, 9).

        Raises PatternOutgrown when a projection that matters, one whose D is not zero, is in
        another cell and farther than REACH from where it was laid out.
        """
        self._follow(xi, tangent.any(axis=(1, 2)))
        count, size = len(self._keys), len(weights)
        blocks = tangent.reshape(size, 3, 3, 3, 3)
        values = np.empty((count, 9))
        place = self._place.ravel()
        left = np.ascontiguousarray(weights.transpose(0, 2, 1))
        for c in range(3):
            for d in range(3):
                block = left @ np.ascontiguousarray(blocks[:, :, c, :, d]) @ weights
                sums = np.bincount(place, block.ravel(), minlength=count + 1)
                values[:, 3 * c + d] = sums[:count]
        return values.ravel()

    def _follow(self, xi, matters):
        """Bring the places of points that changed their cell up to date."""
        cells = self._surface.cell(xi)
        elsewhere = matters & (cells != self._home).any(axis=1)
        if np.abs(xi - self._laid)[elsewhere].max(initial=0.0) > REACH:
            raise PatternOutgrown
        moved = (cells != self._cells).any(axis=1)
        if moved.any():
            self._place[moved] = self._find(moved, cells[moved])
            self._cells = cells

    def _nodes(self, cells, which=slice(None)):
        return np.hstack([self._own[which], self._surface.cell_nodes(cells)])

    def _find(self, which, cells):
        """Number of the pair for each two nodes of each point, (n, m * m); past the last: none."""
        nodes = self._nodes(cells, which).astype(np.int64)
        keys = nodes[:, :, None] * self._count + nodes[:, None, :]
        keys[(nodes >= self._count).any(axis=1)] = -1
        place = np.minimum(np.searchsorted(self._keys, keys), len(self._keys) - 1)
        place[self._keys[place] != keys] = len(self._keys)
        return place.reshape(len(nodes), nodes.shape[1] ** 2)


def _pairs(nodes: np.ndarray, count: int) -> csr_array:
    """Counts (count, count) of how many rows of nodes (n, m) hold both nodes of a pair."""
    n, m = nodes.shape
    held = csr_array((np.ones(n * m), nodes.ravel(), np.arange(0, n * m + 1, m)), shape=(n, count))
    return (held.T @ held).tocsr()
