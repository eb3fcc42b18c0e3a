"""Friction of a bandage on skin that is dry or moist, as named ranges.

Cotton on the forearm, dry: 0.25 +- 0.05 sliding and 0.31 +- 0.07 at rest (mean and SD, Temel,
Johnson, Lloyd 2022, doi 10.1007/s11249-021-01560-5). Sweat raises the friction of textiles there
2 to 5 times where hair is sparse, 1 to 1.7 times where it is dense (Leibniz-INM, "Role of Hair
Coverage and Sweating for Textile Friction on the Forearm"). Both are forearms and no bandages;
Chassagne et al. 2018 take 0.1 to 0.3 without saying for which skin.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from surrogate.solver import Input

from .parameters import INPUTS


@dataclass(frozen=True)
class SkinFriction:
    """A range of friction coefficients, its nominal value, and where they come from."""

    low: float
    nominal: float
    high: float
    source: str


SKINS: Mapping[str, SkinFriction] = {
    "dry": SkinFriction(
        0.20,
        0.28,
        0.38,
        "measured, cotton on forearms: sliding less its SD to rest plus its SD; nominal: the mean "
        "of both (Temel et al. 2022)",
    ),
    "moist": SkinFriction(
        0.56,
        0.78,
        1.0,
        "dry times 2 and more, sparse hair (Leibniz-INM, forearms); 5 times would be 1.4: cut at 1",
    ),
    "moist_hairy": SkinFriction(
        0.28, 0.38, 0.48, "dry times 1 to 1.7, dense hair (Leibniz-INM, forearms)"
    ),
}


def mu_of(skin: str) -> Input:
    """The input mu_skin of a named skin."""
    one = SKINS[skin]
    source = f"{skin} skin, {one.low:g}..{one.high:g}: {one.source}"
    return replace(INPUTS["mu_skin"], nominal=one.nominal, source=source)
