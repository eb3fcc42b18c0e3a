"""How the tension of a fabric that is held stretched falls with time: Prony series.

    g(t) = 1 - sum_i g_i (1 - exp(-t / tau_i))

Quasi-linear viscoelasticity (Fung 1993, section 7.6): the tension is g convolved with the
rates of the elastic one, so that a stretch that is held relaxes by g whatever its size.

What is in print on bandages: knits of cotton or viscose lose more than 40 % of their pressure
on a rigid leg in eight hours, those with an elastomer core hold it better, without a number
(Kumar, Das, Alagirusamy 2013, doi 10.1177/0268355513481772); at 20 % extension most of the fall
comes in the first 15 minutes, then slowly until 12 hours (doi 10.1177/1534734620912093). No
constants are printed openly. Times are in minutes.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from surrogate.errors import SolverError

TIMES = (5.0, 60.0, 480.0)
"""Minutes: the first quarter of an hour, the first hours, half a day; assumed."""


@dataclass(frozen=True)
class Relaxation:
    """Shares g_i of the tension that are lost, each with its time tau_i in minutes.

    source  where they come from, `measured` or `assumed`
    """

    shares: tuple[float, ...]
    times: tuple[float, ...]
    source: str = ""

    def __post_init__(self) -> None:
        if len(self.shares) != len(self.times):
            raise SolverError(
                f"relaxation: {len(self.shares)} shares and {len(self.times)} times; give as many"
            )
        if min(self.shares) < 0 or not sum(self.shares) < 1 or not min(self.times) > 0:
            raise SolverError(
                f"relaxation: shares {self.shares} must not be negative and stay below 1 in sum, "
                f"times {self.times} must be above 0"
            )

    def at(self, minutes: ArrayLike) -> NDArray[np.float64]:
        """g at times, in minutes: the share of the tension that is left."""
        t = np.asarray(minutes, dtype=float)[..., None]
        fallen = -np.expm1(-t / np.array(self.times))
        return np.asarray(1 - fallen @ np.array(self.shares))


RELAXATIONS: Mapping[str, Relaxation] = {
    "elastic": Relaxation(
        (0.04, 0.04, 0.04),
        TIMES,
        "assumed: an elastomer core holds the pressure (Kumar et al. 2013 print no number); "
        "12 % in the end",
    ),
    "minimal_stretch": Relaxation(
        (0.145, 0.07, 0.06), TIMES, "assumed: half way between elastic and inelastic"
    ),
    "inelastic": Relaxation(
        (0.25, 0.10, 0.08),
        TIMES,
        "40 % in eight hours: measured, cotton and viscose knits on a rigid leg (Kumar et al. "
        "2013: more than 40 %); its split over the times: assumed, most of it in 15 minutes",
    ),
}
"""Kinds of bandage by what they are made of."""
