"""The viscous force that turns sliding into a motion; units N, mm, MPa."""

from __future__ import annotations

import numpy as np


class Viscosity:
    """Viscous force c A (x - x_n) on the bandage's control points and on the skin, as a part.

    area (nodes,) is the share of laid area, or of skin, of each node.
    """

    def __init__(self, area: np.ndarray):
        self.area = np.repeat(area, 3)
        self.coefficient, self.origin = 0.0, np.zeros(self.area.size)
        self.rows = self.cols = np.flatnonzero(self.area).astype(np.int32)

    def linearise(self, u):
        """Residual (ndof,) and tangent, a diagonal (nnz,)."""
        damping = self.coefficient * self.area
        return damping * (u - self.origin), lambda: damping[self.rows]
