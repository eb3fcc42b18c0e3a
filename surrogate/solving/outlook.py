"""What the surrogates say of a candidate, their own errors and uncertain inputs included.

A value of the solver at a point is taken as prediction + standard deviation * error, the
error by the law that the surrogate's intervals have (`Fit.error_law`). Errors of several
outputs at one point are correlated as the left-out errors of the runs are (Gaussian copula).
Uncertain inputs follow the study's law. All candidates are judged by the same draws (common
random numbers), of a scrambled Sobol' sequence.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import special
from scipy.stats import qmc

from surrogate.fitting.fit import Fit
from surrogate.space.space import Space

Array = NDArray[np.float64]
#: Draws at once, so that memory stays bounded.
CHUNK = 2**20
#: Uniform numbers keep this far from 0 and 1.
TINY = 1e-12


@dataclass(frozen=True, eq=False)
class Outlook:
    """Draws of the outputs at candidates.

    fits       output -> fit, of single numbers
    uncertain  columns of the coded points that follow the study's law
    inputs     draws of the uncertain inputs, a power of two; 1 without uncertain inputs
    errors     draws of the errors for each of these, a power of two
    exact      standard deviations at every point; otherwise, for a search, that at the medians
               of the uncertain inputs stands for all of their draws
    """

    space: Space
    fits: Mapping[str, Fit]
    uncertain: tuple[int, ...]
    inputs: int
    errors: int
    seed: int
    exact: bool = True

    @property
    def draws(self) -> int:
        """Draws in all."""
        return self.inputs * self.errors

    @property
    def at_once(self) -> int:
        """Candidates that are judged together."""
        return max(1, CHUNK // self.draws)

    @cached_property
    def _standardised(self) -> dict[str, Array]:
        """Errors of each output in its standard deviations, (inputs, errors)."""
        normal = special.ndtri(_uniform(len(self.fits), self.draws, self.seed))
        normal = normal @ np.linalg.cholesky(correlation(list(self.fits.values()))).T
        u = np.clip(special.ndtr(normal), TINY, 1.0 - TINY)
        return {
            name: np.asarray(fit.error_law.ppf(u[:, k])).reshape(self.inputs, self.errors)
            for k, (name, fit) in enumerate(self.fits.items())
        }

    @cached_property
    def _drawn(self) -> Array:
        """Coded values of the uncertain inputs, (inputs, number of them)."""
        coded = self.space.quantile(_uniform(self.space.size, self.inputs, self.seed + 1))
        return coded[:, list(self.uncertain)]

    @cached_property
    def _medians(self) -> Array:
        """The same at the medians of their laws, (1, number of them)."""
        half = np.full((1, self.space.size), 0.5)
        return self.space.quantile(half)[:, list(self.uncertain)]

    def points(self, coded: Array, draws: Array | None = None) -> Array:
        """Coded points (m, inputs, d): each candidate (m, d) with each draw of the inputs."""
        if not self.uncertain:
            return coded[:, None, :]
        draws = self._drawn if draws is None else draws
        every = np.repeat(coded[:, None, :], len(draws), axis=1)
        every[:, :, list(self.uncertain)] = draws
        return every

    def means(self, coded: Array) -> dict[str, Array]:
        """Prediction of each output at each candidate and draw of the inputs, (m, inputs)."""
        every = self.points(coded)
        return {name: _at(every, fit.predict) for name, fit in self.fits.items()}

    def for_errors(self, column: NDArray[Any]) -> NDArray[Any]:
        """Values (m, inputs) of an input beside the draws of the outputs, (m, draws)."""
        return np.repeat(column, self.errors, axis=1)

    def outcomes(self, coded: Array, means: Mapping[str, Array]) -> dict[str, Array]:
        """Draws of each output at each candidate, (m, draws), from its predictions."""
        every = self.points(coded, None if self.exact else self._medians)
        found = {}
        for name, fit in self.fits.items():
            std = _at(every, partial(_deviation, fit))
            drawn = means[name][:, :, None] + std[:, :, None] * self._standardised[name]
            found[name] = drawn.reshape(len(coded), -1)
        return found


def _deviation(fit: Fit, coded: Array) -> Array:
    return fit.predict(coded, return_std=True)[1]


def _at(every: Array, function: Callable[[Array], Array]) -> Array:
    """Values (m, draws) of a function of coded points, at points (m, draws, d)."""
    return np.asarray(function(every.reshape(-1, every.shape[-1]))).reshape(every.shape[:2])


def _uniform(size: int, count: int, seed: int) -> Array:
    """Numbers in (0, 1), (count, size), of a scrambled Sobol' sequence."""
    found = qmc.Sobol(size, scramble=True, seed=seed).random(count)
    return np.clip(np.asarray(found), TINY, 1.0 - TINY)


def correlation(fits: list[Fit]) -> Array:
    """Correlation of the left-out errors of several outputs at the same runs.

    Errors of outputs that were learnt from different runs are taken as independent.
    """
    matrix = np.eye(len(fits))
    for i, one in enumerate(fits):
        for j, other in enumerate(fits[:i]):
            if np.array_equal(one.coded, other.coded):
                a, b = one.values - one.left_out, other.values - other.left_out
                known = np.isfinite(a) & np.isfinite(b)
                spread = a[known].std() * b[known].std() if known.sum() > 2 else 0.0
                if spread > 0.0:
                    c = ((a - a[known].mean()) * (b - b[known].mean()))[known].mean() / spread
                    matrix[i, j] = matrix[j, i] = np.clip(c, -0.999, 0.999)
    smallest = np.linalg.eigvalsh(matrix)[0]
    if smallest < 1e-6:  # outputs that are functions of each other
        matrix = (matrix + (1e-6 - smallest) * np.eye(len(fits))) / (1.0 + 1e-6 - smallest)
    return matrix
