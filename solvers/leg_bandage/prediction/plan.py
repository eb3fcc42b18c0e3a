"""How to wrap for a pressure: stretch and overlap that hit a target at B1, and how surely.

A pressure is that of the reduced model at the tension of the stretch, times 0.5 / (1 - overlap):
the layers (finite elements say the power 1.02 on 95 runs). What is not known is drawn together:
friction between its ends, the bandager's hand, and what reduced model and shape modes miss of
the leg. The probability is the share of draws that lie in the class.

For each overlap the stretch is that whose median pressure is the target; the overlap that
keeps the most draws in the class wins.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq
from scipy.special import ndtri

from .along import GRADIENT
from .bandage_choice import BandageChoice, BandageChoiceError
from .compression_class import RAL, nearest_class
from .hand import OVERLAP, uniforms
from .pressure import Prediction
from .reduced import Reduced
from .shape import Shape
from .shape_correction import shape_law

STRETCHES = (1.1, 1.6)
OVERLAPS = (0.5, 0.67)
"""Within which a plan is looked for: from slack to the largest that the solver takes, and from two
layers to three, the spirals of Chassagne et al. 2016 (doi 10.1007/s10439-015-1352-1)."""
FIRST_END, LAST_END = -10.0, 50.0
"""mm: height of the midline at the first end, and how far under the upper cut it ends."""
GRID = 101
FRICTIONS = 9


@dataclass(frozen=True)
class Wrapping:
    """A stretch and an overlap, and the pressure at B1 that they give.

    median, low, high  mmHg; low and high hold 95 % of the draws
    probability        share of the draws inside the class
    """

    stretch: float
    overlap: float
    median: float
    low: float
    high: float
    probability: float

    @property
    def layers(self) -> float:
        """Layers of bandage, mean."""
        return 1 / (1 - self.overlap)


@dataclass(frozen=True)
class LocalStretch:
    """Which stretch a bandager lays at a point who changes it along the leg.

    target  mmHg around the leg that the gradient asks there; even: what one stretch gives
    """

    point: str
    height: float
    target: float
    even: float
    stretch: float


@dataclass(frozen=True)
class Plan:
    """What to lay for a target at B1.

    within      mmHg, ends of the class (or as asked)
    standard    of the class; empty when the ends were asked
    class_name  of the class
    best        the surest wrapping; others: of every overlap that reaches the target
    along       stretch that follows the gradient, at the points
    extrapolates  whether its tension is beyond the stored runs
    """

    target: float
    within: tuple[float, float]
    standard: str
    class_name: str
    best: Wrapping
    others: tuple[Wrapping, ...]
    along: tuple[LocalStretch, ...]
    extrapolates: bool

    def holds(self, pressure: float) -> bool:
        """Whether a pressure, mmHg, is within the ends."""
        return bool(_inside(np.asarray(pressure), self.within))


def _inside(pressure: np.ndarray, ends: tuple[float, float]) -> np.ndarray:
    """Whether pressures, in whole mmHg as standards print them, are within both ends."""
    return np.asarray((pressure >= ends[0] - 0.5) & (pressure < ends[1] + 0.5))


def plan_wrapping(
    told: Prediction,
    target: float,
    *,
    standard: str = RAL,
    within: tuple[float, float] | None = None,
    overlap: float | None = None,
    gradient: tuple[float, float] = GRADIENT,
) -> Plan:
    """The plan for the leg and bandage of a prediction; raises BandageChoiceError.

    within   mmHg: ends in place of those of the class of a standard that the target is in
    overlap  the one to lay; default: the surest between half and two thirds
    """
    check_plan(target, within, overlap)
    asked = nearest_class(target, standard)
    ends = within or (asked.low, asked.high)
    if all(point.name != "B1" for point in told.points):
        raise BandageChoiceError(
            "the leg has no point B1 to plan a pressure at; scan up to the calf"
        )
    draws = _Draws.of(told)
    overlaps = np.arange(50, 68) / 100 if overlap is None else np.array([overlap])
    found = tuple(_hitting(draws, target, ends, float(one)) for one in overlaps)
    hit = tuple(one for one in found if one is not None)
    if not hit:
        reach = [draws.pressures(*pair) for pair in zip(STRETCHES, overlaps[[0, -1]], strict=True)]
        low, high = (float(np.median(one)) for one in reach)
        raise BandageChoiceError(
            f"target: {target:g} mmHg at B1 is out of reach on this leg: the bandage gives "
            f"{low:.0f} mmHg at stretch {STRETCHES[0]:g} to {high:.0f} at {STRETCHES[1]:g}; take a "
            f"{'stronger' if target > high else 'weaker'} bandage or another target"
        )
    best = max(hit, key=lambda one: round(one.probability, 3))
    return Plan(
        target,
        ends,
        "" if within else standard,
        "" if within else asked.name,
        best,
        hit,
        tuple(_along(told, best, target, gradient)),
        draws.beyond(best.stretch),
    )


def check_plan(target: float, within: tuple[float, float] | None, overlap: float | None) -> None:
    """Raise BandageChoiceError for what no leg can have."""
    if not 5 <= target <= 100:
        raise BandageChoiceError(f"target: {target:g} mmHg is not between 5 and 100")
    if within is not None and not 0 <= within[0] < within[1]:
        raise BandageChoiceError(
            f"within: {within[0]:g} to {within[1]:g} mmHg is no range; "
            "give the lower pressure first"
        )
    if overlap is not None and not 0.2 <= overlap <= 0.75:
        raise BandageChoiceError(
            f"overlap: {overlap:g} is not between 0.2 and 0.75; it is the share of the width that "
            "lies on the turn before: half is 0.5"
        )


@dataclass(frozen=True)
class _Draws:
    """What is not known, drawn once and used for every wrapping.

    value     (stretch, friction) mmHg at B1 with half overlap, on `stretches` and `frictions`
    friction  (n,) coefficients
    missed    (n,) factors: what reduced model and shape modes miss
    hand      (n, 2) standard normal numbers
    """

    choice: BandageChoice
    stretches: np.ndarray
    frictions: np.ndarray
    value: np.ndarray
    friction: np.ndarray
    missed: np.ndarray
    hand: np.ndarray
    largest: float

    @classmethod
    def of(cls, told: Prediction) -> _Draws:
        free = uniforms(5)
        choice = told.choice
        ends = choice.mu_range or (choice.mu_skin, choice.mu_skin)
        frictions = np.linspace(*ends, FRICTIONS) if choice.mu_range else np.array(ends[:1])
        stretches = np.linspace(*STRETCHES, GRID)
        tension = choice.constant * (stretches - 1)
        ends_of_tension = _tensions(told.reduced)
        value = _at_tensions(told, tension, frictions, ends_of_tension)
        return cls(
            choice,
            stretches,
            frictions,
            value,
            ends[0] + (ends[1] - ends[0]) * free[:, 0],
            _missed(told, free[:, 1], free[:, 2]),
            ndtri(free[:, 3:5]),
            1 + ends_of_tension[1] / choice.constant,
        )

    def pressures(self, stretch: float, overlap: float) -> np.ndarray:
        """(n,) mmHg at B1."""
        line = np.array([np.interp(stretch, self.stretches, column) for column in self.value.T])
        value = np.interp(self.friction, self.frictions, line) * (1 - OVERLAP) / (1 - overlap)
        hand = self.choice.hand
        laid = 1.0 if hand is None else hand.spread(self.hand, stretch, overlap)
        return np.asarray(value * self.missed * laid)

    def beyond(self, stretch: float) -> bool:
        """Whether the tension at a stretch is above all stored runs."""
        return stretch > self.largest + 1e-9


def _tensions(reduced: Reduced) -> tuple[float, float]:
    """Lowest and highest of the stored runs, N/mm; raises BandageChoiceError for only one."""
    if "tension" not in reduced.names:
        raise BandageChoiceError(
            f"{reduced.path}: a plan needs a stored study that varies tension; this one varies "
            f"{', '.join(reduced.names)}"
        )
    low, high = reduced.study.space["tension"].distribution.support
    return float(low), float(high)


def _at_tensions(
    told: Prediction, tension: np.ndarray, frictions: np.ndarray, ends: tuple[float, float]
) -> np.ndarray:
    """(tension, friction) mmHg at B1; beyond the runs in proportion to the tension."""
    reduced, factor = told.reduced, 1.0 if told.factor is None else told.factor
    inside = np.clip(tension, *ends)
    grid, mu = np.meshgrid(inside, frictions, indexing="ij")
    columns = {**told.inputs, "tension": grid.ravel()}
    if "mu_skin" in reduced.names:
        columns["mu_skin"] = mu.ravel()
    value = reduced.at_b1.predict(reduced.coded(columns)).reshape(grid.shape)
    return np.asarray(factor * value * (tension / inside)[:, None])


def _missed(told: Prediction, shape: np.ndarray, surrogate: np.ndarray) -> np.ndarray:
    """Factors (n,): what validation legs were missed by, either way, and the surrogate's error."""
    law = shape_law()
    sizes = law.missed if told.factor is None else law.corrected
    away = np.quantile(sizes, np.abs(2 * shape - 1)) * np.sign(shape - 0.5) * told.scan.widening
    part = next(part for part in told.parts if part.name == "surrogate")
    spread = (part.high - part.low) / 2 / 1.96 / told.value
    return np.asarray((1 + away) * (1 + spread * ndtri(surrogate)))


