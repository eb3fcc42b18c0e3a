"""The leg as a coloured surface: points, pressures on them, the sensor's rim, the colours."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from surrogate.errors import SolverError

from ..geometry.landmarks import Disc, sensor
from ..geometry.leg import Leg
from ..scan.drawing import ticks
from ..scan.page import sensor_rim
from .pressure import Prediction, Skin

LEVELS, RAYS = 91, 72

STOPS = np.array(
    [[253, 231, 37], [149, 204, 83], [53, 163, 121], [38, 110, 142], [60, 55, 120], [68, 1, 84]]
)
"""Light to dark, so that it reads in black and white: viridis backwards (Smith, van der Walt)."""

BARE, BARE_UNDER = np.array([222, 224, 228]), 1.0
"""Colour of skin that is pressed by less than so many mmHg."""

SIDES = ("outside", "front", "inside", "back")
"""Where theta is 0, 90, 180, 270 degrees."""


@dataclass(frozen=True)
class Surface:
    """The skin of a leg with pressures on it; a left leg is given back its own side.

    points    (LEVELS, RAYS, 3) mm
    pressure  (LEVELS, RAYS) mmHg
    rim       (n, 3) of the sensor at B1, mm; empty without a B1
    at        (theta in degrees, z in mm) of the sensor's middle, or None
    mirrored  True for a left leg
    """

    points: np.ndarray
    pressure: np.ndarray
    rim: np.ndarray
    at: tuple[float, float] | None
    mirrored: bool

    @property
    def ticks(self) -> np.ndarray:
        """Pressures, mmHg, from 0 to above the largest: the colour bar."""
        top = max(float(np.ceil(self.pressure.max() / 5) * 5), 5.0)
        marks = ticks(0.0, top)
        return marks if marks[-1] >= top else np.append(marks, marks[-1] + marks[1])


def surface_of(told: Prediction) -> Surface:
    """The scan's own skin, coloured by the prediction."""
    leg, mirrored = told.scan.scanned, told.scan.side == "left"
    z, theta = np.linspace(0, leg.length, LEVELS), np.linspace(0, 2 * np.pi, RAYS, endpoint=False)
    sense = np.array([-1.0 if mirrored else 1.0, 1.0, 1.0])
    disc = _sensor(leg)
    rim = np.zeros((0, 3)) if disc is None else sensor_rim(leg, disc)
    return Surface(
        leg.surface(theta, z[:, None]) * sense,
        pressure_on(told.skin(), np.degrees(theta), z / leg.length),
        rim * sense,
        None if disc is None else (float(np.degrees(disc.theta)), disc.z),
        mirrored,
    )


def _sensor(leg: Leg) -> Disc | None:
    try:
        return sensor(leg)
    except SolverError:
        return None


def pressure_on(skin: Skin, theta: np.ndarray, height: np.ndarray) -> np.ndarray:
    """(height, theta): the pressure at angles (degrees) and heights over the length, bilinear."""
    around = np.array(
        [np.interp(theta, skin.theta, column, period=360.0) for column in skin.pressure.T]
    )
    return np.column_stack([np.interp(height, skin.height, line) for line in around.T])


def colours(pressure: np.ndarray, top: float) -> np.ndarray:
    """(..., 3) of 0 to 255, for pressures between 0 and top mmHg."""
    place = np.clip(pressure / top, 0, 1) * (len(STOPS) - 1)
    mixed = np.stack([np.interp(place, np.arange(len(STOPS)), stop) for stop in STOPS.T], axis=-1)
    return np.where(pressure[..., None] < BARE_UNDER, BARE, mixed)
