"""Points that have slid past the turn that carried them, and what takes them then.

As laid, every point faces what is beneath it. While a bandage slides a point may come past the
edge or the end of a turn, where that turn's surface is not defined: what lies beneath there takes
it, the next turn or the skin. It starts without pressure, and comes to lie as high above what
takes it as their thicknesses ask. Units: N, mm, MPa.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..contact.point_to_surface import Contact, Points
from ..surfaces.projection import project
from ..surfaces.strip import Strip
from ..wrapping.lay import Lay
from ..wrapping.spiral import Wrap
from .facing import Facing

Array = NDArray[np.float64]

PAST = 1.0
"""Cells beyond a turn's rim at which it lets a point go: so far its surface goes on well."""
NEAR = 5.0
"""mm: a turn farther than this does not lie beneath."""


@dataclass(frozen=True)
class Sheet:
    """A bandage with what it faces.

    on_skin  (points, 2) parameters of all its laid points on the skin
    """

    strip: Strip
    lay: Lay
    wrap: Wrap
    facing: Facing
    on_skin: Array


def let_go(sheets: Sequence[Sheet], x: Array) -> bool:
    """Hand over the points that have slid past their turn; whether there were any.

    sheets  the first bandage first; x (nodes, 3) positions in a state that was accepted
    """
    found = False
    for sheet in sheets:
        for contact in sheet.facing.contacts[1:]:
            if contact.current.bonded:
                continue
            gone = outside(contact.current.xi, contact.surface) & ~contact.points.tied
            if gone.any():
                found = True
                points = contact.points.some(gone)
                contact.drop(gone)
                _hand_over(sheet, sheets, points, x)
    return found


def outside(xi: Array, strip: Strip, by: float = PAST) -> NDArray[np.bool_]:
    """Which parameters (n, 2) lie farther than so many cells outside of the strip."""
    return np.asarray(((xi < -by) | (xi > np.array([strip.ns, strip.nw]) + by)).any(axis=1))


def _hand_over(sheet: Sheet, sheets: Sequence[Sheet], points: Points, x: Array) -> None:
    """Give points to the topmost turn beneath each of them, else to the skin."""
    for contact, seeds, height in _beneath(sheet, sheets):
        strip, seed = contact.surface, seeds[points.laid]
        near = np.flatnonzero(~outside(seed, strip, 2.0))
        xi = project(strip, points.some(near).at(x), x, seed[near])
        away = np.linalg.norm(points.some(near).at(x) - strip.at(xi, x)[:, 0], axis=1)
        here = near[(away < NEAR) & ~outside(xi, strip, 0.0)]
        contact.take(points.some(here), xi[np.isin(near, here)], height, x)
        points = points.some(np.setdiff1d(np.arange(len(points.area)), here))
    skin = sheet.facing.skin
    xi = project(skin.surface, points.at(x), x, sheet.on_skin[points.laid])
    skin.take(points, xi, sheet.wrap.above + sheet.wrap.thickness / 2, x)


def _beneath(sheet: Sheet, sheets: Sequence[Sheet]) -> Iterator[tuple[Contact, Array, float]]:
    """Turns that may take a point, topmost first: contact, parameters as laid, height above it."""
    for turn in sheet.lay.beneath:
        below = sheets[turn.bandage]
        height = (sheet.wrap.thickness + below.wrap.thickness) / 2
        for contact in sheet.facing.contacts[1:]:
            if contact.surface is below.strip:
                yield contact, turn.xi.reshape(-1, 2), height
