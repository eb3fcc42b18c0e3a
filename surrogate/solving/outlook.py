"""What the surrogates say of a candidate, their own errors and uncertain inputs included.

A value of the solver at a point is taken as prediction + standard deviation * error, the
error by the law that the surrogate's intervals have (`Fit.error_law`). Errors of several
outputs at one point are correlated as the left-out errors of the runs are (Gaussian copula).
Uncertain inputs follow the study's law. All candidates are judged by the same draws (common
random numbers), of a scrambled Sobol' sequence.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy import special
from scipy.stats import qmc

from surrogate.fitting.fit import Fit
from surrogate.space.space import Space

Array = NDArray[np.float64]
#: Predictions at once, so that memory stays bounded.
CHUNK = 2**18


@dataclass(frozen=True, eq=False)
class Outlook:
    """Draws of the outputs at candidates.

    fits       output -> fit, of single numbers
    uncertain  columns of the coded points that follow the study's law
    draws      how many, a power of two
    """

    space: Space
    fits: Mapping[str, Fit]
    uncertain: tuple[int, ...]
    draws: int
    seed: int

    @cached_property
    def _uniform(self) -> Array:
        """Numbers in (0, 1), (draws, parameters + outputs)."""
        size = self.space.size + len(self.fits)
        found = qmc.Sobol(size, scramble=True, seed=self.seed).random(self.draws)
        return np.clip(np.asarray(found), 1e-12, 1.0 - 1e-12)

    @cached_property
    def errors(self) -> dict[str, Array]:
        """Standardised errors of each output, (draws,)."""
        normal = special.ndtri(self._uniform[:, self.space.size :])
        normal = normal @ np.linalg.cholesky(correlation(list(self.fits.values()))).T
        u = np.clip(special.ndtr(normal), 1e-12, 1.0 - 1e-12)
        return {
            name: np.asarray(fit.error_law.ppf(u[:, k]), dtype=float)
            for k, (name, fit) in enumerate(self.fits.items())
        }

    @cached_property
    def inputs(self) -> Array:
        """Coded values of the uncertain inputs, (draws, number of them)."""
        coded = self.space.quantile(self._uniform[:, : self.space.size])
        return coded[:, list(self.uncertain)]

    def points(self, coded: Array) -> Array:
        """Coded points (m, draws or 1, d): each candidate (m, d) with each draw of the inputs."""
        if not self.uncertain:
            return coded[:, None, :]
        every = np.repeat(coded[:, None, :], self.draws, axis=1)
        every[:, :, list(self.uncertain)] = self.inputs
        return every

    def predicted(self, coded: Array) -> dict[str, tuple[Array, Array]]:
        """Mean and standard deviation of each output, (m, draws or 1) each."""
        every = self.points(coded)
        flat = every.reshape(-1, every.shape[-1])
        found = {}
        for name, fit in self.fits.items():
            mean, std = fit.predict(flat, return_std=True)
            found[name] = mean.reshape(every.shape[:2]), np.array(std).reshape(every.shape[:2])
        return found

    def outcomes(self, coded: Array) -> dict[str, Array]:
        """Draws of each output at each candidate, (m, draws)."""
        return {
            name: mean + std * self.errors[name]
            for name, (mean, std) in self.predicted(coded).items()
        }

    @property
    def at_once(self) -> int:
        """Candidates that are judged together."""
        return max(1, CHUNK // self.draws)


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
