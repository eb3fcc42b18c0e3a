"""Many runs: a Gaussian process given a core of the runs, and the runs nearest to each point.

With R the correlations of the core's runs, r those of a point with them, h = f - F' R^-1 r, the
process given the core has mean r' w + f' b and covariance

    c(x, y) = k(x, y) - r(x)' R^-1 r(y) + h(x)' (F' R^-1 F)^-1 h(y),

and a point is predicted by kriging of what the core misses at the m runs N nearest to it,

    mean(x) + c(x, N) (c(N, N) + nugget I)^-1 (y_N - mean(N)).

The core holds what reaches far, the neighbours what is near: a full-scale approximation (Sang
and Huang 2012, doi 10.1111/j.1467-9868.2011.01007.x) with neighbours by distance in lengths
(Katzfuss, Guinness, Lawrence 2022, scaled Vecchia, doi 10.1137/20M1352156). It is exact when the
core and the neighbours are all runs. Work: n core^2 once, core^2 + m^2 core for each point.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import linalg
from scipy.spatial import cKDTree

from surrogate.regressors.matern import correlation, paired
from surrogate.regressors.process import Process

Array = NDArray[np.float64]

#: Neighbours of a point.
NEAREST = 60
#: Points at once: what the core explains of their neighbours stays below 40 MB.
BLOCK = 5_000_000
#: Covariances given the core are differences of correlations: what rounding leaves of them.
ROUNDING = 1e-9


@dataclass(frozen=True, eq=False)
class ManyRuns:
    """All runs: points (n, c), standardised values (n,), and which of them are the core's (n,)."""

    points: Array
    standard: Array
    core: NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Given:
    """What the core says at points: mean (m,), L^-1 r (m, core), and gain^(1/2) h (m, q)."""

    mean: Array
    explained: Array
    rest: Array

    @classmethod
    def at(cls, core: Process, points: Array) -> Given:
        """At column values (m, c); standardised."""
        one = core.factors_
        r, trend = correlation(points, core.points_, core.lengths_), core.trend_columns(points)
        rest = (trend - r @ one.solved) @ np.linalg.cholesky(one.gain)
        mean = r @ core.weights_ + trend @ core.trend_
        explained = linalg.solve_triangular(
            one.factor, r.T, lower=True, overwrite_b=True, check_finite=False
        )
        return cls(mean, np.ascontiguousarray(explained.T), rest)


@dataclass(frozen=True, eq=False)
class NearestRuns:
    """Runs beside the core: points (n, c), what the core says there, and what it misses (n,).

    nearest  how many of them predict a point;  tree  of their points over lengths
    """

    core: Process
    points: Array
    given: Given
    missed: Array
    nearest: int
    tree: cKDTree

    @classmethod
    def beside(
        cls, core: Process, points: Array, standard: Array, nearest: int = NEAREST
    ) -> NearestRuns:
        """Runs at column values (n, c) with standardised values (n,), none of them the core's."""
        given = Given.at(core, points)
        tree = cKDTree(points / core.lengths_)
        return cls(core, points, given, standard - given.mean, min(nearest, len(points)), tree)

    def predict(self, points: Array) -> tuple[Array, Array]:
        """Standardised values (m,) of new runs, and their variances, the process's being 1."""
        mean, variance = np.empty((2, len(points)))
        for part in self._blocks(len(points)):
            mean[part], variance[part] = self._predicted(points[part])
        return mean, variance

    def _blocks(self, count: int) -> Iterator[slice]:
        step = max(BLOCK // (self.nearest * len(self.core.points_)), 1)
        return (slice(start, start + step) for start in range(0, count, step))

    def _predicted(self, points: Array) -> tuple[Array, Array]:
        near = self.tree.query(points / self.core.lengths_, k=[*range(1, self.nearest + 1)])[1]
        own, known, core = Given.at(self.core, points), self.given, self.core
        explained, rest, beside = known.explained[near], known.rest[near], self.points[near]
        noise = core.nugget_ * core.noise_at(beside.reshape(-1, beside.shape[-1]))
        inner = paired(beside[:, :, None], beside[:, None], core.lengths_)
        inner -= explained @ explained.swapaxes(1, 2)
        inner += rest @ rest.swapaxes(1, 2)
        np.einsum("kii->ki", inner)[:] += noise.reshape(near.shape) + ROUNDING
        outer = paired(beside, points[:, None], core.lengths_)
        outer -= np.einsum("kmc,kc->km", explained, own.explained)
        outer += np.einsum("kmq,kq->km", rest, own.rest)
        both = np.stack([outer, self.missed[near]], axis=-1)
        solved = np.linalg.solve(inner, both)
        nugget = core.nugget_ * core.noise_at(points)
        variance = 1.0 - (own.explained**2).sum(axis=1) + (own.rest**2).sum(axis=1) + nugget
        variance -= np.einsum("km,km->k", outer, solved[:, :, 0])
        return own.mean + np.einsum("km,km->k", outer, solved[:, :, 1]), np.maximum(
            variance, nugget
        )
