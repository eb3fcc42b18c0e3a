"""`fit_scan`: from the scan of a person's leg to its length and shape coordinates."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np

from surrogate.errors import SolverError, nearest

from ..geometry.basis import Basis, shipped_basis
from ..geometry.cohort import load_cohort
from ..geometry.feasibility import check_leg
from ..geometry.leg import Leg
from .cuts import find_cuts
from .decimation import decimated
from .directions import Directions
from .errors import ScanError
from .familiarity import unlike, widening
from .front import Front, about_front, turned_to_front
from .knee import knee_of
from .marks import Landmarks
from .nearest import Error, nearest_leg, standing_sections
from .pose import (
    Body,
    Start,
    stand,
    starts,
)
from .reading import read_surface
from .refusal import check_skin, more_than_a_leg, why_no_leg
from .sections import THETA, Sections
from .settling import SIDES, Options, Sided, settled, sided
from .units import UNITS, unit_of

ROUNDING = 1e-9


@dataclass(frozen=True)
class FittedScan:
    """A person's leg in the numbers of the shape basis.

    path      the file
    leg       the fitted leg: made from length and alphas
    scanned   the person's own leg: its 100 sections, between the same cuts, a right leg
    sections  the same as radii at `THETA`, with where the scan had holes
    length    mm between the cuts
    alphas    coordinates on the modes of the basis
    ranges    name -> (low, high) among the legs of the basis: length, alpha1 ...
    error     what the modes miss of the skin
    side      right or left; a left leg was mirrored
    unit      of the file
    notes     sentences on what was assumed, done and seen
    knee      height above the ankle cut and girth, mm, of the narrowest girth under the knee;
              None where the scan does not show it
    front     who told where the front is, and the degrees it may be off
    other     the same scan taken for the other side, where nothing tells which it is
    """

    path: Path
    leg: Leg
    scanned: Leg
    sections: Sections
    length: float
    alphas: tuple[float, ...]
    ranges: dict[str, tuple[float, float]]
    error: Error
    side: str
    unit: str
    notes: tuple[str, ...]
    knee: tuple[float, float] | None = None
    front: Front | None = None
    other: FittedScan | None = None

    @property
    def coordinates(self) -> dict[str, float]:
        """length and alpha1 ... by name."""
        return {
            "length": self.length,
            **{f"alpha{k}": alpha for k, alpha in enumerate(self.alphas, 1)},
        }

    @property
    def in_range(self) -> dict[str, bool]:
        """Whether each coordinate is between the smallest and largest of the legs of the basis.

        A leg that is itself the largest is inside: rounding is let pass.
        """
        return {
            name: low - ROUNDING <= self.coordinates[name] <= high + ROUNDING
            for name, (low, high) in self.ranges.items()
        }

    @property
    def widening(self) -> float:
        """By what the shape part of an interval grows for a leg unlike the shipped ones."""
        return widening(self.scanned, self.error.rms)

    @cached_property
    def residual(self) -> np.ndarray:
        """(100, RAYS): mm by which the scan lies outside the fitted leg, along its normal."""
        z = self.leg.z[:, None]
        fitted = self.leg.surface(THETA, z)
        normal = np.cross(self.leg.surface(THETA, z, d_theta=1), self.leg.surface(THETA, z, d_z=1))
        normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
        return ((self.sections.points - fitted) * normal).sum(axis=-1)


def fit_scan(
    path: str | Path,
    *,
    side: str = "auto",
    unit: str | None = None,
    up: str | None = None,
    front: str | None = None,
    landmarks: Sequence[str] = (),
    length: float | None = None,
    ends: bool = False,
    basis: Basis | None = None,
    lengths: tuple[float, float] | None = None,
) -> FittedScan:
    """Fit the scan of a lower leg in an STL, PLY or OBJ file; raises ScanError.

    side     right, left, or auto: by the landmarks, the foot, or the shape if it tells clearly;
             else the side that fits better, with the `other` beside it
    unit     of the file: mm, cm, inch, m; default: the one that makes the ankle an ankle
    up       direction in the axes of the file (z, -y ...) that points up the leg; default: the
             leg is stood up so that the mean leg, made wider or slimmer, fits it best
    front    likewise the direction of the shin; needs up
    landmarks  points on the skin in the axes and unit of the file, as malleolus_medial=x,y,z
    length   mm of leg to take above the ankle; default: as far as the shipped legs go
    ends     cut where the scan ends, for a scan that was cut already
    basis    default: the shipped one with 4 modes
    lengths  smallest and largest length of the legs of the basis; default: the shipped ones'
    """
    options = Options(Directions.parse(up, front), Landmarks.parse(landmarks), side, length, ends)
    _check(side, unit, length, ends)
    basis = shipped_basis() if basis is None else basis
    surface = read_surface(path)
    try:
        whole = Body(surface.vertices, surface.triangles)
        seen = decimated(whole)
        start, found, about_unit = _start(seen, basis, unit)
        legs = sided(start, basis, options)
        lengths = lengths or _shipped_lengths()
        fitted = []
        for leg in legs:
            if seen is not whole:
                posed = replace(start, body=leg.body.posing(whole))
                leg = replace(settled(leg.side, posed, basis, options), note=leg.note)
            notes = (*surface.notes, about_unit)
            fitted.append(_stood(Path(path), leg, start, basis, lengths, options, found, notes))
        best, *others = fitted
        return replace(best, other=others[0]) if others else best
    except ScanError as error:
        raise ScanError(f"{path}: {error}") from None


def _stood(
    path: Path,
    leg: Sided,
    start: Start,
    basis: Basis,
    lengths: tuple[float, float],
    options: Options,
    unit: str,
    notes: tuple[str, ...],
) -> FittedScan:
    """A settled leg turned to what is known of its directions, cut and fitted.

    Raises ScanError when the modes miss too much.
    """
    body, cuts, known = leg.body, leg.cuts, options.known
    if known.up is not None:
        body = stand(body, cuts.levels, known)
        cuts = find_cuts(body, start.zone, options.length, options.ends)
    body, front = turned_to_front(body, cuts.ankle, known, options.marks)
    sections = standing_sections(body, cuts)
    fitted, error = nearest_leg(sections, basis)
    scanned = Leg.from_sections(fitted.length, sections.series, sections.centre)
    return FittedScan(
        path,
        fitted,
        scanned,
        sections,
        fitted.length,
        fitted.alphas or (),
        _ranges(basis, lengths),
        error,
        leg.side,
        unit,
        (
            *unlike(scanned, error.rms),
            *notes,
            leg.note,
            _about_pose(known),
            about_front(front),
            *cuts.notes,
            *_about_holes(sections),
            *_possible(fitted, "fitted"),
            *_possible(scanned, "scanned"),
        ),
        knee_of(body, cuts),
        front,
    )


def _ranges(basis: Basis, lengths: tuple[float, float]) -> dict[str, tuple[float, float]]:
    """Of length and alpha1 ... among the legs of the basis."""
    alphas = ((float(low), float(high)) for low, high in basis.ranges)
    return {"length": lengths, **{f"alpha{k}": pair for k, pair in enumerate(alphas, 1)}}


def _shipped_lengths() -> tuple[float, float]:
    length = load_cohort().length
    return float(length.min()), float(length.max())


def _about_pose(known: Directions) -> str:
    """The sentence that says which directions came from the user."""
    if known.up is None:
        return (
            "direction found from the shape: turned to fit the mean leg, which removes any "
            "tilt; give --up to keep it"
        )
    return "up as given"


def _check(side: str, unit: str | None, length: float | None, ends: bool) -> None:
    """Raise ScanError for an option that cannot be."""
    if side not in SIDES:
        raise ScanError(f"side {side!r} is unknown; {nearest(side, SIDES)}")
    if unit is not None and unit not in UNITS:
        raise ScanError(f"unit {unit!r} is unknown; {nearest(unit, UNITS)}")
    if length is not None and not 100 <= length <= 500:
        raise ScanError(
            f"a length of {length:g} mm is not one of a lower leg (100 to 500 mm); "
            "give it in millimetres"
        )
    if length is not None and ends:
        raise ScanError("either a length or the ends of the scan can set the upper cut; give one")


def _start(body: Body, basis: Basis, unit: str | None) -> tuple[Start, str, str]:
    """The first guess, in mm, with the unit and the sentence about it."""
    guesses = starts(body, basis)
    if not guesses:
        raise ScanError(more_than_a_leg(body, unit) or why_no_leg(body))
    try:
        check_skin(guesses[0].body, guesses[0].zone)
        found = unit_of(guesses[0].zone.ankle_girth, unit)
    except ScanError as error:
        raise ScanError(more_than_a_leg(body, unit) or str(error)) from None
    start = guesses[0].scaled(UNITS[found])
    how = "as given" if unit else f"the ankle girth is then {start.zone.ankle_girth:.0f} mm"
    return start, found, f"unit {found}: {how}"


def _about_holes(sections: Sections) -> tuple[str, ...]:
    holes = sections.missing.mean()
    return (f"holes make up {holes:.1%} of the skin; they are filled smoothly",) if holes else ()


def _possible(leg: Leg, which: str) -> tuple[str, ...]:
    """A note when the finite element model would refuse this leg."""
    try:
        check_leg(leg)
    except SolverError as error:
        return (f"the {which} leg cannot be computed: {error}",)
    return ()
