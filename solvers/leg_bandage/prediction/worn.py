"""The pressure standing and after four hours, from that of a leg that lies: a hoop on a tube.

A leg that changes its volume, J times that of its tissue, changes its girth: with the bones
pinned and tissue that keeps its volume, a section of area A with a share a of bone has ::

    girth' / girth = sqrt(1 + (J - 1)(1 - a))            (closed form, README.md, V15)

The bandage follows the girth, T = K1 (stretch - 1), P = n T / r, and relaxes by g(t). So the ratio
of pressures hangs on the stretch as laid and on the share of bone only. What the hoop misses, on
legs on which finite elements were solved (`tools/worn_legs.py`), is a part of the interval.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cache

import numpy as np

from ..bandage.relaxation import RELAXATIONS, Relaxation
from ..equilibrium.afterwards import FLUID_MINUTES
from ..geometry.bone import bone_envelope
from ..geometry.cohort import DATA
from ..geometry.leg import Leg
from ..tissue.posture import POSTURES

LEFT = 0.988
"""Stretch on the leg over that laid, finite elements on the mean leg: 1.285 of 1.3."""
HALF_MUSCLE = 0.5
"""Share of the tissue that is muscle of the back of the leg."""


@dataclass(frozen=True)
class Hoop:
    """A band at one height of a leg.

    stretch  of the band on the leg
    bone     share of the section that is bone
    height   mm above the ankle cut
    """

    stretch: float
    bone: float
    height: float = 0.0

    def pressure(self, volume: float) -> float:
        """P' / P when the tissue has `volume` times its volume."""
        girth = np.sqrt(1 + (volume - 1) * (1 - self.bone))
        return float((self.stretch * girth - 1) / (self.stretch - 1) / girth)

    def standing(self, volume: float | None = None) -> float:
        """Standing over lying; None: by the volume of `tissue.posture`."""
        up = POSTURES["standing"]
        swollen = HALF_MUSCLE * up.muscle + (1 - HALF_MUSCLE) * up.elsewhere
        return self.pressure(swollen if volume is None else volume)

    def kept(
        self, minutes: float, fluid_loss: float, series: Relaxation = RELAXATIONS["elastic"]
    ) -> float:
        """Pressure left, lying: relaxation at a held stretch, times what the lost fluid leaves."""
        left = 1 + fluid_loss * np.expm1(-minutes / FLUID_MINUTES)
        return float(series.at(minutes)) * self.pressure(float(left))


def hoop_on(leg: Leg, z: float, stretch: float) -> Hoop:
    """The band at a height z (mm) of a leg, laid at a stretch."""
    skin, bone = (_area(one, z) for one in (leg, bone_envelope(leg)))
    return Hoop(1 + (stretch - 1) * (1.3 * LEFT - 1) / 0.3, bone / skin, z)


def _area(leg: Leg, z: float) -> float:
    """mm2, of the section at z."""
    theta = np.linspace(0, 2 * np.pi, 360, endpoint=False)
    x, y, _ = leg.surface(theta, np.full(theta.shape, z)).T
    return float(abs(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y)) / 2)


@cache
def missed() -> tuple[float, float]:
    """Largest error of the hoop over the legs of `data/worn.json`: of the rise, of what is kept."""
    cases = json.loads((DATA / "worn.json").read_text())["cases"]
    rise = max(abs(one["standing"] - one["hoop_standing"]) for one in cases)
    kept = max(abs(one["kept_4h"] - one["hoop_kept_4h"]) for one in cases)
    return float(rise), float(kept)
