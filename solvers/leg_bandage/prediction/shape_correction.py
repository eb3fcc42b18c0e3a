"""What a leg loses when it is told in four shape modes, and what Laplace's law gives back.

The reduced model sees a leg in four modes, which miss a millimetre or two of its skin and
with it the curvature at B1. Laplace's law sees that curvature, on the scan's own sections
and on the leg of the modes. On validation legs, solved by finite elements both ways
(`data/four_modes.json`, written by `tools/four_modes.py`),

    log(P_own / P_modes) = b log(Laplace_own / Laplace_modes) + e

so a pressure of the reduced model is multiplied by (Laplace_own / Laplace_modes)^b, and
what is left, e, is a part of its interval. It is a multifidelity correction: the size from the
expensive model, the difference between two legs from the cheap one.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache

import numpy as np

from surrogate.errors import SolverError

from ...laplace import laplace_b1, laplace_tape
from ..geometry.basis import shipped_basis
from ..geometry.cohort import DATA, load_cohort
from ..geometry.landmarks import b1_height
from ..geometry.leg import Leg


@dataclass(frozen=True)
class ShapeLaw:
    """The law above, fitted.

    exponent   b
    corrected  (k,) sorted sizes of what is left of the pressure, as parts of it
    missed     (k,) the same without a correction
    """

    exponent: float
    corrected: np.ndarray
    missed: np.ndarray

    def factor(self, laplace: Mapping[str, float | None]) -> float | None:
        """By what a pressure on the leg of the modes becomes one on the scan's own sections.

        laplace: of the `scanned` and the `fitted` leg; None when one has no B1.
        """
        if laplace["scanned"] is None or laplace["fitted"] is None:
            return None
        return (laplace["scanned"] / laplace["fitted"]) ** self.exponent

    def error(self, corrected: bool = True, confidence: float = 0.95) -> float:
        """Half width of what is left, as a part of the pressure (`size_not_passed`)."""
        return size_not_passed(self.corrected if corrected else self.missed, confidence)


def size_not_passed(sizes: np.ndarray, confidence: float) -> float:
    """Of k sorted sizes the ceil(confidence (k + 1))-th (Vovk 2015), whatever their law."""
    return float(sizes[min(int(np.ceil(confidence * (len(sizes) + 1))), len(sizes)) - 1])


@cache
def shape_law() -> ShapeLaw:
    """The law on the validation legs that were solved; each leg is left out of its own b."""
    with (DATA / "four_modes.json").open(encoding="utf-8") as stream:
        solved = json.load(stream)
    ratio = np.log(np.array(solved["own"]) / solved["modes"])
    told = np.log(
        [by_laplace(own) / by_laplace(modes) for own, modes in map(both_ways, solved["leg"])]
    )
    without = ((ratio * told).sum() - ratio * told) / ((told**2).sum() - told**2)
    return ShapeLaw(
        float(ratio @ told / (told @ told)),
        np.sort(np.abs(np.expm1(ratio - without * told))),
        np.sort(np.abs(np.expm1(ratio))),
    )


def both_ways(number: int) -> tuple[Leg, Leg]:
    """A validation leg on its own sections, and as the leg that the modes make of it."""
    legs = load_cohort("val")
    length = legs.length[number]
    alphas = shipped_basis().project(legs.snapshots()[:, number])
    return (
        Leg.from_sections(length, legs.coefficients[number], legs.centre[number]),
        Leg.from_alphas(length, alphas),
    )


def by_laplace(leg: Leg, tension: float = 1.0) -> float:
    """mmHg under the 50 mm sensor at B1, two layers; raises SolverError for a leg without B1."""
    return laplace_b1(leg, tension)[0]


def by_laplace_if_it_can(leg: Leg, tension: float) -> float | None:
    """The same; None for a leg without B1, or hollow all under the sensor."""
    try:
        return by_laplace(leg, tension)
    except SolverError:
        return None


def by_tape(leg: Leg, tension: float) -> float | None:
    """mmHg by Laplace's law on the girth at B1, two layers; None for a leg without B1."""
    try:
        return laplace_tape(float(leg.girth(b1_height(leg))), tension)
    except SolverError:
        return None
