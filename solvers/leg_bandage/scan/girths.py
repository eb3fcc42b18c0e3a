"""Where a long surface is narrow above nothing or a foot, and wide above that: ankle and calf.

All in the unit of the surface, whatever it is: only ratios decide.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import make_lsq_spline

from .sections import coverage, cut_sections

LEVELS = 200
COMPLETE = 0.97
"""Part of the circumference that a level at the end of the scan must show to be used."""

CALF_OVER_ANKLE = (1.15, 2.8)
REACH_OVER_ANKLE = (0.55, 2.0)
"""Girth of the calf, and its height above the ankle, over the girth of the ankle. The 73
shipped legs have 1.48 .. 1.93 and 0.86 .. 1.25."""

FALL = 0.004
"""By what part the girth must fall above a calf; slim knees are 1 % narrower, noise is less."""

STEADY_END = 0.15
"""A cut end keeps its girth over 3 % of the scan to this part; a round end does not."""


@dataclass(frozen=True)
class Profile:
    """Girth against height of a surface along its z axis.

    z, girth  (n,) levels where the section is complete, lowest first, and smoothed girths there
    raw       (n,) girths as they were cut
    """

    z: np.ndarray
    girth: np.ndarray
    raw: np.ndarray

    @property
    def open(self) -> bool:
        """Whether the lowest level is a cut (or the end of the scan), not a round end."""
        near = max(3, len(self.z) * 3 // 100)
        return bool(abs(self.raw[near] - self.raw[1]) < STEADY_END * self.raw[near])

    @property
    def upside_down(self) -> Profile:
        """That of the surface with its z axis the other way."""
        return Profile(-self.z[::-1], self.girth[::-1], self.raw[::-1])


@dataclass(frozen=True)
class Zone:
    """An ankle and the calf above it: heights and girths."""

    ankle: float
    ankle_girth: float
    calf: float
    calf_girth: float


def complete_levels(
    vertices: np.ndarray, triangles: np.ndarray, levels: int = LEVELS, complete: float = COMPLETE
) -> np.ndarray:
    """Equally spaced levels (n,) from the first to the last complete section; empty if none."""
    low, high = vertices[:, 2].min(), vertices[:, 2].max()
    z = np.linspace(low, high, levels + 2)[1:-1]
    whole = np.flatnonzero(coverage(vertices, triangles, z) >= complete)
    return z[whole[0] : whole[-1] + 1] if len(whole) > 1 else z[:0]


def profile(vertices: np.ndarray, triangles: np.ndarray) -> Profile:
    """Girths along z, smoothed by splines of a twentieth of the length."""
    z = complete_levels(vertices, triangles)
    if len(z) < LEVELS // 8:
        return Profile(z[:0], z[:0], z[:0])
    raw = cut_sections(vertices, triangles, z).girth
    smoothed = smooth(z, raw)
    if not smoothed.min() > 0:  # an axis across the leg
        return Profile(z[:0], z[:0], z[:0])
    return Profile(z, smoothed, raw)


def smooth(z: np.ndarray, values: np.ndarray, spans: int = 20) -> np.ndarray:
    """Values of the least-squares cubic spline on equal spans."""
    spans = min(spans, len(z) // 4)
    knots = np.concatenate([[z[0]] * 3, np.linspace(z[0], z[-1], spans + 1), [z[-1]] * 3])
    return make_lsq_spline(z, values, knots, k=3)(z)


def zones(found: Profile) -> list[Zone]:
    """Every ankle with a calf above it that the profile may show, narrowest ankle first."""
    z, girth = found.z, found.girth
    if len(z) == 0:
        return []
    inner = np.flatnonzero((girth[1:-1] <= girth[:-2]) & (girth[1:-1] < girth[2:])) + 1
    ankles = [0, *inner] if found.open and girth[0] < girth[1] else list(inner)
    seen = [_zone(z, girth, int(k)) for k in ankles]
    return sorted((zone for zone in seen if _plausible(zone)), key=lambda zone: zone.ankle_girth)


def _zone(z: np.ndarray, girth: np.ndarray, ankle: int) -> Zone:
    """The zone above an ankle; its calf is the first maximum that the girth then falls from."""
    above = girth[ankle:]
    highest = np.maximum.accumulate(above)
    fallen = np.flatnonzero(
        (above < (1 - FALL) * highest) & (highest > CALF_OVER_ANKLE[0] * above[0])
    )
    end = fallen[0] if len(fallen) else len(above)
    calf = ankle + int(above[:end].argmax())
    return Zone(z[ankle], girth[ankle], _peak(z, girth, calf), girth[calf])


def _peak(z: np.ndarray, girth: np.ndarray, at: int) -> float:
    """Height of a flat maximum: the middle of the levels within half a per cent of it."""
    near = girth >= 0.995 * girth[at]
    low = at - np.argmin(near[at::-1]) + 1 if not near[: at + 1].all() else 0
    high = at + np.argmin(near[at:]) - 1 if not near[at:].all() else len(z) - 1
    return float(z[at]) if high == len(z) - 1 or low == 0 else float(z[low] + z[high]) / 2


def _plausible(zone: Zone) -> bool:
    ratio = zone.calf_girth / zone.ankle_girth
    reach = (zone.calf - zone.ankle) / zone.ankle_girth
    return (
        CALF_OVER_ANKLE[0] <= ratio <= CALF_OVER_ANKLE[1]
        and REACH_OVER_ANKLE[0] <= reach <= REACH_OVER_ANKLE[1]
    )
