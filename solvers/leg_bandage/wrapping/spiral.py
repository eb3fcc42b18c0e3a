"""The spiral on a bare surface: where the midline goes, and the lines across it.

The midline climbs a helix of constant pitch in the leg's coordinates (theta, z). Across
its width the strip follows lines that leave the midline at a right angle and stay in the
tangent plane, at true length. Units: mm, radians.

A surface to wrap is a function (theta, z, d_theta, d_z) -> points (..., 3) or their
first derivatives, like `Leg.surface`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from surrogate.errors import SolverError

from ..surfaces.projection import solve2

Surface = Callable[..., np.ndarray]
SAMPLES_A_TURN = 180


@dataclass(frozen=True)
class Wrap:
    """How a bandage is put on.

    start_height  z of the midline at the first end, mm
    end_height    z of the midline at the free end, mm
    pitch         climb of the midline in one turn, mm
    stretch       warp stretch of the midline
    stretch_free  the same at the free end, if it changes evenly on the way; None: it does not
    reversed      round the leg the other way, theta falling
    above         the skin that its innermost layer lies, over padding, mm
    width         of the strip, mm
    thickness     of one layer, mm
    start_angle   theta of the first end (0 is lateral)
    """

    start_height: float
    end_height: float
    pitch: float
    stretch: float = 1.3
    width: float = 100.0
    thickness: float = 0.5
    start_angle: float = 0.0
    stretch_free: float | None = None
    reversed: bool = False
    above: float = 0.0

    def stretch_at(self, angles: np.ndarray) -> np.ndarray:
        """Warp stretch of the midline as laid at its angles, straight in the angle."""
        if self.stretch_free is None:
            return np.full(np.shape(angles), self.stretch)
        way = (angles - self.start_angle) / (2 * np.pi * self.turns)
        return np.asarray(self.stretch + way * (self.stretch_free - self.stretch))

    @property
    def turns(self) -> float:
        """Number of turns, not rounded."""
        return (self.end_height - self.start_height) / self.pitch


def wrap_for(length: float, *, overlap: float, width=100.0, start_height=-10.0, **more) -> Wrap:
    """The spiral that brings the upper edge of the free end to the top of a leg of this length.

    overlap is the share of the width that lies on the turn before. Raises SolverError
    when less than one turn fits.
    """
    wrap = Wrap(start_height, length - width / 2, (1 - overlap) * width, width=width, **more)
    if wrap.turns < 1:
        raise SolverError(
            f"a leg of {length:.0f} mm takes {max(wrap.turns, 0):.1f} turns of a bandage "
            f"{width:.0f} mm wide; take a narrower bandage or a longer leg"
        )
    return wrap


def midline_arc(surface, wrap):
    """Angles and running length of the midline on the bare surface, finely sampled."""
    turn = 2 * np.pi
    steps = int(np.ceil(wrap.turns * SAMPLES_A_TURN))
    angles = wrap.start_angle + np.linspace(0, wrap.turns * turn, 2 * steps + 1)
    z = wrap.start_height + wrap.pitch * (angles - wrap.start_angle) / turn
    rate = surface(angles, z, 1, 0) + wrap.pitch / turn * surface(angles, z, 0, 1)
    speed = np.linalg.norm(rate, axis=1)
    simpson = (speed[:-2:2] + 4 * speed[1:-1:2] + speed[2::2]) * (angles[2] - angles[0]) / 6
    return angles[::2], np.concatenate([[0.0], np.cumsum(simpson)])


def across(surface: Surface, wrap: Wrap, theta_mid: np.ndarray, columns) -> np.ndarray:
    """theta and z (rows, columns, 2) of the strip's rows at midline angles theta_mid.

    columns are rising distances from the midline over the width. Starts at the midline
    at a right angle to it, in steps of true length along the surface, keeping the
    direction as near as the tangent plane allows (Runge-Kutta 4).
    """
    z = wrap.start_height + wrap.pitch * (theta_mid - wrap.start_angle) / (2 * np.pi)
    start = np.column_stack([theta_mid, z])
    rise = wrap.pitch / (2 * np.pi)
    along = surface(theta_mid, z, 1, 0) + rise * surface(theta_mid, z, 0, 1)
    heading = np.cross(normals(surface, start), along)
    heading /= np.linalg.norm(heading, axis=1)[:, None]

    distance = wrap.width * np.asarray(columns)
    place = np.empty((len(theta_mid), len(distance), 2))
    upper = int(np.searchsorted(distance, 0.0))
    for order in (range(upper, len(distance)), range(upper - 1, -1, -1)):
        here, at = start, 0.0
        for column in order:
            if distance[column] != at:
                here = _march(surface, here, heading, distance[column] - at)
            place[:, column], at = here, distance[column]
    return place


def _march(surface, here, heading, step):
    def rate(p):
        tangents = np.stack([surface(*p.T, 1, 0), surface(*p.T, 0, 1)], axis=1)
        metric = np.einsum("pac,pbc->pab", tangents, tangents)
        flow = solve2(metric, np.einsum("pac,pc->pa", tangents, heading))
        speed = np.sqrt(np.einsum("pa,pab,pb->p", flow, metric, flow))
        return flow / speed[:, None]

    k1 = rate(here)
    k2 = rate(here + step / 2 * k1)
    k3 = rate(here + step / 2 * k2)
    k4 = rate(here + step * k3)
    return here + step / 6 * (k1 + 2 * k2 + 2 * k3 + k4)


def normals(surface, place):
    """Outward unit normals (..., 3) at theta, z (..., 2)."""
    theta, z = place[..., 0], place[..., 1]
    normal = np.cross(surface(theta, z, 1, 0), surface(theta, z, 0, 1))
    return normal / np.linalg.norm(normal, axis=-1)[..., None]
