"""Rigid surfaces: mandrels and planes, which no node moves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


class Rigid:
    """What surfaces share that no node moves."""

    flip = False

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
