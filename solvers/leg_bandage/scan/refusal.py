"""Why a surface shows no leg, in a sentence with the cure."""

from __future__ import annotations

import numpy as np

from solvers.leg_bandage.scan.girths import CALF_OVER_ANKLE, COMPLETE, REACH_OVER_ANKLE, profile
from solvers.leg_bandage.scan.pose import Body, along_longest
from solvers.leg_bandage.scan.sections import coverage


def why_no_leg(body: Body) -> str:
    """The sentence for a body in which no ankle with a calf above it was found."""
    body = along_longest(body)
    low, high = body.vertices[:, 2].min(), body.vertices[:, 2].max()
    levels = np.linspace(low, high, 52)[1:-1]
    shown = coverage(body.vertices, body.triangles, levels)
    if np.median(shown) < COMPLETE:
        return (f"along its length the scan shows {np.median(shown):.0%} of the circumference "
                f"(median; at least {COMPLETE:.0%} is needed); scan the leg all around, or close "
                "the gap")
    girth = profile(body.vertices, body.triangles).girth
    found = f"from {girth.min():.4g} to {girth.max():.4g}" if len(girth) else "unknown"
    return (f"no leg is found: along the longest axis of the scan, {high - low:.4g} long, the "
            f"girth is {found} (in the unit of the file). A lower leg has a narrow ankle and, "
            f"{REACH_OVER_ANKLE[0]:g} to {REACH_OVER_ANKLE[1]:g} ankle girths above it, a calf "
            f"{CALF_OVER_ANKLE[0]:g} to {CALF_OVER_ANKLE[1]:g} times as wide; scan from the ankle "
            "to the knee")
