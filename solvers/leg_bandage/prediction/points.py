"""Where the pressure along a leg is told: B, B1, C and D, as stockings are measured.

B    the ankle, narrowest girth; read by a sensor with its lower rim there (two layers)
B1   where the Achilles tendon turns into the calf
C    the calf, widest girth
D    under the knee, narrowest girth above the calf; where the scan does not reach,
     `KNEE_HEIGHT` times as high as C and `KNEE_GIRTH` times as wide

All by a 50 mm sensor on the medial side. The stored runs end at the upper cut, and two
layers end `ONE_LAYER` under it. C and D above that are those of a bandage that goes on to the
knee: the highest pressure under two layers, carried up by Laplace's law of the tape measure,
P(z) = P(read) girth(read) / girth(z).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from surrogate.errors import SolverError

from ...laplace import laplace_pressure
from ..geometry.landmarks import MEDIAL, Disc, b1_height, extreme_girths
from ..geometry.leg import Leg

POINTS = ("B", "B1", "C", "D")
RADIUS = 25.0
"""mm, of the sensor."""
ONE_LAYER = 50.0 + RADIUS
"""mm under the upper cut: a pitch, and the sensor's radius."""
KNEE_HEIGHT, KNEE_GIRTH = 1.36, 0.94
"""D over C, height above B and girth: median of the 38 validation legs before they were cut
(1.26 to 1.49 and 0.91 to 0.98)."""


@dataclass(frozen=True)
class Place:
    """One of the points on a leg.

    height  mm above the ankle cut
    girth   mm
    read    mm: height of the middle of the sensor that reads it
    carried girth(read) / girth(height) where the pressure is carried up, else 1
    known   whether the scan shows it; else its height and girth are those of a common leg
    """

    height: float
    girth: float
    read: float
    carried: float = 1.0
    known: bool = True


def places(leg: Leg, knee: tuple[float, float] | None = None) -> dict[str, Place]:
    """The points of a leg; knee: height and girth of D where the scan reaches it.

    B1 is missing on a leg that has none.
    """
    narrow, ankle, wide, calf = extreme_girths(leg)
    highest = leg.length - ONE_LAYER
    high, girth = knee or (ankle + KNEE_HEIGHT * (calf - ankle), KNEE_GIRTH * wide)
    found = {"B": Place(ankle, narrow, ankle + RADIUS)}
    try:
        b1 = b1_height(leg)
        found["B1"] = Place(b1, float(leg.girth(b1)), b1)
    except SolverError:
        pass
    read = min(calf, highest)
    there = float(leg.girth(read))
    found["C"] = Place(calf, wide, read, there / wide)
    found["D"] = Place(high, girth, read, there / girth, known=knee is not None)
    return found


def under_sensor(
    theta: np.ndarray, height: np.ndarray, pressure: np.ndarray, leg: Leg, z: float
) -> float:
    """Mean of a pressure on a grid (theta in degrees, height over length) over the sensor at z."""
    around, up, weights = Disc(MEDIAL, z).points(leg, rings=8, spokes=32)
    return float(weights @ bilinear(theta, height, pressure, np.degrees(around), up / leg.length))


def bilinear(
    theta: np.ndarray, height: np.ndarray, pressure: np.ndarray, around: np.ndarray, up: np.ndarray
) -> np.ndarray:
    """A field (a, h) on even angles that close and rising heights, at places (n,)."""
    step = (around - theta[0]) % 360.0 / (360.0 / len(theta))
    left = np.floor(step).astype(int) % len(theta)
    right, share = (left + 1) % len(theta), step - np.floor(step)
    low = np.clip(np.searchsorted(height, up) - 1, 0, len(height) - 2)
    rise = np.clip((up - height[low]) / (height[low + 1] - height[low]), 0, 1)
    lower = (1 - share) * pressure[left, low] + share * pressure[right, low]
    upper = (1 - share) * pressure[left, low + 1] + share * pressure[right, low + 1]
    return np.asarray((1 - rise) * lower + rise * upper)


def local_laplace(leg: Leg, z: float) -> float:
    """Laplace's law under the medial sensor at z, two layers of 1 N/mm, mmHg."""
    theta, heights, weights = Disc(MEDIAL, z).points(leg)
    return float(weights @ laplace_pressure(1.0, leg.curvature(theta, heights)))


def corrected(
    fields: Mapping[str, float],
    scanned: Leg,
    fitted: Leg,
    where: Mapping[str, Place],
    on_modes: Mapping[str, Place],
    exponent: float,
) -> dict[str, float]:
    """Pressures read on the leg of the modes, corrected to the scan's own sections, carried up."""
    found = {}
    for name, place in where.items():
        own, modes = (
            local_laplace(scanned, place.read),
            local_laplace(fitted, on_modes[name].read),
        )
        ratio = (own / modes) ** exponent if own > 0 and modes > 0 else 1.0
        found[name] = fields[name] * ratio * place.carried
    return found
