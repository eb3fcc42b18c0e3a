"""Which bandage a person wears: a bandage, how far it is stretched, how it grips the skin."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from surrogate.errors import SurrogateError, nearest

from ..bandage.products import BANDAGES, STRETCH, bandage
from ..parameters import INPUTS
from ..skin_friction import SKINS
from .hand import PUBLISHED, Hand

MU_SKIN = 0.2
MU_RANGE = (0.1, 0.3)
"""Nominal friction of bandage on skin and its range where it is not known (Chassagne et al.
2018, Table II)."""


class BandageChoiceError(SurrogateError):
    """A bandage, stretch or friction that cannot be."""


@dataclass(frozen=True)
class BandageChoice:
    """A bandage as it is worn.

    bandage   its name; None when only its tension is known
    tension   N/mm, of the bandage per unit of its width, at the nominal stretch of 1.3
    stretch   as laid: length over rest length
    mu_skin   friction coefficient of bandage on skin
    mu_range  where mu_skin lies when nobody measured it; None: it is known
    hand      how stretch and overlap scatter about what was meant; None: they are as laid
    """

    bandage: str | None
    tension: float
    stretch: float
    mu_skin: float
    mu_range: tuple[float, float] | None
    hand: Hand | None = None

    @property
    def constant(self) -> float:
        """K1, N/mm: secant modulus at the nominal stretch (Chassagne et al. 2018, equation 10)."""
        return self.tension / (STRETCH - 1)

    @property
    def effective_tension(self) -> float:
        """N/mm at the stretch as laid: T = K1 (stretch - 1), equation 10."""
        return self.constant * (self.stretch - 1)


def choose_bandage(
    bandage: str | None = None,
    tension: float | None = None,
    stretch: float = STRETCH,
    mu_skin: float | None = None,
    hand: Hand | None = PUBLISHED,
    skin: str | None = None,
) -> BandageChoice:
    """A named bandage, or one of this tension at stretch 1.3; raises BandageChoiceError.

    mu_skin: None for unknown, 0.2 with a range of 0.1 to 0.3; skin: a named one in its place,
    as far as the range goes, above which a bandage holds. hand: scatter of stretch and
    overlap; None where both were measured on the bandage as laid.
    """
    if bandage is not None and tension is None:
        found = _tension_of(bandage)
    elif tension is not None and bandage is None:
        found = tension
    else:
        raise BandageChoiceError(
            "give either --bandage NAME or --tension N/MM, the bandage's tension per "
            f"width at stretch 1.3; bandages: {', '.join(sorted(BANDAGES))}"
        )
    _check("tension", found, "it is in N/mm, at stretch 1.3: 98 N/m are 0.098 N/mm")
    _check("stretch", stretch, "it is length over rest length: 30 % of extension are 1.3")
    if skin is not None:
        mu_skin, mu_range = _of_skin(skin, mu_skin)
    else:
        mu_range = MU_RANGE if mu_skin is None else None
    if mu_skin is not None:
        _check("mu_skin", mu_skin, "skin under a bandage has 0.1 to 0.3")
    return BandageChoice(
        bandage,
        float(found),
        float(stretch),
        MU_SKIN if mu_skin is None else mu_skin,
        mu_range,
        hand,
    )


def _of_skin(skin: str, mu_skin: float | None) -> tuple[float, tuple[float, float] | None]:
    """Friction of a named skin and its range, both no further than `MU_RANGE`."""
    if mu_skin is not None:
        raise BandageChoiceError(f"give either --mu-skin {mu_skin:g} or --skin {skin}")
    if skin not in SKINS:
        raise BandageChoiceError(f"skin {skin!r} is unknown; {nearest(skin, SKINS)}")
    one, most = SKINS[skin], MU_RANGE[1]
    low, high = min(one.low, most), min(one.high, most)
    return min(one.nominal, most), (low, high) if low < high else None


def _tension_of(name: str) -> float:
    """N/mm at stretch 1.3 of a named bandage."""
    if name not in BANDAGES:
        raise BandageChoiceError(
            f"bandage {name!r} is unknown; {nearest(name, BANDAGES)}; or give its "
            "tension at stretch 1.3 by --tension"
        )
    return float(bandage(name).fabric.tension(np.array(STRETCH)))


def _check(name: str, value: float, cure: str) -> None:
    low, high = INPUTS[name].range
    if not low <= value <= high:
        raise BandageChoiceError(f"{name}: {value:g} is not between {low:g} and {high:g}; {cure}")
