"""`predict_pressure`: the pressure under a bandage on the leg of a scan, three ways.

By the reduced model on the leg that the shape modes make of the scan, corrected to the
scan's own sections, with an interval; by Laplace's law; if asked, by the finite element model.
"""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from surrogate.errors import SolverError

from ..bandage.products import STRETCH
from ..geometry.leg import Leg
from ..plugin import LegBandage
from ..scan import FittedScan
from .along import GRADIENT, Curve, Point, curve_of, points_of
from .bandage_choice import BandageChoice
from .hand import OVERLAP
from .interval import Part, joined, parts_of
from .points import KNEE_GIRTH, KNEE_HEIGHT, ONE_LAYER, RADIUS, under_sensor
from .pose import other_shapes, pose_parts
from .reduced import Reduced
from .shape import RuleAtB1, Shape, b1_by_rules
from .shape_correction import by_laplace_if_it_can, by_tape, shape_law
from .worn import Hoop, hoop_on
from .worn_pressure import WornPressure, worn_pressures


@dataclass(frozen=True)
class Skin:
    """Pressure all over the skin, mmHg.

    theta     (a,) degrees from the outside by the front (90) to the inside (180) of the leg
    height    (h,) over the length of the leg
    pressure  (a, h)
    """

    theta: np.ndarray
    height: np.ndarray
    pressure: np.ndarray


@dataclass(frozen=True)
class Solved:
    """The finite element model on the scan's own sections: mmHg at B1, and all over the skin."""

    mesh: str
    value: float
    skin: Skin
    seconds: float


@dataclass(frozen=True)
class Prediction:
    """The pressure at B1 on a person's leg.

    value, low, high  mmHg, by the reduced model on the scan's own sections, 95 % interval
    on_modes          mmHg, by the reduced model on the leg of the shape modes
    factor            value / on_modes (`shape_correction`); None where Laplace's law has no answer
    parts             what the interval is made of
    inputs            of the reduced model
    outside           name -> (value, low, high) of inputs beyond the runs it is learnt from
    laplace           mmHg by Laplace's law, curvature under the sensor, on the `scanned` and the
                      `fitted` leg; None without B1
    tape              mmHg by Laplace's law on the girth of the scan at B1; None without B1
    solved            None unless asked for
    unsolved          why the finite element model has no answer; empty if it has, or was not asked
    points            the pressure at B, B1, C and D
    gradient          mmHg at ankle and knee that the points are set against
    """

    scan: FittedScan
    choice: BandageChoice
    reduced: Reduced
    value: float
    low: float
    high: float
    on_modes: float
    factor: float | None
    parts: tuple[Part, ...]
    inputs: Mapping[str, float]
    outside: Mapping[str, tuple[float, float, float]]
    laplace: Mapping[str, float | None]
    tape: float | None
    solved: Solved | None
    unsolved: str
    points: tuple[Point, ...]
    gradient: tuple[float, float]

    @property
    def extrapolates(self) -> bool:
        """Whether the reduced model is asked beyond its runs."""
        return bool(self.outside)

    @property
    def notes(self) -> tuple[str, ...]:
        """Sentences on what the numbers do and do not say."""
        return tuple(_notes(self))

    def skin(self) -> Skin:
        """Pressure all over the skin: solved if it was, else the reduced model's."""
        if self.solved:
            return self.solved.skin
        return Skin(*self.reduced.skin_pressure(self.inputs))

    def rules(self) -> dict[str, RuleAtB1]:
        """B1 by each rule on the leg of the shape modes, and the pressure there."""
        return b1_by_rules(Shape.of(self.scan), self.reduced, self.choice)

    def hoop(self) -> Hoop | None:
        """The bandage at B1 of the scan's own sections as a hoop; None without B1."""
        place = Shape.of(self.scan).places().get("B1")
        if place is None:
            return None
        return hoop_on(self.scan.scanned, place.height, self.choice.stretch)

    def worn(self) -> tuple[WornPressure, ...]:
        """The pressure at B1 standing, and lying after four hours; nothing without B1."""
        return worn_pressures((self.value, self.low, self.high), self.hoop())

    def curve(self) -> Curve:
        """Mean and range around the leg, along it: of `skin`."""
        skin = self.skin()
        return curve_of(skin.pressure, skin.height, self.scan.length)

    def solved_at(self, point: Point) -> float | None:
        """mmHg at a point by the finite element model; None where it was not asked."""
        if self.solved is None:
            return None
        skin = self.solved.skin
        read = under_sensor(
            skin.theta, skin.height, skin.pressure, self.scan.scanned, point.place.read
        )
        return read * point.place.carried


def predict_pressure(
    scan: FittedScan,
    choice: BandageChoice,
    reduced: Reduced,
    mesh: str | None = None,
    gradient: tuple[float, float] = GRADIENT,
) -> Prediction:
    """The pressure at B1 and along the leg.

    Raises ScanError where nothing tells the side of the leg and the two give other pressures.

    mesh      of the finite element model to solve beside, None for none
    gradient  mmHg at ankle and knee to set the points against
    """
    shape = Shape.of(scan)
    inputs = reduced.inputs(shape.coordinates, choice)
    laplace = {
        name: by_laplace_if_it_can(leg, choice.effective_tension)
        for name, leg in (("scanned", scan.scanned), ("fitted", scan.leg))
    }
    factor = shape_law().factor(laplace)
    on_modes = float(reduced.at_b1.predict(reduced.coded(inputs))[0])
    value = on_modes if factor is None else factor * on_modes
    others = other_shapes(scan, shape)
    parts = (
        *parts_of(reduced, inputs, factor, choice, scan.widening),
        *pose_parts(scan, value, others, reduced, choice),
    )
    outside = reduced.outside(inputs)
    solved, unsolved = solved_or_why(scan.scanned, choice, mesh)
    return Prediction(
        scan,
        choice,
        reduced,
        value,
        *joined(value, parts),
        on_modes,
        factor,
        parts,
        inputs,
        outside,
        laplace,
        by_tape(scan.scanned, choice.effective_tension),
        solved,
        unsolved,
        points_of(
            shape,
            reduced,
            choice,
            (value, parts),
            [one for shapes in others.values() for one in shapes],
            scan.widening,
            gradient,
        ),
        gradient,
    )


