"""What standing up and pulling up the foot do to a leg: tissue that swells and stiffens.

Standing. Within two hours of lying down the cross-section of calf muscle falls by 5.5 % and that
of its fat by 4.4 %; the first 2.2 % of the calf's fluid leave in seconds (computed tomography and
bioimpedance, Berg, Tedner, Tesch 1993, doi 10.1111/j.1748-1716.1993.tb09573.x). Standing up is
taken as the way back, all at once: measured.

Dorsiflexion, of one who stands. In movement the girth at the calf rises by 1.05 cm (mean of ten
persons, doi 10.1177/02683555261424072), some 5.7 % of the cross-section; the muscles of the back of
the leg are given as much as makes that of the whole: 11 %, assumed. They stiffen fivefold, as the
lateral gastrocnemius does from slack to stretched (7.1 to 36.2 kPa, children, Brandenburg et al.
2015, PMC4369795): measured. Twofold in standing: assumed.

Growth is that of an isotropic volume. A muscle that bulges as it shortens keeps its volume and
grows across only; between two cuts of a leg that is a growth of its cross-section.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .mesh import LegMesh

BACK = 1.5 * np.pi
"""Angle of the back of the leg about its axis (0 is lateral, the front at a right angle)."""
FADING = 0.3
"""Half the width, in the cosine of the angle from the back, over which the compartment ends."""


@dataclass(frozen=True)
class Posture:
    """Volume and stiffness over those of a leg that lies.

    muscle      volume of the muscles of the back of the leg (posterior compartment)
    elsewhere   volume of the other tissue
    stiffening  of these muscles
    """

    muscle: float
    elsewhere: float
    stiffening: float


POSTURES: Mapping[str, Posture] = {
    "lying": Posture(1.0, 1.0, 1.0),
    "standing": Posture(1.055, 1.044, 2.0),
    "dorsiflexion": Posture(1.11, 1.044, 5.0),
}


def muscle_share(leg: LegMesh) -> NDArray[np.float64]:
    """(n_elements,) share of each element that is muscle of the back of the leg.

    The half of the leg behind its axis at each height, from bone to skin, fading out on the sides.
    """
    centres = leg.mesh.p[:, leg.mesh.t].mean(axis=1)
    skin = leg.mesh.p[:, leg.skin]
    axis = np.stack([np.interp(centres[2], leg.z, skin[i].mean(axis=0)) for i in range(2)])
    angle = np.arctan2(centres[1] - axis[1], centres[0] - axis[0])
    return np.asarray(np.clip(0.5 + np.cos(angle - BACK) / (2 * FADING), 0.0, 1.0))
