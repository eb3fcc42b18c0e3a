"""`fit_scan`: from the scan of a person's leg to its length and shape coordinates."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np

from surrogate.errors import SolverError, nearest

from ..geometry.basis import Basis, shipped_basis
from ..geometry.cohort import load_cohort
from ..geometry.feasibility import check_leg
from ..geometry.leg import Leg
from .cuts import Cuts, find_cuts
from .decimation import decimated
from .directions import Directions
from .errors import ScanError
from .knee import knee_of
from .pose import (
    SETTLED,
    STEPS,
    Body,
    Start,
    as_left,
    lost,
    shape_of,
    stand,
    starts,
    turn_to_mean,
)
from .reading import read_surface
from .refusal import check_holes, check_skin, more_than_a_leg, why_no_leg
from .sections import THETA, Sections, cut_sections
from .units import UNITS, unit_of

SIDES = ("auto", "right", "left")

SURE_OF_SIDE = 0.2
"""By what part worse the other side must fit for the side to be told by the shape."""

ROUNDING = 1e-9

NO_LEG = 6.0
"""mm RMS that the shape modes may miss of a leg. Shipped legs that were not learnt from:
0.5 to 3.4 mm."""


@dataclass(frozen=True)
class Error:
    """Distance, mm, between points of scan and fitted leg at the same height and angle."""

    rms: float
    percentile_95: float
    largest: float


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
    length: float | None = None,
    ends: bool = False,
    basis: Basis | None = None,
    lengths: tuple[float, float] | None = None,
) -> FittedScan:
    """Fit the scan of a lower leg in an STL, PLY or OBJ file; raises ScanError.

    side     right, left, or auto: the side that fits better, if it does so clearly
    unit     of the file: mm, cm, inch, m; default: the one that makes the ankle an ankle
    up       direction in the axes of the file (z, -y ...) that points up the leg; default: the
             leg is stood up so that the mean leg, made wider or slimmer, fits it best
    front    likewise the direction of the shin; needs up
    length   mm of leg to take above the ankle; default: as far as the shipped legs go
    ends     cut where the scan ends, for a scan that was cut already
    basis    default: the shipped one with 4 modes
    lengths  smallest and largest length of the legs of the basis; default: the shipped ones'
    """
    known = Directions.parse(up, front)
    _check(side, unit, length, ends)
    basis = shipped_basis() if basis is None else basis
    surface = read_surface(path)
    try:
        whole = Body(surface.vertices, surface.triangles)
        seen = decimated(whole)
        start, found, about_unit = _start(seen, basis, unit)
        leg = _sided(start, basis, side, length, ends)
        if seen is not whole:
            posed = replace(start, body=leg.body.posing(whole))
            leg = replace(_settled(leg.side, posed, basis, length, ends), note=leg.note)
        body, cuts = leg.body, leg.cuts
        if known.up is not None:
            body = stand(body, cuts.levels, known)
            cuts = find_cuts(body, start.zone, length, ends)
        sections = _sections(body, cuts)
        notes = (
            *surface.notes,
            about_unit,
            leg.note,
            _about_pose(known),
            *cuts.notes,
            *_about_holes(sections),
        )
        fitted = _fitted(
            Path(path), sections, basis, lengths or _shipped_lengths(), leg.side, found, notes
        )
        return replace(fitted, knee=knee_of(body, cuts))
    except ScanError as error:
        raise ScanError(f"{path}: {error}") from None


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
    return "up as given; front " + ("found from the shape" if known.front is None else "as given")


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


@dataclass(frozen=True)
class _Sided:
    """A body as a right leg in the pose of the mean leg, and how it came there."""

    side: str
    body: Body
    cuts: Cuts
    missed: float
    note: str = ""


def _sided(start: Start, basis: Basis, side: str, length: float | None, ends: bool) -> _Sided:
    """The leg taken for the side that is given, or for the one that clearly fits better."""
    tried = [
        _settled(name, start if name == "right" else as_left(start, basis), basis, length, ends)
        for name in (SIDES[1:] if side == "auto" else (side,))
    ]
    best, *others = sorted(tried, key=lambda one: one.missed)
    if not others:
        return replace(best, note=f"{best.side} leg, as given")
    worse = others[0].missed / best.missed - 1
    if worse < SURE_OF_SIDE:
        _modes_of(_sections(best.body, best.cuts), basis)
        raise ScanError(
            "the shape does not tell whether this is a right or a left leg (the other "
            f"side fits only {worse:.0%} worse); give --side right or --side left"
        )
    return replace(
        best,
        note=f"{best.side} leg: found from the shape, the other side fits "
        f"{worse:.0%} worse; give --side if that is wrong",
    )


def _settled(side: str, start: Start, basis: Basis, length: float | None, ends: bool) -> _Sided:
    """Pose and cuts depend on each other: a step of each in turn until they stay."""
    body = start.body
    for _ in range(STEPS):
        cuts = find_cuts(body, start.zone, length, ends)
        body, angle = turn_to_mean(body, cuts.levels, basis)
        if angle < SETTLED:
            break
    return _Sided(side, body, cuts, _missed(body, cuts, basis))


def _missed(body: Body, cuts: Cuts, basis: Basis) -> float:
    """Norm of what all modes miss of the shape."""
    shape = shape_of(cut_sections(body.vertices, body.triangles, cuts.levels))
    return float(np.linalg.norm(lost(shape, basis, basis.modes.shape[1])))


def _sections(body: Body, cuts: Cuts) -> Sections:
    """The 100 sections, ankle centre at the origin; raises ScanError for too many holes."""
    found = cut_sections(body.vertices, body.triangles, cuts.levels)
    check_holes(found)
    return replace(found, z=found.z - cuts.ankle, centre=found.centre - found.centre[0])


def _about_holes(sections: Sections) -> tuple[str, ...]:
    holes = sections.missing.mean()
    return (f"holes make up {holes:.1%} of the skin; they are filled smoothly",) if holes else ()


def _modes_of(sections: Sections, basis: Basis) -> tuple[Leg, Error]:
    """The nearest leg of the basis and what it misses; raises ScanError for what is no leg."""
    length = float(np.ptp(sections.z))
    leg = Leg.from_alphas(length, basis.project(shape_of(sections)), basis)
    away = np.linalg.norm(sections.points - leg.surface(THETA, leg.z[:, None]), axis=-1)
    away = away[~sections.missing]
    error = Error(
        float(np.sqrt((away**2).mean())), float(np.percentile(away, 95)), float(away.max())
    )
    if error.rms > NO_LEG:
        raise ScanError(
            f"the nearest leg of the basis misses the scan by "
            f"{error.rms:.1f} mm (RMS; at most {NO_LEG:g}): this is hardly a lower "
            "leg; cut the scan to the part from ankle to knee, or say its direction "
            "with --up"
        )
    return leg, error


def _fitted(
    path: Path,
    sections: Sections,
    basis: Basis,
    lengths: tuple[float, float],
    side: str,
    unit: str,
    notes: tuple[str, ...],
) -> FittedScan:
    """The leg of the sections and of the modes; raises ScanError when they miss too much."""
    leg, error = _modes_of(sections, basis)
    ranges = {
        "length": lengths,
        **{f"alpha{k}": (float(low), float(high)) for k, (low, high) in enumerate(basis.ranges, 1)},
    }
    scanned = Leg.from_sections(leg.length, sections.series, sections.centre)
    return FittedScan(
        path,
        leg,
        scanned,
        sections,
        leg.length,
        leg.alphas or (),
        ranges,
        error,
        side,
        unit,
        (*notes, *_possible(leg, "fitted"), *_possible(scanned, "scanned")),
    )


def _possible(leg: Leg, which: str) -> tuple[str, ...]:
    """A note when the finite element model would refuse this leg."""
    try:
        check_leg(leg)
    except SolverError as error:
        return (f"the {which} leg cannot be computed: {error}",)
    return ()
