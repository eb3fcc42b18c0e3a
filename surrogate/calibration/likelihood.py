"""How likely the measurements are, given the unknowns.

Measurements y (n,) of an output at one value of the unknowns are normal,

    y ~ N(m, C + K + E),

with the surrogate's mean m and covariance C of its errors at the cases (`emulator`), the
discrepancy's K (`discrepancy`), and E the variances of measurement. Outputs are independent given
the unknowns, so that the errors of their surrogates are too.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from surrogate.calibration import discrepancy
from surrogate.calibration.emulator import Emulator
from surrogate.calibration.priors import (
    Coordinates,
    discrepancy_name,
    error_name,
    length_name,
)
from surrogate.calibration.problem import Measured, Problem
from surrogate.fitting.fit import Fit

Array = NDArray[np.float64]

LOG_2PI = float(np.log(2.0 * np.pi))
#: Added to variances, as a share of their mean, so that rounding leaves them positive definite.
JITTER = 1e-10


@dataclass(frozen=True, eq=False)
class Normal:
    """The law of the measurements of one output, for w values of the unknowns.

    rows      (k,) cases that were measured;  mean (w, k)
    emulator  (w, k, k) covariance of the surrogate's errors
    bias      (w, k, k) of the discrepancy;  noise (w, k) variances of measurement
    """

    measured: Measured
    rows: NDArray[np.intp]
    mean: Array
    emulator: Array
    bias: Array
    noise: Array

    @property
    def residual(self) -> Array:
        """Measured - mean, (w, k)."""
        return self.measured.values[self.rows] - self.mean

    @cached_property
    def covariance(self) -> Array:
        """Of the measurements, (w, k, k)."""
        found = self.emulator + self.bias
        diagonal = np.einsum("wii->wi", found)
        diagonal += self.noise
        diagonal += JITTER * diagonal.mean(axis=1, keepdims=True)
        return found

    @cached_property
    def log_density(self) -> Array:
        """(w,) of the measurements; -inf where the covariance is not positive definite."""
        return _log_density(self.covariance, self.residual)


def _log_density(covariance: Array, residual: Array) -> Array:
    """(w,) of normal laws with covariances (w, k, k) at residuals (w, k)."""
    try:
        factor = np.linalg.cholesky(covariance)
    except np.linalg.LinAlgError:  # it does not say of which: one by one
        if len(covariance) == 1:
            return np.array([-np.inf])
        alone = np.arange(len(covariance))[:, None]
        return np.concatenate([_log_density(covariance[w], residual[w]) for w in alone])
    white = np.linalg.solve(factor, residual[:, :, None])[:, :, 0]
    logs = np.log(np.einsum("wii->wi", factor)).sum(axis=1)
    return np.asarray(-0.5 * (white**2).sum(axis=1) - logs - 0.5 * residual.shape[1] * LOG_2PI)


@dataclass(frozen=True, eq=False)
class Likelihood:
    """The likelihood of a problem, by fits (output -> fit)."""

    problem: Problem
    fits: Mapping[str, Fit]
    coordinates: Coordinates

    def log_prior(self, z: Array) -> Array:
        """(w,) at coordinates z (w, unknown); -inf where a constraint is broken."""
        found = -0.5 * (z**2).sum(axis=1)
        if self.problem.space.region is None:
            return np.asarray(found)
        kept = self.coordinates.allowed(self.coordinates.points(self.coordinates.values(z)))
        return np.where(kept, found, -np.inf)

    def log_likelihood(self, z: Array) -> Array:
        """(w,) of all measurements, for all values of the unknowns at once."""
        total = np.zeros(len(z))
        for law in self.laws(z):
            total += law.log_density
        return np.where(np.isfinite(total), total, -np.inf)

    def laws(self, z: Array) -> Iterator[Normal]:
        """The law of the measurements of each output."""
        values = self.coordinates.values(z)
        points = self.coordinates.points(values)
        for one in self.problem.measured:
            yield self._law(one, values, points)

    def _law(self, one: Measured, values: Mapping[str, Array], points: Array) -> Normal:
        rows = np.flatnonzero(one.known)
        mean, emulator = self._emulators[one.output].predicted(points[:, rows])
        if not self.problem.emulator_error:
            emulator = np.zeros_like(emulator)
        given = one.errors[rows] ** 2
        noise = np.repeat(given[None], len(points), axis=0)
        if one.estimated:
            unknown = np.isnan(given)
            noise[:, unknown] = values[error_name(one.output)][:, None] ** 2
        bias = np.zeros_like(emulator)
        if self.problem.discrepancy:
            bias = discrepancy.covariance(
                self._distances[one.output],
                values[discrepancy_name(one.output)],
                values.get(length_name(one.output)),
            )
        return Normal(one, rows, mean, emulator, bias, noise)

    @cached_property
    def _emulators(self) -> dict[str, Emulator]:
        return {name: Emulator(fit) for name, fit in self.fits.items()}

    @cached_property
    def _distances(self) -> dict[str, Array]:
        """Distances between the known inputs of the measurements of each output."""
        known = [self.problem.space[name] for name in self.problem.known]
        coded = self.problem.known_coded
        return {
            one.output: discrepancy.distances(coded[one.known], known)
            for one in self.problem.measured
        }
