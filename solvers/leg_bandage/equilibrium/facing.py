"""What faces what: the contacts of a laid bandage with the skin and with the turns beneath.

All gaps are zero as laid. A point that several turns and the skin carry is a point of each of
these contacts, with its share of the area. Units: N, mm, MPa.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..contact.law import ContactLaw
from ..contact.point_to_surface import Contact, Points
from ..surfaces.strip import Strip
from ..wrapping.lay import Lay

CARRIED = 1e-6
"""Share below which a surface does not carry a point."""


@dataclass
class Facing:
    """The contacts of one bandage.

    skin    with the skin
    turns   with its own turns; without points where it has none beneath
    over    with the bandages beneath, those that it meets
    laid    the points of `skin` as laid
    """

    skin: Contact
    turns: Contact
    over: tuple[Contact, ...]
    laid: Points

    @property
    def points(self) -> dict[str, NDArray[np.intp]]:
        """Which of the laid points (flattened) face "skin" and "layers", the bandage's turns."""
        return {"skin": self.skin.points.laid, "layers": self.turns.points.laid}

    def on_skin(self, p: NDArray[np.float64], laid: Lay) -> NDArray[np.float64]:
        """Pressure per laid area (ns, nw + 2) on the skin, of p (n,) at the points of `skin`."""
        pressure = np.zeros(laid.area.size)
        if self.skin.points is self.laid:
            pressure[self.laid.laid] = p
            return np.asarray(pressure.reshape(laid.area.shape) * (1 - laid.cover))
        np.add.at(pressure, self.skin.points.laid, p * self.skin.points.area)
        return pressure.reshape(laid.area.shape) / laid.area

    @property
    def contacts(self) -> list[Contact]:
        """All of them."""
        return [self.skin, self.turns, *self.over]


def facing(
    laid: Lay,
    strips: Sequence[Strip],
    X: NDArray[np.float64],
    skin: Any,
    seeds: NDArray[np.float64],
    tied: NDArray[np.bool_],
    on_skin: ContactLaw,
    between: ContactLaw,
) -> Facing:
    """The contacts of the last of `strips`, laid as `laid`, with the skin and all of them.

    X (nodes, 3) places of all nodes, kept by reference
    seeds (points, 2) parameters of the laid points on the surface `skin`
    tied (points,) those that always stick
    """
    number = len(strips) - 1
    nodes, weights = strips[-1].stencil(laid.points.reshape(-1, 2))
    area, cover = laid.area.ravel(), laid.cover.ravel()

    def contact(which, surface, xi, share, law):
        points = Points(nodes[which], weights[0][which], share, tied[which], which)
        part = Contact(points, surface, X, xi, np.zeros(len(which)), law)
        part.close()
        return part

    bare = np.flatnonzero(cover < 1 - CARRIED)
    on = [_carried_by(laid, below) for below in range(number + 1)]
    turns = [
        contact(which, surface, xi, area[which] * share, between)
        for surface, (which, xi, share) in zip(strips, on, strict=True)
    ]
    with_skin = contact(bare, skin, seeds[bare], (area * (1 - cover))[bare], on_skin)
    over = (one for one, (which, _, _) in zip(turns[:-1], on, strict=False) if len(which))
    return Facing(with_skin, turns[-1], tuple(over), with_skin.points)


def _carried_by(laid: Lay, bandage: int):
    """Points that turns of a bandage carry: which, where on it (n, 2), and their shares (n,)."""
    found = []
    for turn in laid.beneath:
        if turn.bandage == bandage:
            share = turn.share.ravel()
            which = np.flatnonzero(share > CARRIED)
            found.append((which, turn.xi.reshape(-1, 2)[which], share[which]))
    if not found:
        return np.zeros(0, int), np.zeros((0, 2)), np.zeros(0)
    which, xi, share = (np.concatenate(parts) for parts in zip(*found, strict=True))
    order = np.argsort(which, kind="stable")
    return which[order], xi[order], share[order]
