"""Named bandages, with where each number comes from.

Chassagne et al. 2018 give the tension at stretch 1.3 as a range, 0.059..0.137 N/mm, for the
two bandages of their measurements together; they take the other constants from an article
that prints none of them openly. Every value here is therefore marked `assumed`, with its
ground. Tension is either the secant's, T = K1 (stretch - 1), or follows a curve through the
same point at stretch 1.3. No published curve of these bandages was found, so that curve is
assumed too; `Fabric(curve=...)` takes a measured one.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from surrogate.errors import SolverError, nearest

from .fabric import Fabric

STRETCH = 1.3
Curve = tuple[tuple[float, float], ...]

NOMINAL = Fabric(
    K1=0.098 / 0.3, K2=0.3, nu12=0.2, G=0.05, F1=0.05, F2=0.05, tau12=0.02, thickness=0.7
)

CURVED: Curve = (
    (1.0, 0.0),
    (1.05, 0.27),
    (1.1, 0.49),
    (1.15, 0.65),
    (1.2, 0.78),
    (1.25, 0.89),
    (1.3, 1.0),
    (1.35, 1.10),
    (1.4, 1.20),
    (1.45, 1.30),
    (1.5, 1.40),
    (1.6, 1.62),
    (1.8, 2.16),
    (2.0, 2.90),
)
"""(stretch, tension over the tension at stretch 1.3) of a long-stretch bandage: assumed.

Its slope is 1.6 times the secant's at the start, 0.6 of it from 1.3 to 1.5, and rises from
there to 1.1 at 2.0: tension curves of elastic bandages have an inflexion (Textile Research
Journal 2019, doi 10.1177/0040517519833969, reads the pressure off there), the sizes are a
guess."""


def power_law(exponent: float) -> Curve:
    """Points of T / T(1.3) = ((stretch - 1) / 0.3)^exponent, at the stretches of `CURVED`.

    Exponent 1 is the secant; 0.64 goes through `CURVED` within 2 % from stretch 1.1 to 1.5.
    """
    return tuple((stretch, ((stretch - 1) / (STRETCH - 1)) ** exponent) for stretch, _ in CURVED)


LOCKING = 6.5
"""How fast the tension of an inelastic bandage grows with its strain: assumed.

With exp(6.5 e) a bandage of 0.098 N/mm at stretch 1.3 carries 1.5 N/mm at 1.7. Bandages are called
short-stretch when their extension ends below 100 % (Urgo; Lauma: by not more than 100 %)."""


def locking(rate: float = LOCKING) -> Curve:
    """Points of T / T(1.3) = (exp(rate e) - 1) / (exp(0.3 rate) - 1), e = stretch - 1, up to 1.8.

    Its slope at 1.3 is 2.3 times the secant's.
    """
    full = np.expm1(rate * (STRETCH - 1))
    steps = [1 + 0.05 * k for k in range(17)]
    return tuple((x, float(np.expm1(rate * (x - 1)) / full)) for x in steps)


_FABRICS = "size of Kawabata's figures for woven and knitted fabrics, not this bandage's"
ASSUMED: Mapping[str, str] = {
    "K2": "assumed: as stiff in the weft as in the warp, rounded",
    "nu12": "assumed",
    "G": f"assumed: 0.9 gf / (cm degree), {_FABRICS}",
    "F1": f"assumed: 0.5 gf cm^2 / cm, {_FABRICS}; its share of the pressure is F1 / r^3",
    "F2": "assumed: as F1",
    "tau12": "assumed: that of an isotropic sheet with the same bending, rounded",
    "thickness": "assumed",
    "curve": "assumed: a shape with an inflexion, as tension curves of elastic bandages have "
    "(doi 10.1177/0040517519833969); its sizes are a guess",
}


@dataclass(frozen=True)
class Bandage:
    """A bandage on the shelf.

    fabric   its constants, with the secant law
    sources  where each of them comes from
    width    mm
    curve    (stretch, tension over the tension at stretch 1.3) for the curved law
    curved   whether that law is the nominal one
    """

    fabric: Fabric
    sources: Mapping[str, str]
    width: float = 100.0
    curve: Curve = CURVED
    curved: bool = False


def at_tension(tension: float, fabric: Fabric = NOMINAL) -> Fabric:
    """The fabric with warp tension `tension` (N/mm) at stretch 1.3: K1 = tension / 0.3.

    Chassagne et al. 2018, equation 10. A tension curve is scaled to pass through that point.
    """
    if not tension > 0:
        raise SolverError(f"tension: {tension!r} N/mm must be above 0")
    if not fabric.curve:
        return replace(fabric, K1=tension / (STRETCH - 1))
    scale = tension / float(fabric.tension(np.array(STRETCH)))
    curve = tuple((stretch, scale * force) for stretch, force in fabric.curve)
    return replace(fabric, K1=tension / (STRETCH - 1), curve=curve)


def bandage(name: str) -> Bandage:
    """The bandage of that name; raises SolverError when there is none."""
    known = {**BANDAGES, **INELASTIC}
    if name not in known:
        raise SolverError(f"bandage: {nearest(name, known)}")
    return known[name]


def _within_range(tension: float, place: str) -> Bandage:
    ground = (
        f"assumed: {place} of the range 0.059..0.137 N/mm that Chassagne et al. 2018 "
        "print for the two bandages together"
    )
    return Bandage(at_tension(tension), {"K1": ground, **ASSUMED})


@dataclass(frozen=True)
class Pad:
    """Padding on the shelf: thickness without load (mm), P0 of van Wyk's law (kPa), and ground."""

    thickness: float
    stiffness: float
    source: str


PADS: Mapping[str, Pad] = {
    "wool": Pad(
        4.0,
        0.3,
        "assumed: two layers of a cotton or viscose wool, some 2 mm each without load, which "
        "30 mmHg press to two fifths",
    ),
}

BANDAGES: Mapping[str, Bandage] = {
    "biflex_16": _within_range(0.0785, "a quarter of the way through"),
    "biflex_17": _within_range(0.1175, "three quarters of the way through"),
}
"""Elastic bandages: what the shipped runs and predictions are about."""

INELASTIC: Mapping[str, Bandage] = {
    "short_stretch": Bandage(
        at_tension(0.137),
        {
            "K1": "assumed: the tension of the strongest elastic bandage at stretch 1.3",
            **ASSUMED,
            "curve": f"assumed: locks as exp({LOCKING} strain)",
        },
        curve=locking(),
        curved=True,
    )
}
"""Bandages of cotton that lock: for the solver, by `fabric`."""
