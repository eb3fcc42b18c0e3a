"""The interval of a pressure, part by part.

Parts are taken as independent: on each side the interval reaches as far as the root of
the sum of their squares.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .bandage_choice import BandageChoice
from .hand import MEASURED, OVERLAP, Hand
from .reduced import Reduced
from .shape_correction import shape_law

CONFIDENCE = 0.95
FRICTIONS = 41
"""Values of mu_skin that are tried between the ends of its range."""


@dataclass(frozen=True)
class Part:
    """What one source alone does to the pressure, mmHg: low <= 0 <= high."""

    name: str
    low: float
    high: float
    meaning: str


def parts_of(
    reduced: Reduced,
    inputs: dict[str, float],
    factor: float | None,
    choice: BandageChoice,
    widening: float = 1.0,
) -> tuple[Part, ...]:
    """Surrogate, shape of the leg, friction where it is unknown and varied, bandager's hand.

    factor    by which the shape law has corrected the reduced model's pressure; None if it has not
    widening  of the shape part, for a leg unlike those that it was found on
    """
    coded, scale = reduced.coded(inputs), 1.0 if factor is None else factor
    value = float(reduced.at_b1.predict(coded)[0])
    low, high = (float(end[0]) for end in reduced.at_b1.interval(coded, CONFIDENCE))
    found = [
        Part(
            "surrogate",
            scale * (low - value),
            scale * (high - value),
            f"what {reduced.count} runs leave open; 95 %",
        ),
        _shape(scale * value, factor is not None, widening),
    ]
    if choice.mu_range is not None and "mu_skin" in reduced.names:
        found.append(_friction(reduced, inputs, scale, value, choice.mu_range))
    if choice.hand is not None:
        found.append(_hand(scale * value, choice.hand, choice.stretch))
    return tuple(found)


def _hand(value: float, hand: Hand, stretch: float) -> Part:
    low, high = hand.interval(stretch, CONFIDENCE)
    return Part(
        "hand",
        low * value,
        high * value,
        f"the bandager's: stretch {stretch:g} +- {hand.stretch_sd:.3f} and overlap {OVERLAP:g} +- "
        f"{hand.overlap_sd:.3f} (SD), {MEASURED:.0%} of the pressure in many applications on one "
        "leg model (Wounds 2020;32:353); 95 %; give --known-hand to leave it out",
    )


def reach(name: str, value: float, others: Sequence[float], meaning: str) -> Part:
    """From the lowest to the highest of the values that it may be instead."""
    ends = [other - value for other in others]
    return Part(name, min(0.0, *ends), max(0.0, *ends), meaning)


def _shape(value: float, corrected: bool, widening: float) -> Part:
    law = shape_law()
    missed = min(widening * law.error(corrected, CONFIDENCE), 1.0)
    after = "after the correction by Laplace's law " if corrected else ""
    return Part(
        "leg shape",
        -missed * value,
        missed * value,
        f"what the shape modes miss of a leg {after}is {missed:.1%} of the pressure or "
        f"less on {len(law.missed)} validation legs, by finite elements; 95 %"
        + (f"; {widening:.1f} times that for a leg unlike them" if widening > 1 else ""),
    )


def _friction(
    reduced: Reduced,
    inputs: dict[str, float],
    scale: float,
    value: float,
    mu_range: tuple[float, float],
) -> Part:
    """From the lowest to the highest pressure over the range: all of it, not 95 %."""
    column = np.linspace(*mu_range, FRICTIONS)
    pressures = reduced.at_b1.predict(reduced.coded({**inputs, "mu_skin": column}))
    low, high = mu_range
    return Part(
        "friction",
        scale * min(float(pressures.min()) - value, 0.0),
        scale * max(float(pressures.max()) - value, 0.0),
        f"mu_skin anywhere between {low:g} and {high:g}; give --mu-skin to leave it out",
    )


def joined(value: float, parts: Sequence[Part]) -> tuple[float, float]:
    """Ends of the interval about a value."""
    down = np.sqrt(sum(part.low**2 for part in parts))
    up = np.sqrt(sum(part.high**2 for part in parts))
    return float(value - down), float(value + up)
