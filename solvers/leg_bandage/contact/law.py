"""Contact laws at a point: pressure against gap, Coulomb friction with elastic slip.

Pressure is a penalty with a smooth start, friction the smooth elastic-slip law ::

    p(g) = eps (-g)                 g < -d            t = -mu p phi(|s| / e) s / |s|
         = eps (d - g)^2 / (4 d)    |g| <= d          phi(y) = y (2 - y)   y < 1
         = 0                        g > d                    = 1           y >= 1

g gap in mm, s slip from the anchor in mm, e the elastic slip (Wriggers 2006, ch. 5,
with a C1 transition instead of a kink). A bonded point is bilateral and sticks: p = -eps g,
t = -eps s.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .padding import Padding


@dataclass(frozen=True)
class ContactLaw:
    """Parameters of contact: penalty MPa/mm, ramp mm, mu, elastic slip mm.

    padding  carries the pressure in place of the penalty
    """

    mu: float
    penalty: float = 0.15
    ramp: float = 0.1
    elastic_slip: float = 0.05
    padding: Padding | None = None

    def pressure(self, gap, bonded):
        """Pressure and its slope dp/dg, MPa and MPa/mm, shape of `gap`."""
        if self.padding is not None:
            return self.padding.pressure(gap, np.broadcast_to(bonded, gap.shape))
        d = self.ramp
        inside = np.clip(d - gap, 0.0, 2 * d)
        p = self.penalty * np.where(gap < -d, -gap, inside**2 / (4 * d))
        slope = -self.penalty * np.where(gap < -d, 1.0, inside / (2 * d))
        return (
            np.where(bonded, -self.penalty * gap, p),
            np.where(bonded, -self.penalty, slope),
        )

    def friction_factor(self, slip):
        """psi and psi' with traction = -mu p psi(|s|) s, from |s| (n,), 1/mm and 1/mm^2."""
        e = self.elastic_slip
        size = np.maximum(slip, e)
        sticking = slip < e
        psi = np.where(sticking, (2 - slip / e) / e, 1 / size)
        return psi, np.where(sticking, -1 / e**2, -1 / size**2)

    def kept(self, slip):
        """Share of the slip that stays elastic when a step is accepted, (n,)."""
        return self.elastic_slip / np.maximum(slip, self.elastic_slip)
