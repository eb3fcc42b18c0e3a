"""Compression classes: what a pressure at the ankle is called.

The classes are those of stockings, by the pressure at the ankle, B. RAL-GZ 387 (Germany) and
BS 7505 (United Kingdom, with the limits of specification 40 of the Drug Tariff) overlap and
leave gaps: a pressure may be in no class.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class CompressionClass:
    """A class of a standard and its pressures, mmHg, both ends included."""

    standard: str
    name: str
    low: float
    high: float

    def holds(self, pressure: float) -> bool:
        """Whether the pressure, in whole mmHg as the standards print it, is in the class."""
        return self.low <= np.round(pressure) <= self.high

    def __str__(self) -> str:
        ends = f"{self.low:g} to {self.high:g}" if np.isfinite(self.high) else f"from {self.low:g}"
        return f"{self.standard} class {self.name} ({ends} mmHg)"


def _classes(standard: str, **ends: tuple[float, float]) -> tuple[CompressionClass, ...]:
    return tuple(CompressionClass(standard, name, *pair) for name, pair in ends.items())


RAL, BS = "RAL-GZ 387", "BS 7505"
STANDARDS: Mapping[str, tuple[CompressionClass, ...]] = {
    RAL: _classes(RAL, I=(18, 21), II=(23, 32), III=(34, 46), IV=(49, np.inf)),
    BS: _classes(BS, **{"1": (14, 17), "2": (18, 24), "3": (25, 35)}),
}


def class_of(pressure: float, standard: str) -> CompressionClass | None:
    """The class of a standard that holds a pressure, mmHg; None between and beyond classes."""
    return next((one for one in STANDARDS[standard] if one.holds(pressure)), None)


def class_words(pressure: float, standard: str) -> str:
    """`II`, `between I and II`, `below I` or `above 3`."""
    found = class_of(pressure, standard)
    if found is not None:
        return found.name
    below = [one.name for one in STANDARDS[standard] if one.high < np.round(pressure)]
    above = [one.name for one in STANDARDS[standard] if one.low > np.round(pressure)]
    if below and above:
        return f"between {below[-1]} and {above[0]}"
    return f"above {below[-1]}" if below else f"below {above[0]}"


def nearest_class(pressure: float, standard: str) -> CompressionClass:
    """The class that holds a pressure, else the one whose end is nearest."""
    return min(
        STANDARDS[standard],
        key=lambda one: max(one.low - pressure, pressure - one.high, 0.0),
    )
