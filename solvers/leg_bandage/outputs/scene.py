"""The leg with its turns and its sensor, as the report shows them (`surrogate.scene`).

The undeformed skin: what the bandage presses in, some millimetres at most, is left out.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from surrogate.scene import Line, Mark, Scene

from ..geometry.landmarks import MEDIAL, Disc, b1_height
from ..geometry.leg import Leg
from ..wrapping.spiral import Wrap, across
from .answers import ANGLES, HEIGHTS

VIEWS = {
    "inside": (160.0, 8.0),
    "outside": (-20.0, 8.0),
    "front": (90.0, 8.0),
    "back": (-90.0, 8.0),
}
"""x is lateral, y anterior: the medial side is at 180 degrees."""

TURNS, EACH = 8, 36
"""Turns whose edges are drawn, more than most legs take, and points of each: the bandage ends
where its edge comes to the top of the leg, and what would lie beyond is not on the surface."""


def leg_scene(
    leg: Leg,
    wrap: Wrap | None = None,
    *,
    rule: str,
    around: float = 0.0,
    up: float = 0.0,
    fields: tuple[str, ...] = (),
) -> Scene:
    """The skin at the places of `pressure_field`, edges of the turns, and the sensor.

    leg         taken beyond its cuts where it is wrapped, because the bandage is
    rule        for B1, where the sensor lies; around, up: how far from there, mm
    Raises SolverError for a leg without B1.
    """
    theta, height = (grid.ravel() for grid in np.meshgrid(ANGLES, HEIGHTS))
    disc = Disc(MEDIAL, b1_height(leg, rule)).moved(leg, around, up)
    lines = [Line("sensor", _on_skin(leg, np.column_stack(disc.rim(leg))), closed=True)]
    if wrap is not None:
        lines.append(Line("upper edges of the turns", _on_skin(leg, _upper_edges(leg, wrap))))
    return Scene(
        points=leg.surface(np.radians(theta), height * leg.length),
        triangles=_triangles(len(HEIGHTS), len(ANGLES)),
        coordinates={"theta": theta, "height": height},
        periods={"theta": 360.0},
        fields=fields,
        lines=tuple(lines),
        marks=(Mark("sensor", _on_skin(leg, np.array([disc.theta, disc.z])), "pressure_b1"),),
        views=VIEWS,
    )


def _on_skin(leg: Leg, place: NDArray[np.float64]) -> NDArray[np.float64]:
    """theta in degrees and height over length (..., 2), of theta and z."""
    return np.asarray(place * np.array([180.0 / np.pi, 1.0 / leg.length]))


def _upper_edges(leg: Leg, wrap: Wrap) -> NDArray[np.float64]:
    """theta and z (n, 2) of the bandage's upper edge, at the same turns for every leg."""
    along = wrap.start_angle + 2 * np.pi * np.linspace(0, TURNS, TURNS * EACH + 1)
    return across(leg.surface, wrap, along, (0.0, 0.25, 0.5))[:, -1]


def _triangles(rows: int, columns: int) -> NDArray[np.intp]:
    """Triangles of a grid that is closed around, (m, 3), seen from outside counter-clockwise."""
    row, column = (grid.ravel() for grid in np.mgrid[: rows - 1, :columns])
    here, beside = row * columns + column, row * columns + (column + 1) % columns
    return np.concatenate(
        [
            np.column_stack([here, beside, beside + columns]),
            np.column_stack([here, beside + columns, here + columns]),
        ]
    )
