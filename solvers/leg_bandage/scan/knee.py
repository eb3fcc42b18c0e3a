"""Point D of a leg: the narrowest girth between calf and knee, where the scan goes so far."""

from __future__ import annotations

import numpy as np

from .cuts import Cuts
from .girths import complete_levels, smooth
from .pose import Body
from .sections import cut_sections

REACH = 1.7
"""Heights of the calf above the ankle up to which a knee is looked for."""
SURE = 0.005
"""Part of the girth by which it must rise again above D."""


def knee_of(body: Body, cuts: Cuts) -> tuple[float, float] | None:
    """Height above the ankle cut, mm, and girth of D; None where the scan does not show it."""
    highest = complete_levels(body.vertices, body.triangles)[-1]
    z = np.linspace(cuts.top, min(highest, cuts.ankle + REACH * cuts.length), 80)
    if z[-1] - z[0] < 0.1 * cuts.length:
        return None
    girth = smooth(z, cut_sections(body.vertices, body.triangles, z).girth, spans=10)
    at = int(girth.argmin())
    if at in (0, len(z) - 1) or girth[at:].max() < (1 + SURE) * girth[at]:
        return None
    return float(z[at] - cuts.ankle), float(girth[at])
