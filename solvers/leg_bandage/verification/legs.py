"""Legs on which a model may fail: corners of the shipped shapes, and the most conical ones."""

from __future__ import annotations

from itertools import product

import numpy as np

from ..geometry.basis import shipped_basis
from ..geometry.cohort import load_cohort
from ..geometry.landmarks import extreme_girths
from ..geometry.leg import Leg

SHAPES = ("leg_length", "alpha1", "alpha2", "alpha3", "alpha4")


def shape_ranges() -> dict[str, tuple[float, float]]:
    """Smallest and largest length (mm) and coordinates of the shipped training legs."""
    lengths, alphas = load_cohort().length, shipped_basis().ranges
    ends = [(lengths.min(), lengths.max()), *alphas]
    return {name: (float(low), float(high)) for name, (low, high) in zip(SHAPES, ends, strict=True)}


def shape_corners() -> list[dict[str, float]]:
    """The 32 corners of `shape_ranges`, as inputs."""
    ranges = shape_ranges()
    return [dict(zip(ranges, ends, strict=True)) for ends in product(*ranges.values())]


def leg_of(shape: dict[str, float]) -> Leg:
    """The leg of a length and four coordinates."""
    return Leg.from_alphas(shape["leg_length"], [shape[name] for name in SHAPES[1:]])


def validation_leg(index: int) -> Leg:
    """One of the 38 validation legs with sections of its own, from 0."""
    legs = load_cohort("val")
    return Leg.from_sections(legs.length[index], legs.coefficients[index], legs.centre[index])


def slope(leg: Leg) -> float:
    """Mean slope from ankle to calf: growth of girth / 2 pi over the height between them.

    A cone of half angle a has slope tan(a), the friction below which a bandage slides.
    """
    ankle, low, calf, high = extreme_girths(leg)
    return float((calf - ankle) / (2 * np.pi) / (high - low))


def most_conical(count: int) -> tuple[list[dict[str, float]], list[int]]:
    """The `count` corners of largest slope, and as many validation legs, steepest first."""
    corners = sorted(shape_corners(), key=lambda shape: -slope(leg_of(shape)))
    validation = sorted(range(len(load_cohort("val"))), key=lambda i: -slope(validation_leg(i)))
    return corners[:count], validation[:count]


EXTREMES = {
    "thin": lambda leg: -extreme_girths(leg)[0],
    "thick": lambda leg: extreme_girths(leg)[2],
    "conical": slope,
}
"""Of which the corner of largest value is meant: smallest ankle, widest calf, steepest."""


def named(name: str) -> dict[str, float]:
    """Inputs of `mean` (nominal: none) or of one of `EXTREMES`."""
    if name == "mean":
        return {}
    return max(shape_corners(), key=lambda shape: EXTREMES[name](leg_of(shape)))
