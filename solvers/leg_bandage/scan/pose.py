"""Stand a leg up: z from ankle to calf, y to the front, x to the outside of a right leg.

The shape of a leg tells its pose only up to a convention. Here a leg is turned until the
first shape mode alone, the mean leg made wider or slimmer, fits its sections best (least
squares in the norm of the basis; Gauss-Newton on the three angles). The tilt that the
person had in front of the scanner is thereby taken out; `stand` puts it back when the
user knows which direction is up, and turns the leg to the front that the user knows.

The start is found by trying: axes from the principal directions of the surface, both ends
up, the narrowest ankle with a calf above it, 72 turns about the axis; the best fit wins.
"""

from __future__ import annotations

from dataclasses import astuple, dataclass, field, replace

import numpy as np
from scipy.spatial.transform import Rotation

from ..geometry.basis import INNER, Basis
from ..geometry.cohort import SECTIONS, snapshot
from .directions import Directions
from .errors import ScanError
from .girths import Profile, Zone, profile, zones
from .reading import triangle_areas
from .sections import Sections, cut_sections

TURNS = np.radians(np.arange(0, 360, 5))
DIFFERENCE = 5e-3
"""rad, of the finite differences: far above the facets of the mesh, far below its shape."""
SETTLED, STEPS = 1e-4, 15
"""rad; moves an alpha by 0.0002. Five steps are usual."""

CREDIBLE = 60.0
"""degrees between a direction that is given and the one that the shape tells."""


@dataclass(frozen=True)
class Body:
    """A surface in some pose: vertices (n, 3), triangles (m, 3).

    Its vertices are scale frame x + shift of those x in the file: frame (3, 3) takes directions
    in the axes of the file to those of the pose.
    """

    vertices: np.ndarray
    triangles: np.ndarray
    frame: np.ndarray = field(default_factory=lambda: np.eye(3))
    shift: np.ndarray = field(default_factory=lambda: np.zeros(3))
    scale: float = 1.0

    def turned(self, rotation: np.ndarray) -> Body:
        """Turned by a matrix (3, 3); a reflection turns the triangles inside out, no harm here."""
        return replace(
            self,
            vertices=self.vertices @ rotation.T,
            frame=rotation @ self.frame,
            shift=rotation @ self.shift,
        )

    def moved(self, by) -> Body:
        """Shifted by (3,)."""
        by = np.asarray(by, float)
        return replace(self, vertices=self.vertices + by, shift=self.shift + by)

    def scaled(self, factor: float) -> Body:
        """In another unit."""
        return replace(
            self,
            vertices=factor * self.vertices,
            shift=factor * self.shift,
            scale=factor * self.scale,
        )

    def posing(self, other: Body) -> Body:
        """Another surface, still as in the file, in the pose of this one."""
        vertices = self.scale * other.vertices @ self.frame.T + self.shift
        return replace(self, vertices=vertices, triangles=other.triangles)


@dataclass(frozen=True)
class Start:
    """A first guess: the body in it, its ankle and calf, its relative misfit to the mean leg."""

    body: Body
    zone: Zone
    misfit: float

    def scaled(self, factor: float) -> Start:
        """The same in another unit."""
        zone = Zone(*(factor * number for number in astuple(self.zone)))
        return replace(self, body=self.body.scaled(factor), zone=zone)


MIRROR = np.diag([-1.0, 1.0, 1.0])


def starts(body: Body, basis: Basis) -> list[Start]:
    """Guesses for a right leg, best first; [] when no axis shows an ankle under a calf."""
    guesses = []
    for axis in _axes(body)[::2]:
        up, down = body.turned(_to_z(axis)), body.turned(_to_z(-axis))
        seen = profile(up.vertices, up.triangles)
        guesses += [_upright(up, seen), _upright(down, seen.upside_down)]
    found = [_turned_best(Start(*guess, np.inf), basis) for guess in guesses if guess is not None]
    return sorted(found, key=lambda start: start.misfit)


def as_left(start: Start, basis: Basis) -> Start:
    """The same body mirrored, so that a left leg is a right one."""
    return _turned_best(replace(start, body=start.body.turned(MIRROR)), basis)


def _axes(body: Body) -> list[np.ndarray]:
    """Both senses of the principal directions of the surface, longest first."""
    corners = body.vertices[body.triangles]
    weight = triangle_areas(corners)
    middle = corners.mean(axis=1)
    away = middle - weight @ middle / weight.sum()
    _, directions = np.linalg.eigh((away * weight[:, None]).T @ away)
    return [sense * directions[:, k] for k in (2, 1, 0) for sense in (1, -1)]


def along_principal(body: Body) -> list[Body]:
    """The body with each of its principal directions along z, longest first."""
    return [body.turned(_to_z(axis)) for axis in _axes(body)[::2]]


def _to_z(axis: np.ndarray) -> np.ndarray:
    """A rotation (3, 3) that takes the direction axis (3,) to z."""
    axis = axis / np.linalg.norm(axis)
    side = np.eye(3)[np.abs(axis).argmin()]
    x = np.cross(side, axis)
    x /= np.linalg.norm(x)
    return np.array([x, np.cross(axis, x), axis])


