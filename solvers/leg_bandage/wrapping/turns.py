"""Turns on turns: which turn of a spiral lies beneath which point of another.

Seen on the bare surface, where all turns lie in one sheet. Units: mm.
"""

from __future__ import annotations

import numpy as np

from ..surfaces.projection import project

FADE = 5.0
"""mm about the edge of a turn over which the next one climbs onto it; no mesh size in it."""
MEETS = 1.0
"""mm; a turn beneath whose bare surface is farther than this does not pass beneath."""


def turns_beneath(strip, bare, X, wrap, theta_mid, columns):
    """How turns lie on turns, seen at the points of the bare strip (rows, columns).

    Returns the share of each point that the turn beneath carries (rows, columns), the point's
    parameters on that turn (rows, columns, 2), and what each turn beneath, the next first,
    covers of it (k, rows, columns), in a step that is centred on that turn's edge.
    bare (rows, columns, 3) lies on the surface, X are the control points of the bare strip.
    """
    shape = bare.shape[:2]
    rank = np.arange(shape[0]) - 0.5
    depth = int(np.ceil(min(wrap.width / wrap.pitch, wrap.turns)))
    covers = np.zeros((depth, *shape))
    beneath = np.zeros((*shape, 2))
    for k in range(1, depth + 1):
        row = np.interp(theta_mid - 2 * np.pi * k, theta_mid, rank, left=-9.0)
        column = columns + k * wrap.pitch * strip.nw / wrap.width
        seed = np.stack(np.broadcast_arrays(row[:, None], column), axis=-1)
        near = (seed[..., 0] > -2) & (seed[..., 1] < strip.nw + 2)
        found = seed.copy()
        found[near] = project(strip, bare[near], X, seed[near])
        near[near] = np.linalg.norm(strip.at(found[near], X)[:, 0] - bare[near], axis=1) < MEETS
        covers[k - 1] = np.where(near, _inside(found, strip, wrap.width, 0.5), 0.0)
        if k == 1:
            carried = np.where(near, _inside(found, strip, wrap.width), 0.0)
            beneath = found
    return carried, beneath, covers


def _inside(xi, strip, width, beyond=0.0):
    """0 outside the strip, rising to 1 over `FADE` within its edges, one row at its first end.

    beyond: share of FADE that lies beyond the edges.
    """
    along = np.clip(xi[..., 0], 0, 1)
    over = np.minimum(xi[..., 1], strip.nw - xi[..., 1]) * width / strip.nw
    over = np.clip(over / FADE + beyond, 0, 1)
    return along**2 * (3 - 2 * along) * over**2 * (3 - 2 * over)
