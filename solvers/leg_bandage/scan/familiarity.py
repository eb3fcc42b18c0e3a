"""Whether a leg is like those that errors were found on, and how much more it may be missed.

The shape part of an interval was found on legs of one family. A leg that the modes fit worse than
every validation leg, or with girths outside of those that the basis was learnt from, may be
missed by more: the part grows with the misfit, and with the distance over half the range.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache

import numpy as np

from ..geometry.cohort import load_cohort
from ..geometry.landmarks import extreme_girths
from ..geometry.leg import Leg

WORST_RMS = 2.32
"""mm, of the 38 validation legs, pose found from the shape (`SCANS.md`)."""


@cache
def shipped_girths() -> dict[str, tuple[float, float]]:
    """Smallest and largest ankle and calf girth of the 35 legs of the shipped basis, mm."""
    legs, found = load_cohort("train"), []
    for number in range(len(legs)):
        leg = Leg.from_sections(legs.length[number], legs.coefficients[number], legs.centre[number])
        ankle, _, calf, _ = extreme_girths(leg)
        found.append((ankle, calf))
    low, high = np.min(found, axis=0), np.max(found, axis=0)
    return {name: (float(low[k]), float(high[k])) for k, name in enumerate(("ankle", "calf"))}


def _beyond(leg: Leg) -> dict[str, tuple[float, float]]:
    """name -> girth, and mm beyond those of the shipped legs; half a mm is let pass."""
    ankle, _, calf, _ = extreme_girths(leg)
    found = {}
    for name, girth in (("ankle", ankle), ("calf", calf)):
        low, high = shipped_girths()[name]
        away = max(low - girth, girth - high, 0.0)
        if away > 0.5:
            found[name] = (girth, away)
    return found


def widening(leg: Leg, rms: float) -> float:
    """By what the shape part of an interval grows, 1 for a leg like the shipped ones."""
    grown = max(1.0, rms / WORST_RMS)
    for name, (_, away) in _beyond(leg).items():
        low, high = shipped_girths()[name]
        grown *= 1 + away / ((high - low) / 2)
    return grown


def unlike(leg: Leg, rms: float) -> Iterator[str]:
    """Sentences on what makes the leg unlike the shipped ones."""
    if rms > WORST_RMS:
        yield (
            f"POOR FIT: the modes miss this skin by {rms:.1f} mm RMS, more than that of every "
            f"validation leg ({WORST_RMS:g} mm); the interval of a pressure is widened"
        )
    for name, (girth, _) in _beyond(leg).items():
        low, high = shipped_girths()[name]
        yield (
            f"UNLIKE: the {name} girth of {girth:.0f} mm is outside of the shipped legs "
            f"({low:.0f} to {high:.0f} mm); the interval of a pressure is widened"
        )