def _upright(body: Body, girths: Profile) -> tuple[Body, Zone] | None:
    """The body with its line of centres from ankle to calf along z, and its narrowest zone.

    It is turned three times, for the sections turn with it. girths: its profile as it is.
    """
    for _ in range(3):
        seen = zones(girths)
        if not seen:
            return None
        z = np.linspace(seen[0].ankle, seen[0].calf, 12)
        centre = cut_sections(body.vertices, body.triangles, z).centre
        body = body.turned(_to_z(np.append(np.polyfit(z, centre, 1)[0], 1.0)))
        girths = profile(body.vertices, body.triangles)
    seen = zones(girths)
    return (body, seen[0]) if seen else None


def _turned_best(start: Start, basis: Basis) -> Start:
    """Turned about z to fit the mean leg best."""
    z = np.linspace(start.zone.ankle, start.zone.calf, SECTIONS)
    misfits = _misfits(cut_sections(start.body.vertices, start.body.triangles, z), basis)
    turn = Rotation.from_rotvec([0, 0, TURNS[misfits.argmin()]]).as_matrix()
    return Start(start.body.turned(turn), start.zone, float(misfits.min()))


def _misfits(sections: Sections, basis: Basis) -> np.ndarray:
    """Relative misfit (turn,) of the sections to the first mode, after each of the TURNS."""
    series, place = sections.series, (sections.centre - sections.centre[0]) @ [1, 1j]
    phase = np.exp(1j * np.outer(TURNS, np.arange(1, 6)))[:, None]
    waves = (series[:, 1:6] + 1j * series[:, 6:]) * phase
    mean = np.broadcast_to(series[:, :1], (*waves.shape[:2], 1))
    place = place * np.exp(1j * TURNS)[:, None]
    shapes = snapshot(
        np.concatenate([mean, waves.real, waves.imag], axis=-1),
        np.stack([place.real, place.imag], axis=-1),
        np.full(len(TURNS), np.ptp(sections.z)),
    )
    return np.linalg.norm(lost(shapes, basis, 1), axis=1) / np.linalg.norm(shapes, axis=1)


def lost(shapes: np.ndarray, basis: Basis, modes: int) -> np.ndarray:
    """What the first modes leave of snapshots (..., 1300)."""
    first = basis.modes[:, :modes]
    return shapes - INNER * shapes @ first @ first.T


def shape_of(sections: Sections) -> np.ndarray:
    """Snapshot (1300,) of sections, centres about the lowest."""
    return snapshot(
        sections.series, sections.centre - sections.centre[0], sections.z[-1] - sections.z[0]
    )


def turn_to_mean(body: Body, z: np.ndarray, basis: Basis) -> tuple[Body, float]:
    """One Gauss-Newton step towards the pose in which the mean leg fits best.

    Turns about the centre of the lowest section; z (100,): the levels, which stay. Returns
    the body, with that centre at x = y = 0, and the angle, rad.
    """
    body = _centred(body, z)
    here = _misfit_of(body, z, basis)
    turns = [Rotation.from_rotvec(DIFFERENCE * axis).as_matrix() for axis in np.eye(3)]
    columns = [
        (_misfit_of(_about(body, turn, z[0]), z, basis) - here) / DIFFERENCE for turn in turns
    ]
    step = -np.linalg.lstsq(np.column_stack(columns), here, rcond=None)[0]
    turn = Rotation.from_rotvec(step).as_matrix()
    return _about(body, turn, z[0]), float(np.linalg.norm(step))


def stand(body: Body, z: np.ndarray, known: Directions) -> Body:
    """A settled body turned to the directions that are known, about its lowest section.

    Raises ScanError for directions that the leg cannot have.
    """
    if known.up is None:
        return body
    up = body.frame @ known.up
    _credible("up", up, [0, 0, 1.0])
    tilt = Rotation.align_vectors([[0, 0, 1.0]], [up])[0].as_matrix()
    body = _about(_centred(body, z), tilt, z[0])
    if known.front is None:
        return body
    front = body.frame @ known.front
    _credible("front", front, [0, 1.0, 0])
    turn = np.pi / 2 - np.arctan2(front[1], front[0])
    return _about(body, Rotation.from_rotvec([0, 0, turn]).as_matrix(), z[0])


def _credible(which: str, given: np.ndarray, told) -> None:
    apart = np.degrees(np.arccos(np.clip(given @ told, -1, 1)))
    if apart > CREDIBLE:
        raise ScanError(
            f"the direction given as {which} is {apart:.0f} degrees from that which "
            f"the shape of the leg tells (at most {CREDIBLE:g}); give another "
            f"--{which}, or leave it out"
        )


def _centred(body: Body, z: np.ndarray) -> Body:
    centre = cut_sections(body.vertices, body.triangles, z[:2]).centre[0]
    return body.moved([-centre[0], -centre[1], 0])


def _misfit_of(body: Body, z: np.ndarray, basis: Basis) -> np.ndarray:
    return lost(shape_of(cut_sections(body.vertices, body.triangles, z)), basis, 1)


def _about(body: Body, turn: np.ndarray, height: float) -> Body:
    """Turned about the point (0, 0, height)."""
    pivot = np.array([0, 0, height])
    return body.moved(-pivot).turned(turn).moved(pivot)
