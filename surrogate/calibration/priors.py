"""Laws of all that is unknown, and the coordinates in which it is sampled.

Every unknown t has a prior with distribution function F and is sampled as z = Phi^-1(F(t)), which
is standard normal a priori and has no ends. Free inputs follow the study's law or one of their
own; correlations of the study between them are kept (Gaussian copula). The others are, for each
output, with s the standard deviation of the output over the runs,

    error of measurement, where it is estimated      half-normal with scale s / 2
    standard deviation of the discrepancy            half-normal with scale s / 2
    length of the discrepancy, in coded values       lognormal with median 1, ln sd 0.75
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import special

from surrogate.calibration import discrepancy
from surrogate.calibration.problem import Problem
from surrogate.fitting.fit import Fit

Array = NDArray[np.float64]

#: Scale of half-normal priors, as a share of the standard deviation of the output over the runs.
SHARE = 0.5
#: Median and standard deviation of the logarithm of the length's prior; coded inputs span 2.
LENGTH = (1.0, 0.75)
#: Probabilities keep this far from 0 and 1.
TINY = 1e-15


class Prior(Protocol):
    """A law by its quantiles."""

    def ppf(self, u: ArrayLike, /) -> Array: ...


@dataclass(frozen=True)
class HalfNormal:
    """|N(0, scale^2)|."""

    scale: float

    def ppf(self, u: ArrayLike, /) -> Array:
        """Value below which the probability is u."""
        return np.asarray(self.scale * np.sqrt(2.0) * special.erfinv(np.asarray(u, dtype=float)))

    def __str__(self) -> str:
        return f"half-normal(scale={self.scale:.4g})"


@dataclass(frozen=True)
class LogNormal:
    """exp N(ln median, spread^2)."""

    median: float
    spread: float

    def ppf(self, u: ArrayLike, /) -> Array:
        """Value below which the probability is u."""
        return np.asarray(
            self.median * np.exp(self.spread * special.ndtri(np.asarray(u, dtype=float)))
        )

    def __str__(self) -> str:
        return f"lognormal(median={self.median:g}, ln sd={self.spread:g})"


@dataclass(frozen=True)
class Unknown:
    """One number to be learnt; `about` says what it is."""

    name: str
    unit: str
    prior: Prior
    about: str


def error_name(output: str) -> str:
    """Name of the error of measurement of an output."""
    return f"{output}_error"


def discrepancy_name(output: str) -> str:
    """Name of the discrepancy's standard deviation."""
    return f"{output}_discrepancy"


def length_name(output: str) -> str:
    """Name of the discrepancy's length."""
    return f"{output}_length"


def unknowns(problem: Problem, fits: Mapping[str, Fit]) -> tuple[Unknown, ...]:
    """All unknowns: the free inputs first."""
    space = problem.space
    found = [
        Unknown(name, space[name].unit, problem.priors[name], space[name].description or name)
        for name in problem.free
    ]
    for one in problem.measured:
        half = HalfNormal(SHARE * float(fits[one.output].values.std()))
        if one.estimated:
            found.append(
                Unknown(error_name(one.output), one.unit, half, f"error of measuring {one.output}")
            )
        if problem.discrepancy:
            about = f"discrepancy of {one.output}: standard deviation"
            found.append(Unknown(discrepancy_name(one.output), one.unit, half, about))
            if discrepancy.varies(problem.known_coded[one.known]):
                about = f"discrepancy of {one.output}: length in coded inputs"
                found.append(Unknown(length_name(one.output), "", LogNormal(*LENGTH), about))
    return tuple(found)


@dataclass(frozen=True, eq=False)
class Coordinates:
    """From standard normal coordinates to values of the unknowns, and to points of the cases."""

    problem: Problem
    unknowns: Sequence[Unknown]

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the unknowns."""
        return tuple(one.name for one in self.unknowns)

    def values(self, z: Array) -> dict[str, Array]:
        """Values (w,) of each unknown at coordinates z (w, unknown)."""
        correlated = z.copy()
        free = len(self.problem.free)
        if self.problem.space.correlation is not None:
            index = [self.problem.space.names.index(name) for name in self.problem.free]
            part = np.asarray(self.problem.space.correlation)[np.ix_(index, index)]
            correlated[:, :free] = z[:, :free] @ np.linalg.cholesky(part).T
        u = np.clip(special.ndtr(correlated), TINY, 1.0 - TINY)
        return {one.name: np.asarray(one.prior.ppf(u[:, k])) for k, one in enumerate(self.unknowns)}

    def points(self, values: Mapping[str, Array]) -> Array:
        """Coded points (w, case, parameter) of the cases with the free inputs at `values`."""
        space, problem = self.problem.space, self.problem
        walkers = len(values[problem.free[0]])
        found = np.repeat(problem.coded[None], walkers, axis=0)
        for name in problem.free:
            coded = np.asarray(space[name].encode(values[name]))
            found[:, :, space.names.index(name)] = coded[:, None]
        return found

    def allowed(self, points: Array) -> NDArray[np.bool_]:
        """(w,) where all cases keep the constraints of the study; the prior is 0 elsewhere."""
        region = self.problem.space.region
        if region is None:
            return np.ones(len(points), dtype=bool)
        inside = np.asarray(region.holds(points.reshape(-1, points.shape[2])))
        return np.asarray(inside.reshape(points.shape[:2]).all(axis=1))
