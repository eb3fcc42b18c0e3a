"""Wrapping: where a spiral bandage lies on a leg, before anything is in equilibrium.

The strip follows the spiral of `spiral.py`. Every turn lies on the turns beneath it: a point
is lifted by half a thickness and by one more for each turn that covers it, fading over 5 mm
about the edges of that turn. The midline, lifted by the mean over the width, has the asked
stretch (with half overlap it lies just where the thickness steps); the stretch of the edges
follows from the shape of the leg. A bandage over others is lifted by their layers as well.
One that goes round the other way is laid on the leg's mirror image and mirrored back.
Units: mm, radians.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.interpolate import CubicSpline

from ..surfaces.strip import Strip, interpolate_strip
from .spiral import Surface, Wrap, across, midline_arc, normals
from .turns import BareStrip, Turn, carrying, own_turns, turns_of

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
    beneath  turns that carry points, topmost first; the skin carries what they leave over
    layers   (ns, nw + 2) number of layers there, itself and all beneath included
    theta    (ns + 1,) angle of the midline at the ends of the element rows
    bare     the strip on the bare surface, for bandages that are wrapped over it
    """

    strip: Strip
    X: np.ndarray
    lengths: np.ndarray
    points: np.ndarray
    area: np.ndarray
    density: np.ndarray
    skin: np.ndarray
    beneath: tuple[Turn, ...]
    layers: np.ndarray
    theta: np.ndarray
    bare: BareStrip

    @property
    def cover(self) -> np.ndarray:
        """Share of each point (ns, nw + 2) that turns carry, 0..1."""
        return np.asarray(sum(turn.share for turn in self.beneath))

    def mirrored(self) -> Lay:
        """The lay on the mirror image of the leg, y to -y."""
        return replace(
            self,
            strip=replace(self.strip, flip=not self.strip.flip),
            X=self.X * MIRROR,
            skin=self.skin * [-1.0, 1.0],
            theta=-self.theta,
            bare=replace(self.bare, X=self.bare.X * MIRROR, theta=-self.bare.theta),
        )


MIRROR = np.array([1.0, -1.0, 1.0])


def mirrored(surface: Surface) -> Surface:
    """The mirror image of a surface, y to -y; its angle goes round the other way."""

    def image(theta, z, d_theta=0, d_z=0):
        return (-1) ** d_theta * surface(-np.asarray(theta), z, d_theta, d_z) * MIRROR

    return image


def element_rows(surface: Surface, wrap: Wrap, around: int) -> int:
    """Number of element rows along the midline so that the narrowest turn has `around` of them.

    With as many as the skin has cells around no node of the skin lies between two rows
    of contact points without feeling either: on the mean leg, with 1.4 times as many cells as
    rows, the skin bulges between them and the pressure comes out 5 % low.
    """
    if wrap.reversed:
        onward = replace(wrap, reversed=False, start_angle=-wrap.start_angle)
        return element_rows(mirrored(surface), onward, around)
    angles, arc = midline_arc(surface, wrap)
    length = CubicSpline(angles, arc)
    starts = np.linspace(angles[0], max(angles[-1] - 2 * np.pi, angles[0]), 200)
    ends = np.minimum(starts + 2 * np.pi, angles[-1])
    rates = (length(ends) - length(starts)) / (ends - starts)
    return int(round(around * arc[-1] / (2 * np.pi * rates.min())))


def lay(surface: Surface, wrap: Wrap, ns: int, nw: int, below: Sequence[Lay] = ()) -> Lay:
    """Lay a strip of ns x nw elements whose rows have the same length along its midline.

    below  the bandages that are on the surface already, the first one first
    """
    if wrap.reversed:
        onward = replace(wrap, reversed=False, start_angle=-wrap.start_angle)
        images = [one.mirrored() for one in below]
        return lay(mirrored(surface), onward, ns, nw, images).mirrored()
    angles, arc = midline_arc(surface, wrap)
    rank = np.arange(ns + 3) - 1.0
    knots = CubicSpline(arc, angles)(rank / ns * arc[-1])
    for _ in range(EVEN_PASSES):
        laid = lay_rows(surface, wrap, knots, nw, below)
        ends = np.concatenate([[0.0], np.cumsum(laid.lengths)])
        knots = CubicSpline(ends, knots[1:-1])(rank / ns * ends[-1])
    return lay_rows(surface, wrap, knots, nw, below)


def lay_rows(
    surface: Surface, wrap: Wrap, knots: np.ndarray, nw: int, below: Sequence[Lay] = ()
) -> Lay:
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
    own = BareStrip(strip, interpolate_strip(bare[:, kept[net]]).reshape(-1, 3), wrap, theta_mid)
    passing = list(own_turns(len(below), own, bare, fine))
    for number in reversed(range(len(below))):
        passing += turns_of(number, below[number].bare, place, bare)
    covers = _over_elements(np.stack([turn.covers for turn in passing]), kept)
    wraps = [*(one.bare.wrap for one in below), wrap]
    heights = np.array([wraps[turn.bandage].thickness for turn in passing]) / wrap.thickness
    place, bare = place[:, kept], bare[:, kept]
    lift = wrap.thickness * (0.5 + (heights[:, None, None] * covers).sum(axis=0)) + wrap.above
    normal = normals(surface, place)
    X = _raised(bare, normal, lift, net)
    evenly = _raised(bare, normal, lift[:, 2:-2].mean(axis=1, keepdims=True), net)
    points = np.stack(np.meshgrid(np.arange(ns) + 0.5, columns[seen], indexing="ij"), -1)
    inner = (slice(1, -1), seen)
    beneath = (
        Turn(turn.bandage, turn.xi[:, kept][inner], turn.share[:, kept][inner])
        for turn in carrying(passing)
    )
    return Lay(
        strip=strip,
        X=X,
        lengths=_midline_lengths(strip, evenly) / wrap.stretch_at(theta_mid[1:-1]),
        points=points,
        area=(per_cell := density(strip, X, points)) * shares(nw),
        density=per_cell[:, 1:-1],
        skin=place[inner],
        beneath=tuple(beneath),
        layers=1 + covers.sum(axis=0)[inner],
        theta=knots[1:-1],
        bare=own,
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
