"""Whether a leg is a possible leg; a solver that is given another one says where it fails.

Shape coordinates far from every leg that was seen may draw a skin that passes through
its own centre line. `check_leg` is called by every solver on a leg.
"""

from __future__ import annotations

import numpy as np

from solvers.leg_bandage.leg import Leg
from surrogate.errors import SolverError

SMALLEST_RADIUS = 12.0
"""mm from the centre line to the skin."""

THETA = np.radians(np.arange(0, 360, 10))
LEVELS = 41


def check_leg(leg: Leg) -> None:
    """Raise SolverError with height, angle and values if the leg cannot be one."""
    if not (np.isfinite(leg.length) and leg.length > 0):
        raise SolverError(f"leg length {leg.length} mm: give a positive length")
    z = np.linspace(*leg.span, LEVELS)
    _check(leg, leg.radius(THETA[:, None], z), SMALLEST_RADIUS, z,
           "the skin is {value:.1f} mm from the centre line of the leg (at least {least:g} mm)")


def _check(leg: Leg, values: np.ndarray, least: float, z: np.ndarray, sentence: str) -> None:
    """Raise at the smallest of values (angle, level) if it is below `least` or not a number."""
    worst = np.unravel_index(np.argmin(values), values.shape)
    if values[worst] >= least:
        return
    place = sentence.format(value=values[worst], least=least)
    shape = "" if leg.alphas is None else (
        "; length {:.1f} mm with alphas {} is not a possible leg, stay nearer to the "
        "shipped legs".format(leg.length, ", ".join(f"{a:.3f}" for a in leg.alphas)))
    raise SolverError(f"{place} at height {z[worst[1]]:.0f} mm, "
                      f"{np.degrees(THETA[worst[0]]):.0f} degrees{shape}")
