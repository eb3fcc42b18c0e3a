"""Padding between skin and bandage: an assembly of fibres that carries pressure by its thickness.

van Wyk 1946 (J. Textile Inst. 37, T285): the pressure rises with the cube of the fibres' share
of the volume, p = P0 ((h0 / h)^3 - 1), h0 the thickness without load. Padding has no stiffness
of its own along the skin. Units: N, mm, MPa.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

FLAT = 0.1
"""Share of h0 below which the law goes on straight: at 1000 P0, more than bandages press."""


@dataclass(frozen=True)
class Padding:
    """A layer of padding.

    loose      thickness without load, mm
    stiffness  P0, MPa
    laid       thickness at which bandages are laid over it, mm
    """

    loose: float
    stiffness: float
    laid: float

    @classmethod
    def laid_under(cls, pressure: float, loose: float, stiffness: float) -> Padding:
        """Padding over which a bandage is pulled that presses it with `pressure`, MPa."""
        return cls(loose, stiffness, thickness(pressure, loose, stiffness))

    def pressure(
        self, gap: NDArray[np.float64], bonded: NDArray[np.bool_]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Pressure and its slope at gaps from the laid thickness, MPa and MPa/mm.

        Bonded padding that is lifted pulls with the slope that it has without load.
        """
        height = self.laid + gap
        inside = np.clip(height, FLAT * self.loose, self.loose)
        cube = self.stiffness * (self.loose / inside) ** 3
        slope = -3 * cube / inside
        p = cube - self.stiffness + slope * (height - inside)
        open_ = (height > self.loose) & ~bonded
        return np.where(open_, 0.0, p), np.where(open_, 0.0, slope)


def thickness(pressure: float, loose: float, stiffness: float) -> float:
    """Thickness (mm) under a pressure, MPa: h0 (1 + p / P0)^(-1/3)."""
    return float(loose * (1 + pressure / stiffness) ** (-1 / 3))
