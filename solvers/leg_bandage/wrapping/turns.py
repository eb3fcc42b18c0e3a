"""Turns on turns: which turns lie beneath which point of a bandage, and which carries it.

Seen on the bare surface, where all turns of all bandages lie in one sheet. The topmost turn
beneath carries a point, within its edges; what it leaves over is the next one's. So the
shares of all turns and of the skin add up to one. Units: mm, radians.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..surfaces.projection import project
from ..surfaces.strip import Strip
from .spiral import Wrap

Array = NDArray[np.float64]

FADE = 5.0
"""mm about the edge of a turn over which the next one climbs onto it; no mesh size in it."""
MEETS = 1.0
"""mm; a turn beneath whose bare surface is farther than this does not pass beneath."""


@dataclass(frozen=True)
class BareStrip:
    """A bandage on the bare surface, as what is wrapped over it finds it.

    strip       its surface; X (n, 3) control points on the bare surface
    wrap        how it is put on
    theta       (ns + 2,) angles of the midline amid its rows, with one row more at both ends
    """

    strip: Strip
    X: Array
    wrap: Wrap
    theta: Array

    @property
    def rank(self) -> Array:
        """Row parameters (ns + 2,) that belong to `theta`."""
        return np.arange(len(self.theta)) - 0.5


@dataclass(frozen=True)
class Turn:
    """A turn beneath the points of a bandage; arrays begin with the points' shape.

    bandage   number of the bandage it is a turn of
    xi        (..., 2) the points' parameters on it
    share     what it carries of each, 0..1: nothing beyond its edge, where its surface is not
              defined
    """

    bandage: int
    xi: Array
    share: Array


@dataclass(frozen=True)
class Passing:
    """A turn that passes beneath: its parameters, what is within its edges, what it covers.

    inside is 0 at its edges and 1 farther in than FADE; covers is a step centred on its edges.
    """

    bandage: int
    xi: Array
    inside: Array
    covers: Array


def carrying(passing: Iterable[Passing]) -> tuple[Turn, ...]:
    """Shares of the turns beneath, topmost first: each takes what those above leave over."""
    turns: list[Turn] = []
    left: Array | float = 1.0
    for turn in passing:
        turns.append(Turn(turn.bandage, turn.xi, left * turn.inside))
        left = left * (1 - turn.inside)
    return tuple(turns)


def own_turns(number: int, own: BareStrip, bare: Array, columns: Array) -> Iterator[Passing]:
    """The earlier turns of a bandage beneath its own points, the one before first.

    bare (rows, columns, 3) are its points on the bare surface, `columns` their parameters across.
    """
    strip, wrap = own.strip, own.wrap
    depth = int(np.ceil(min(wrap.width / wrap.pitch, wrap.turns)))
    for k in range(1, depth + 1):
        row = np.interp(own.theta - 2 * np.pi * k, own.theta, own.rank, left=-9.0)
        column = columns + k * wrap.pitch * strip.nw / wrap.width
        seed = np.stack(np.broadcast_arrays(row[:, None], column), axis=-1)
        yield _passing(number, own, bare, seed)


def turns_of(number: int, earlier: BareStrip, place: Array, bare: Array) -> Iterator[Passing]:
    """The turns of an earlier bandage beneath points, the last one first.

    place (rows, columns, 2) are theta and z of the points, bare (rows, columns, 3) their places.
    """
    strip, wrap = earlier.strip, earlier.wrap
    sense = np.sign(earlier.theta[-1] - earlier.theta[0])
    path, angle = sense * earlier.theta, sense * place[..., 0]
    turn = 2 * np.pi
    first = int(np.ceil((path[0] - angle.max()) / turn))
    last = int(np.floor((path[-1] - angle.min()) / turn))
    middles = np.column_stack([earlier.rank, np.full(len(path), strip.nw / 2)])
    height = strip.at(middles, earlier.X)[:, 0, 2]
    for m in range(last, first - 1, -1):
        at = angle + m * turn
        row = np.interp(at, path, earlier.rank, left=-9.0, right=strip.ns + 9.0)
        above = place[..., 1] - np.interp(at, path, height)
        column = strip.nw / 2 + above * strip.nw / wrap.width
        yield _passing(number, earlier, bare, np.stack([row, column], axis=-1))


def _passing(number: int, turn: BareStrip, bare: Array, seed: Array) -> Passing:
    strip = turn.strip
    near = (seed[..., 0] > -2) & (seed[..., 1] < strip.nw + 2)
    near &= (seed[..., 0] < strip.ns + 2) & (seed[..., 1] > -2)
    found = seed.copy()
    found[near] = project(strip, bare[near], turn.X, seed[near])
    away = np.linalg.norm(strip.at(found[near], turn.X)[:, 0] - bare[near], axis=1)
    near[near] = away < MEETS
    width = turn.wrap.width
    return Passing(
        number,
        found,
        np.where(near, inside(found, strip, width), 0.0),
        np.where(near, inside(found, strip, width, 0.5), 0.0),
    )


def inside(xi: Array, strip: Strip, width: float, beyond: float = 0.0) -> Array:
    """0 outside the strip, rising to 1 over `FADE` within its edges, one row at its ends.

    beyond: share of FADE that lies beyond the edges.
    """
    along = np.clip(np.minimum(xi[..., 0], strip.ns - xi[..., 0]), 0, 1)
    over = np.minimum(xi[..., 1], strip.nw - xi[..., 1]) * width / strip.nw
    over = np.clip(over / FADE + beyond, 0, 1)
    return np.asarray(along**2 * (3 - 2 * along) * over**2 * (3 - 2 * over))
