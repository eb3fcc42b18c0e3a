"""Whether a leg is a possible leg; a solver that is given another one says where it fails.

Shape coordinates far from every leg that was seen may draw a skin that passes through
its own centre line or through the bones. Every solver on a leg calls `check_leg`.
"""

from __future__ import annotations

import numpy as np

from surrogate.errors import SolverError

from . import section
from .bone import envelope
from .leg import Leg

LEAST_RADIUS = 12.0
"""mm from the centre line to the skin; the shipped legs keep 22 mm."""

LEAST_SHRINKAGE = 0.85
"""Bones smaller than this part of their size are not those of the leg."""

THETA = np.radians(np.arange(0, 360, 10))
LEVELS = 21


def check_leg(leg: Leg) -> None:
    """Raise SolverError with height, angle and values if the leg cannot be one."""
    z = np.linspace(0, leg.length, LEVELS)
    skin = leg.numbers(z)[:, :11]
    radius = section.radius(skin, THETA[:, None])
    if not radius.min() >= LEAST_RADIUS:
        turn, level = np.unravel_index(np.argmin(radius), radius.shape)
        raise SolverError(
            f"the skin is {radius[turn, level]:.1f} mm from the centre line of the leg (at least "
            f"{LEAST_RADIUS:g} mm) at height {z[level]:.0f} mm, "
            f"{np.degrees(THETA[turn]):.0f} degrees{_of(leg)}"
        )
    bone, offset, shrink = envelope(skin)
    if not shrink.min() >= LEAST_SHRINKAGE:
        level = shrink.argmin()
        raise SolverError(
            f"the skin meets the bones at height {z[level]:.0f} mm: they would fit only at "
            f"{shrink[level]:.0%} of their size (at least {LEAST_SHRINKAGE:.0%}){_of(leg)}"
        )
    spread = _spread(skin, bone, offset)
    if not spread.min() > 0:
        turn, level = np.unravel_index(np.argmin(spread), spread.shape)
        raise SolverError(
            f"bone and skin are so far out of line at height {z[level]:.0f} mm, "
            f"{np.degrees(THETA[turn]):.0f} degrees that the tissue between them folds{_of(leg)}"
        )


def _spread(skin: np.ndarray, bone: np.ndarray, offset: np.ndarray) -> np.ndarray:
    """(angle, level): area, mm^2 a radian, that lines from bone to skin sweep at either end.

    The finite element mesh lies along these lines; where one value is not positive they cross.
    """
    theta = THETA[:, None]
    line = section.curve(skin, theta) - section.curve(bone, theta)
    line = line - offset[:, 0] - 1j * offset[:, 1]
    return np.minimum(*((line.conj() * section.curve(end, theta, 1)).imag for end in (skin, bone)))


def _of(leg: Leg) -> str:
    """End of the sentence for a leg that was made from shape coordinates."""
    if leg.alphas is None:
        return ""
    alphas = ", ".join(f"{alpha:.3f}" for alpha in leg.alphas)
    return (
        f"; length {leg.length:.1f} mm with alphas {alphas} is not a possible leg: stay "
        "nearer to the shipped legs"
    )
