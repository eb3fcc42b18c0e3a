"""Laplace's law on a person's leg, and what it says of a leg that is told in a few modes."""

from __future__ import annotations

from functools import cache

import numpy as np

from solvers.laplace import laplace_pressure
from solvers.leg_bandage.basis import shipped_basis
from solvers.leg_bandage.cohort import load_cohort
from solvers.leg_bandage.landmarks import sensor
from solvers.leg_bandage.leg import Leg


def pressure_by_laplace(leg: Leg, tension: float) -> float:
    """mmHg under the 50 mm sensor at B1, two layers; raises SolverError for a leg without B1."""
    theta, z, weights = sensor(leg).points(leg)
    return float(weights @ laplace_pressure(tension, leg.curvature(theta, z)))


@cache
def missed_by_modes(modes: int = 4) -> np.ndarray:
    """(38,) sorted sizes of what the modes miss of the pressure at B1, as parts of it.

    On the validation legs, by Laplace's law: own sections against the leg that the modes
    make of them; each with its own B1.
    """
    basis, legs = shipped_basis(modes), load_cohort("val")
    alphas = basis.project(legs.snapshots().T)
    own = [pressure_by_laplace(Leg.from_sections(*leg), 1.0)
           for leg in zip(legs.length, legs.coefficients, legs.centre, strict=True)]
    told = [pressure_by_laplace(Leg.from_alphas(*leg, basis), 1.0)
            for leg in zip(legs.length, alphas, strict=True)]
    return np.sort(np.abs(np.array(own) / told - 1))


def shape_error(confidence: float = 0.95, modes: int = 4) -> float:
    """Half width of the part of an interval that the modes miss, as a part of the pressure.

    The ceil(confidence (k + 1))-th smallest of the k validation legs (Vovk 2015), whatever
    the law of the errors.
    """
    missed = missed_by_modes(modes)
    return float(missed[min(int(np.ceil(confidence * (len(missed) + 1))), len(missed)) - 1])
