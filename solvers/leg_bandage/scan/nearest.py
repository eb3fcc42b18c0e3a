"""The sections of a leg that stands, and the nearest leg of the basis with what it misses."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ..geometry.basis import Basis
from ..geometry.leg import Leg
from .cuts import Cuts
from .errors import ScanError
from .pose import Body, shape_of
from .refusal import check_holes
from .sections import THETA, Sections, cut_sections

NO_LEG = 6.0
"""mm RMS that the shape modes may miss of a leg. Shipped legs that were not learnt from:
0.5 to 3.4 mm."""


@dataclass(frozen=True)
class Error:
    """Distance, mm, between points of scan and fitted leg at the same height and angle."""

    rms: float
    percentile_95: float
    largest: float


def standing_sections(body: Body, cuts: Cuts) -> Sections:
    """The 100 sections, ankle centre at the origin; raises ScanError for too many holes."""
    found = cut_sections(body.vertices, body.triangles, cuts.levels)
    check_holes(found)
    return replace(found, z=found.z - cuts.ankle, centre=found.centre - found.centre[0])


def nearest_leg(sections: Sections, basis: Basis) -> tuple[Leg, Error]:
    """The nearest leg of the basis and what it misses; raises ScanError for what is no leg."""
    length = float(np.ptp(sections.z))
    leg = Leg.from_alphas(length, basis.project(shape_of(sections)), basis)
    away = np.linalg.norm(sections.points - leg.surface(THETA, leg.z[:, None]), axis=-1)
    away = away[~sections.missing]
    error = Error(
        float(np.sqrt((away**2).mean())), float(np.percentile(away, 95)), float(away.max())
    )
    if error.rms > NO_LEG:
        raise ScanError(
            f"the nearest leg of the basis misses the scan by "
            f"{error.rms:.1f} mm (RMS; at most {NO_LEG:g}): this is hardly a lower "
            "leg; cut the scan to the part from ankle to knee, or say its direction "
            "with --up"
        )
    return leg, error
