"""Wrapping: where a spiral bandage lies on a leg, before anything is in equilibrium.

The midline climbs a helix of constant pitch in the leg's coordinates (theta, z). Across
its width the strip follows lines that leave the midline at a right angle and stay in the
tangent plane, at true length. Every turn lies on the turns beneath it: a point is lifted
by half a thickness and by one more for each turn that covers it, fading over 5 mm about the
edges of that turn. The midline, lifted by the mean over the width, has the asked stretch (with
half overlap it lies just where the thickness steps); the stretch of the edges follows from the
shape of the leg. Units: mm, radians.

A surface to wrap is a function (theta, z, d_theta, d_z) -> points (..., 3) or their
first derivatives, like `Leg.surface`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline

from solvers.leg_bandage.projection import project, solve2
from solvers.leg_bandage.surfaces import Strip, interpolate_strip
from surrogate.errors import SolverError

Surface = Callable[..., np.ndarray]
SAMPLES_A_TURN = 180
FADE = 5.0
"""mm about the edge of a turn over which the next one climbs onto it; no mesh size in it."""
MEETS = 1.0
"""mm; a turn beneath whose bare surface is farther than this does not pass beneath."""
FINER = 5
"""Places across an element, odd, at which it is looked whether a turn passes beneath."""
EVEN_PASSES = 2
"""Times the rows are shifted to even out what lifting by the layers does to them."""


@dataclass(frozen=True)
class Wrap:
    """How a bandage is put on.

    start_height  z of the midline at the first end, mm
    end_height    z of the midline at the free end, mm
    pitch         climb of the midline in one turn, mm
    stretch       warp stretch of the midline
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

    @property
    def turns(self) -> float:
        """Number of turns, not rounded."""
        return (self.end_height - self.start_height) / self.pitch


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
    cover, beneath, covers = _turns_beneath(strip, bare, X, wrap, theta_mid, fine)
    cover, beneath, place, bare = (one[:, kept] for one in (cover, beneath, place, bare))
    covers = _over_elements(covers, kept)
    lift = wrap.thickness * (0.5 + covers.sum(axis=0))
    normal = _normal(surface, place)
    X = _raised(bare, normal, lift, net)
    evenly = _raised(bare, normal, lift[:, 2:-2].mean(axis=1, keepdims=True), net)
    points = np.stack(np.meshgrid(np.arange(ns) + 0.5, columns[seen], indexing="ij"), -1)
    inner = (slice(1, -1), seen)
    return Lay(
        strip=strip,
        X=X,
        lengths=_midline_lengths(strip, evenly) / wrap.stretch,
        points=points,
        area=(per_cell := density(strip, X, points)) * _shares(nw),
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


def _shares(nw):
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
    heading = np.cross(_normal(surface, start), along)
    heading /= np.linalg.norm(heading, axis=1)[:, None]

    distance = wrap.width * np.asarray(columns)
    place = np.empty((len(theta_mid), len(distance), 2))
    upper = int(np.searchsorted(distance, 0.0))
    for order in (range(upper, len(distance)), range(upper - 1, -1, -1)):
        here, at = start, 0.0
        for column in order:
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


def _normal(surface, place):
    """Outward unit normals (..., 3) at theta, z (..., 2)."""
    theta, z = place[..., 0], place[..., 1]
    normal = np.cross(surface(theta, z, 1, 0), surface(theta, z, 0, 1))
    return normal / np.linalg.norm(normal, axis=-1)[..., None]


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


def _over_elements(covers, kept):
    """Covers (k, rows, kept columns) with their means over the width of each element.

    Seen in the middles only, the step onto a turn would move by up to half an element.
    """
    inner = covers[:, :, 2:-2]
    means = inner.reshape(*inner.shape[:2], -1, FINER).mean(axis=-1)
    covers = covers[:, :, kept]
    covers[:, :, 2:-2] = means
    return covers


def _turns_beneath(strip, bare, X, wrap, theta_mid, columns):
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
