"""Why a surface shows no leg, in a sentence with the cure."""

from __future__ import annotations

import numpy as np

from .errors import ScanError
from .girths import (
    CALF_OVER_ANKLE,
    COMPLETE,
    REACH_OVER_ANKLE,
    Zone,
    profile,
)
from .pose import Body, along_principal
from .sections import Sections, coverage, cut_sections
from .units import UNITS

LARGEST_HOLES = 0.15
"""Of the skin between the cuts; below it the holes are filled smoothly."""

ROUND = 0.02
"""RMS of the harmonics over the mean radius under which sections are circles; the shipped
legs have 0.04 and more."""


BODY = (1200.0, 2300.0)
"""mm, of the longest extent of a whole body; a leg with its thigh is shorter."""
SLENDER = 0.35
"""Smallest over largest extent of a body that stands, at most."""


def more_than_a_leg(body: Body, unit: str | None) -> str | None:
    """The sentence for a scan of a whole body, in the unit that is given or in any; else None."""
    spread = [np.ptp(turned.vertices[:, 2]) for turned in along_principal(body)]
    long, thin = max(spread), min(spread)
    tall = [
        f"{long * UNITS[name]:.0f} mm in the unit {name}"
        for name in (UNITS if unit is None else (unit,))
        if BODY[0] <= long * UNITS[name] <= BODY[1]
    ]
    if not tall or thin > SLENDER * long:
        return None
    return (
        f"the scan is more than a leg: it is {' or '.join(tall)} long, as a whole body; cut one "
        "leg out, from the foot to above the knee (in MeshLab: select the rest, delete it, "
        "export), and give that file"
    )


def why_no_leg(body: Body) -> str:
    """The sentence for a body in which no ankle with a calf above it was found."""
    shown, body = max(
        ((_shown(turned), turned) for turned in along_principal(body)), key=lambda pair: pair[0]
    )
    if shown < COMPLETE:
        return (
            f"along its length the scan shows {shown:.0%} of the circumference (median; at "
            f"least {COMPLETE:.0%} is needed); scan the leg all around and up to the knee, or "
            "close the gap"
        )
    girth = profile(body.vertices, body.triangles).girth
    found = f"from {girth.min():.4g} to {girth.max():.4g}" if len(girth) else "unknown"
    return (
        f"no leg is found: along its axis, {np.ptp(body.vertices[:, 2]):.4g} long, the girth "
        f"of the scan is {found} (in the unit of the file). A lower leg has a narrow ankle "
        f"and, {REACH_OVER_ANKLE[0]:g} to {REACH_OVER_ANKLE[1]:g} ankle girths above it, a "
        f"calf {CALF_OVER_ANKLE[0]:g} to {CALF_OVER_ANKLE[1]:g} times as wide; scan from the "
        "ankle to the knee"
    )


def check_skin(body: Body, zone: Zone) -> None:
    """Raise ScanError when the part between ankle and calf has large holes or is round."""
    found = cut_sections(body.vertices, body.triangles, np.linspace(zone.ankle, zone.calf, 40))
    check_holes(found)
    series = found.series
    uneven = float(np.sqrt(((series[:, 1:] / series[:, :1]) ** 2).sum(axis=1).mean() / 2))
    if uneven < ROUND:
        raise ScanError(
            "no leg is found: all sections of the scan are circles (they differ from "
            f"circles by {uneven:.1%} of the radius, legs by {ROUND:.0%} and more); "
            "scan a leg"
        )


def check_holes(sections: Sections) -> None:
    """Raise ScanError when more of the skin is missing than can be filled."""
    holes = sections.missing.mean()
    if holes > LARGEST_HOLES:
        raise ScanError(
            f"holes make up {holes:.0%} of the skin between ankle and calf (at most "
            f"{LARGEST_HOLES:.0%}); scan the leg all around, or close them"
        )


def _shown(body: Body) -> float:
    """Part of the circumference that the median level shows."""
    low, high = body.vertices[:, 2].min(), body.vertices[:, 2].max()
    levels = np.linspace(low, high, 52)[1:-1]
    return float(np.median(coverage(body.vertices, body.triangles, levels)))