def solve_on(
    leg: Leg,
    choice: BandageChoice,
    mesh: str,
    overlap: float = OVERLAP,
    stretch_free: float | None = None,
) -> Solved:
    """The finite element model on the sections of this leg; raises SolverError.

    stretch_free  at the free end, where the stretch changes along the leg
    """
    start = time.perf_counter()
    values = (
        LegBandage(mesh=mesh)
        .run(
            leg,
            stretch_free,
            tension=choice.tension,
            stretch=choice.stretch,
            mu_skin=choice.mu_skin,
            overlap=overlap,
        )
        .values
    )
    grid = LegBandage.outputs["pressure_field"].coordinates
    return Solved(
        mesh,
        float(values["pressure_b1"]),
        Skin(grid["theta"], grid["height"], np.asarray(values["pressure_field"])),
        time.perf_counter() - start,
    )


def solved_or_why(
    leg: Leg,
    choice: BandageChoice,
    mesh: str | None,
    overlap: float = OVERLAP,
    stretch_free: float | None = None,
) -> tuple[Solved | None, str]:
    """What `solve_on` gives, or why it has no answer; neither without a mesh."""
    if mesh is None:
        return None, ""
    try:
        return solve_on(leg, choice, mesh, overlap, stretch_free), ""
    except SolverError as error:
        return None, str(error)


def _notes(told: Prediction) -> Iterator[str]:
    choice = told.choice
    if told.outside:
        yield (
            f"The reduced model extrapolates: {_beyond(told.outside)}. Chassagne et al. 2018 "
            "discarded such legs; Laplace's law and --solve, on the scan's own sections, are "
            "the better word here."
        )
    if told.factor is None:
        yield (
            "Laplace's law has no answer at B1 for this leg, so the reduced model's pressure is "
            "that of the leg of the shape modes, uncorrected."
        )
    else:
        yield (
            f"The reduced model's pressure on the leg of the shape modes is multiplied by "
            f"{told.factor:.3f}, Laplace's law on the scan's own sections over that on the "
            f"modes, to the power {shape_law().exponent:.2f}, which finite elements on "
            "validation legs gave."
        )
    if choice.mu_range is None:
        yield f"mu_skin {choice.mu_skin:g} is taken as known: the interval has no part for it."
    if choice.stretch != STRETCH and "stretch" not in told.inputs:
        yield (
            f"The runs are at stretch {STRETCH:g}. Stretch {choice.stretch:g} reaches them as "
            f"the tension K1 (stretch - 1) = {choice.effective_tension:.4f} N/mm, K1 = "
            f"{choice.constant:.4f} N/mm (Chassagne et al. 2018, equation 10): a straight line "
            f"for the bandage, and a loss of stretch on the leg as at {STRETCH:g}."
        )
    if choice.hand is None:
        yield "Stretch and overlap are taken as laid: the interval has no part for the hand."
    yield from _about_rules(told)
    yield from _about_points(told)
    if told.solved:
        yield (
            "The finite element value is one run on the scan's own sections, with mu_skin "
            f"{choice.mu_skin:g}: it has no interval of its own."
        )
    if told.unsolved:
        yield f"The finite element model has no answer for this leg: {told.unsolved}."
    yield (
        "No interval here holds the assumed constants of the fabric, or how far the finite "
        "element model is from a measured pressure: 9.7 % on the average in Chassagne et al. "
        "2018."
    )


def _about_rules(told: Prediction) -> Iterator[str]:
    found = told.rules()
    heights = [one.height for one in found.values()]
    if len(heights) > 1 and max(heights) - min(heights) > RADIUS:
        places = " and ".join(
            f"{one.value:.1f} mmHg {one.height:.0f} mm above the cut by the rule {name}"
            for name, one in found.items()
        )
        yield (
            f"The two rules for B1 differ by more than the sensor's radius on this leg: {places} "
            "(field of the reduced model, corrected). The answer is by the rule girth; mark B1 on "
            "the leg if the pressure there decides."
        )


def _about_points(told: Prediction) -> Iterator[str]:
    yield (
        "B, B1, C and D are read by a 50 mm sensor on the medial side, that at B with its lower "
        "rim at the narrowest girth. The runs wrap the leg up to the upper cut; pressures "
        f"further up than {told.scan.length - ONE_LAYER:.0f} mm are those of a bandage that goes "
        "on to the knee, carried up by the girth (Laplace's law of the tape measure)."
    )
    if not all(point.place.known for point in told.points):
        yield (
            "The scan does not show D, the narrow girth under the knee: it is taken at "
            f"{KNEE_HEIGHT:g} of the height and {KNEE_GIRTH:g} of the girth of the calf."
        )


def _beyond(outside: Mapping[str, tuple[float, float, float]]) -> str:
    return ", ".join(
        f"{name} {value:.4g} is outside of {low:.4g} .. {high:.4g}"
        for name, (value, low, high) in outside.items()
    )
