"""The pressure along a leg: at B, B1, C and D with intervals, and as a curve with its range."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np

from ..geometry.cohort import DATA
from .bandage_choice import BandageChoice
from .interval import CONFIDENCE, Part, joined
from .points import POINTS, Place
from .reduced import Reduced
from .shape import Shape, pressures
from .shape_correction import size_not_passed

FRICTIONS = 5
GRADIENT = (40.0, 17.0)
"""mmHg at the ankle and at the knee that a bandage is meant to give (Smith & Nephew, Profore)."""


@dataclass(frozen=True)
class Point:
    """The pressure at one of B, B1, C and D.

    place             where it is
    value, low, high  mmHg, 95 % interval
    parts             what the interval is made of
    target            mmHg that the gradient asks there
    """

    name: str
    place: Place
    value: float
    low: float
    high: float
    parts: tuple[Part, ...]
    target: float


@dataclass(frozen=True)
class Curve:
    """Pressure along the leg.

    height                 (h,) mm above the ankle cut
    mean, lowest, highest  (h,) mmHg around the leg at each height
    """

    height: np.ndarray
    mean: np.ndarray
    lowest: np.ndarray
    highest: np.ndarray


def curve_of(pressure: np.ndarray, height: np.ndarray, length: float) -> Curve:
    """Of a pressure (theta, height over length) all over the skin, even angles."""
    return Curve(height * length, pressure.mean(axis=0), pressure.min(axis=0), pressure.max(axis=0))


def points_of(
    shape: Shape,
    reduced: Reduced,
    choice: BandageChoice,
    b1: tuple[float, tuple[Part, ...]],
    others: Sequence[Shape] = (),
    widening: float = 1.0,
    gradient: tuple[float, float] = GRADIENT,
) -> tuple[Point, ...]:
    """The points that the leg has; b1: value and parts at B1, where all is known already.

    others    shapes that the leg may have instead: front or side taken otherwise
    widening  of the part of the shape, for a leg unlike those that it was found on
    """
    base = pressures(shape, reduced, choice)
    found, where = [], shape.places()
    ends = where["B"].height, where["D"].height
    spread = {
        "friction": _range(base, _frictions(shape, reduced, choice)),
        "front and side": _range(base, (pressures(one, reduced, choice) for one in others)),
    }
    for name in (name for name in POINTS if name in base):
        place = where[name]
        target = float(np.interp(place.height, ends, gradient))
        if name == "B1":
            value, parts = b1
        else:
            value = base[name]
            parts = tuple(_parts(name, value, place, spread, choice, widening))
        found.append(Point(name, place, value, *joined(value, parts), parts, target))
    return tuple(found)


def _frictions(
    shape: Shape, reduced: Reduced, choice: BandageChoice
) -> Iterable[Mapping[str, float]]:
    if choice.mu_range is None or "mu_skin" not in reduced.names:
        return ()
    frictions = np.linspace(*choice.mu_range, FRICTIONS)
    return (pressures(shape, reduced, choice, float(mu)) for mu in frictions)


def _range(
    base: Mapping[str, float], others: Iterable[Mapping[str, float]]
) -> dict[str, tuple[float, float]]:
    """name -> how far below and above its value the others reach, mmHg."""
    seen = [{name: other.get(name, base[name]) - base[name] for name in base} for other in others]
    return {
        name: (min(0.0, *(one[name] for one in seen)), max(0.0, *(one[name] for one in seen)))
        if seen
        else (0.0, 0.0)
        for name in base
    }


def _parts(
    name: str,
    value: float,
    place: Place,
    spread: Mapping[str, Mapping[str, tuple[float, float]]],
    choice: BandageChoice,
    widening: float,
) -> Iterable[Part]:
    missed = widening * reading_error(name, place.carried != 1.0)
    yield Part(
        "reduced model and leg shape",
        -min(missed, 1.0) * value,
        missed * value,
        f"{missed:.0%} of the pressure or less on legs that shaped nothing, by finite elements",
    )
    for words, reach in spread.items():
        if reach[name] != (0.0, 0.0):
            yield Part(words, *reach[name], f"between its lowest and its highest {words}")
    if choice.hand is not None:
        low, high = choice.hand.interval(choice.stretch, CONFIDENCE)
        yield Part("hand", low * value, high * value, "as at B1")


@cache
def _errors() -> dict[str, np.ndarray]:
    """Sorted sizes of what is missed, as parts of the pressure (`tools/points.py`)."""
    stored = json.loads((DATA / "points.json").read_text(encoding="utf-8"))
    return {name: np.sort(np.abs(stored[name])) for name in ("B", "C", "carried_C", "carried_D")}


def reading_error(name: str, carried: bool, confidence: float = CONFIDENCE) -> float:
    """Part of the pressure at B, C or D that is missed; carried: up from under two layers.

    The two kinds of errors are independent.
    """
    read = size_not_passed(_errors()["B" if name == "B" else "C"], confidence)
    if not carried:
        return read
    return float(np.hypot(read, size_not_passed(_errors()[f"carried_{name}"], confidence)))