def _hitting(
    draws: _Draws, target: float, ends: tuple[float, float], overlap: float
) -> Wrapping | None:
    """The stretch whose median is the target; None out of reach."""

    def missed(stretch: float) -> float:
        return float(np.median(draws.pressures(stretch, overlap))) - target

    if not missed(STRETCHES[0]) <= 0 <= missed(STRETCHES[1]):
        return None
    stretch = float(brentq(missed, *STRETCHES))
    pressed = draws.pressures(stretch, overlap)
    median, *both = (float(end) for end in np.quantile(pressed, [0.5, 0.025, 0.975]))
    return Wrapping(stretch, overlap, median, *both, float(_inside(pressed, ends).mean()))


def _along(
    told: Prediction, best: Wrapping, target: float, gradient: tuple[float, float]
) -> Iterator[LocalStretch]:
    """Stretch that makes the pressure around each point that of the gradient, `target` at B1.

    The tension, K1 (stretch - 1), goes with target times girth: Laplace's law of the tape measure.
    """
    places = Shape.of(told.scan).places()
    b1, ends = places["B1"], (places["B"].height, places["D"].height)
    asked = {name: float(np.interp(place.height, ends, gradient)) for name, place in places.items()}
    for name, place in places.items():
        wanted = target * asked[name] / asked["B1"]
        even = target * b1.girth / place.girth
        stretch = 1 + (best.stretch - 1) * wanted / even
        yield LocalStretch(name, place.height, wanted, even, stretch)


def stretch_of_ends(plan: Plan, length: float) -> tuple[float, float]:
    """Stretch at the first and at the free end, straight in the height through B1 and C."""
    b1, c = (next(one for one in plan.along if one.point == name) for name in ("B1", "C"))
    slope = (c.stretch - b1.stretch) / (c.height - b1.height)
    first, last = FIRST_END - b1.height, length - LAST_END - b1.height
    return b1.stretch + slope * first, b1.stretch + slope * last
