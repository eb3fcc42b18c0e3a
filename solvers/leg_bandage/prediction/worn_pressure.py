"""What a prediction says of the bandage as it is worn: standing, and lying after four hours.

Each is the pressure of the leg that lies times a ratio of the hoop (`worn.py`), with an interval
whose parts are told. What is not known of leg and fabric enters with its whole range in print.
"""

from __future__ import annotations

from dataclasses import dataclass

from ..bandage.relaxation import RELAXATIONS, Relaxation
from ..tissue.posture import POSTURES
from .interval import Part, joined, reach
from .worn import Hoop, missed

FOUR_HOURS = 240.0
SWELLING = (1.022, POSTURES["standing"].muscle)
"""Volume of a leg that has just stood up, and of one that has stood for hours, over lying (Berg,
Tedner, Tesch 1993)."""
FLUID = (0.0, 0.0275, 0.055)
"""Share of its volume that a leg loses by lying: none, half, all that was measured."""
FABRICS = Relaxation((0.0,), (1.0,)), RELAXATIONS["minimal_stretch"]
"""Between which an elastic bandage relaxes: its own series is assumed."""


@dataclass(frozen=True)
class WornPressure:
    """Pressure at B1, mmHg, 95 % interval and its parts; ratio is to that of the leg that lies."""

    name: str
    value: float
    low: float
    high: float
    ratio: float
    parts: tuple[Part, ...]


def worn_pressures(
    lying: tuple[float, float, float], hoop: Hoop | None
) -> tuple[WornPressure, ...]:
    """Standing, and after four hours lying; (value, low, high) is lying at first, None: no B1."""
    if hoop is None:
        return ()
    return _standing(lying, hoop), _after_four_hours(lying, hoop)


def _standing(lying: tuple[float, float, float], hoop: Hoop) -> WornPressure:
    ratio = hoop.standing()
    rise, _ = missed()
    swollen = reach(
        "swelling",
        ratio * lying[0],
        [hoop.standing(volume) * lying[0] for volume in SWELLING],
        f"tissue that grows on standing up, by {SWELLING[0] - 1:.1%} at once to "
        f"{SWELLING[1] - 1:.1%} in hours, whole range (Berg, Tedner, Tesch 1993)",
    )
    return _joined("standing", lying, ratio, (swollen, _hoop_part(rise * lying[0])))


def _after_four_hours(lying: tuple[float, float, float], hoop: Hoop) -> WornPressure:
    ratio = hoop.kept(FOUR_HOURS, FLUID[1])
    _, kept = missed()
    fabric = reach(
        "fabric",
        ratio * lying[0],
        [hoop.kept(FOUR_HOURS, FLUID[1], series) * lying[0] for series in FABRICS],
        "relaxation from none to that of a minimal-stretch bandage; an elastic one's is assumed",
    )
    fluid = reach(
        "fluid",
        ratio * lying[0],
        [hoop.kept(FOUR_HOURS, lost) * lying[0] for lost in (FLUID[0], FLUID[2])],
        f"a leg that loses {FLUID[0]:.0%} to {FLUID[2]:.1%} of its volume by lying, whole range "
        "(Berg, Tedner, Tesch 1993)",
    )
    return _joined("lying, after 4 h", lying, ratio, (fabric, fluid, _hoop_part(kept * lying[0])))


def _hoop_part(size: float) -> Part:
    return Part(
        "hoop",
        -size,
        size,
        "what the hoop missed at most on legs solved by finite elements (tools/worn_legs.py)",
    )


def _joined(
    name: str, lying: tuple[float, float, float], ratio: float, parts: tuple[Part, ...]
) -> WornPressure:
    first, low, high = lying
    before = Part(
        "lying",
        ratio * (low - first),
        ratio * (high - first),
        "the interval of the pressure lying, as laid",
    )
    value = ratio * first
    return WornPressure(name, value, *joined(value, (before, *parts)), ratio, (before, *parts))
