"""Wrapping: where a spiral bandage lies on a leg, before anything is in equilibrium.

The strip follows the spiral of `spiral.py`. Every turn lies on the turns beneath it: a point
is lifted by half a thickness and by one more for each turn that covers it, fading over 5 mm
about the edges of that turn. The midline, lifted by the mean over the width, has the asked
stretch (with half overlap it lies just where the thickness steps); the stretch of the edges
follows from the shape of the leg. Units: mm, radians.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline

from ..surfaces.strip import Strip, interpolate_strip
from .spiral import Surface, Wrap, across, midline_arc, normals
from .turns import turns_beneath

FINER = 5
"""Places across an element, odd, at which it is looked whether a turn passes beneath."""
EVEN_PASSES = 2
"""Times the rows are shifted to even out what lifting by the layers does to them."""


@dataclass(frozen=True)
class Lay:
    """A laid bandage on ns x nw elements.

    strip    its surface; X (n, 3) the control points in place
    lengths  (ns,) unstretched warp length of each row of elements
    points   (ns, nw + 2, 2) strip parameters where contact is looked at: the midpoints of
             the elements and, so that no edge dives, both edges
    area     (ns, nw + 2) laid area that belongs to each of them, mm2
    density  (ns, nw) laid area of the elements, from their midpoints, mm2
    skin     (ns, nw + 2, 2) theta and z of the skin under each
    cover    (ns, nw + 2) share of each that the turn beneath carries, 0..1: nothing beyond its
             edge, where its surface is not defined
    beneath  (ns, nw + 2, 2) strip parameters of the point of that turn beneath
    layers   (ns, nw + 2) number of layers there, itself included
    theta    (ns + 1,) angle of the midline at the ends of the element rows
    """

    strip: Strip
    X: np.ndarray
    lengths: np.ndarray
    points: np.ndarray
    area: np.ndarray
    density: np.ndarray
    skin: np.ndarray
    cover: np.ndarray
    beneath: np.ndarray
    layers: np.ndarray
    theta: np.ndarray


def element_rows(surface: Surface, wrap: Wrap, around: int) -> int:
    """Number of element rows along the midline so that the narrowest turn has `around` of them.

    With as many as the skin has cells around no node of the skin lies between two rows
    of contact points without feeling either: on the mean leg, with 1.4 times as many cells as
    rows, the skin bulges between them and the pressure comes out 5 % low.
    """
    angles, arc = midline_arc(surface, wrap)
    length = CubicSpline(angles, arc)
    starts = np.linspace(angles[0], max(angles[-1] - 2 * np.pi, angles[0]), 200)
    ends = np.minimum(starts + 2 * np.pi, angles[-1])
    rates = (length(ends) - length(starts)) / (ends - starts)
    return int(round(around * arc[-1] / (2 * np.pi * rates.min())))


def lay(surface: Surface, wrap: Wrap, ns: int, nw: int) -> Lay:
    """Lay a strip of ns x nw elements whose rows have the same length along its midline."""
    angles, arc = midline_arc(surface, wrap)
    rank = np.arange(ns + 3) - 1.0
    knots = CubicSpline(arc, angles)(rank / ns * arc[-1])
    for _ in range(EVEN_PASSES):
        laid = lay_rows(surface, wrap, knots, nw)
        ends = np.concatenate([[0.0], np.cumsum(laid.lengths)])
        knots = CubicSpline(ends, knots[1:-1])(rank / ns * ends[-1])
    return lay_rows(surface, wrap, knots, nw)


def lay_rows(surface: Surface, wrap: Wrap, knots: np.ndarray, nw: int) -> Lay:
    """Lay a strip whose element rows end at the angles `knots` (ns + 3,).

    The first and the last row of `knots` belong to the ring of elements outside the strip.
    """
    ns = len(knots) - 3
    theta_mid = (knots[1:] + knots[:-1]) / 2
    fine = np.concatenate([[-0.5, 0.0], (np.arange(nw * FINER) + 0.5) / FINER, [nw, nw + 0.5]])
    middles = 2 + FINER // 2 + FINER * np.arange(nw)
    kept = np.concatenate([[0, 1], middles, [-2, -1]])
    columns = fine[kept]
    place = across(surface, wrap, theta_mid, fine / nw - 0.5)
    bare = surface(place[..., 0], place[..., 1])
    net, seen = np.delete(np.arange(nw + 4), [1, nw + 2]), slice(1, -1)
    strip = Strip(ns, nw)
    X = interpolate_strip(bare[:, kept[net]]).reshape(-1, 3)
    cover, beneath, covers = turns_beneath(strip, bare, X, wrap, theta_mid, fine)
    cover, beneath, place, bare = (one[:, kept] for one in (cover, beneath, place, bare))
    covers = _over_elements(covers, kept)
    lift = wrap.thickness * (0.5 + covers.sum(axis=0))
    normal = normals(surface, place)
    X = _raised(bare, normal, lift, net)
    evenly = _raised(bare, normal, lift[:, 2:-2].mean(axis=1, keepdims=True), net)
    points = np.stack(np.meshgrid(np.arange(ns) + 0.5, columns[seen], indexing="ij"), -1)
    inner = (slice(1, -1), seen)
    return Lay(
        strip=strip,
        X=X,
        lengths=_midline_lengths(strip, evenly) / wrap.stretch_at(theta_mid[1:-1]),
        points=points,
        area=(per_cell := density(strip, X, points)) * shares(nw),
        density=per_cell[:, 1:-1],
        skin=place[inner],
        cover=cover[inner],
        beneath=beneath[inner],
        layers=1 + covers.sum(axis=0)[inner],
        theta=knots[1:-1],
    )


def _raised(bare, normal, lift, net):
    """Control points (n, 3) of the strip that lies `lift` above the surface."""
    return interpolate_strip((bare + lift[..., None] * normal)[:, net]).reshape(-1, 3)


def shares(nw):
    """Weights (nw + 2,) of the points across that integrate every B-spline exactly.

    A uniform pressure then needs the same pressure at all of them, edges included.
    """
    strip = Strip(1, nw)
    columns = np.concatenate([[0.0], np.arange(nw) + 0.5, [nw]])
    nodes, weights = strip.stencil(np.column_stack([np.full(nw + 2, 0.5), columns]))
    values = np.zeros((nw + 2, nw + 2))
    for row, (node, weight) in enumerate(zip(nodes % (nw + 2), weights[0], strict=True)):
        np.add.at(values[:, row], node, weight)
    whole = np.ones(nw + 2)
    whole[[0, -1]], whole[[1, -2]] = 1 / 6, 5 / 6
    if nw == 1:
        whole[1] = 2 / 3
    return np.linalg.solve(values, whole)


def _over_elements(covers, kept):
    """Covers (k, rows, kept columns) with their means over the width of each element.

    Seen in the middles only, the step onto a turn would move by up to half an element.
    """
    inner = covers[:, :, 2:-2]
    means = inner.reshape(*inner.shape[:2], -1, FINER).mean(axis=-1)
    covers = covers[:, :, kept]
    covers[:, :, 2:-2] = means
    return covers


GAUSS = np.array([0.5 - np.sqrt(0.15), 0.5, 0.5 + np.sqrt(0.15)]), np.array([5, 8, 5]) / 18


def _midline_lengths(strip, X):
    """Length of the midline inside each row of elements, (ns,)."""
    s = np.arange(strip.ns)[:, None] + GAUSS[0]
    xi = np.column_stack([s.ravel(), np.full(s.size, strip.nw / 2)])
    speed = np.linalg.norm(strip.at(xi, X)[:, 1], axis=1)
    return speed.reshape(strip.ns, 3) @ GAUSS[1]


def density(strip, X, points):
    """Area per unit of the strip's parameters at points (..., 2), mm2."""
    jet = strip.at(points.reshape(-1, 2), X)
    area = np.linalg.norm(np.cross(jet[:, 1], jet[:, 2]), axis=1)
    return area.reshape(points.shape[:-1])
