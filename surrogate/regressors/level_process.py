"""One level of a recursive co-kriging: a Gaussian process above a cheaper level's.

The process of a level is a scaled copy of the level below and an independent discrepancy,

    y(x) = rho(x) y_below(x) + delta(x),   rho(x) = g(x)' b

y_below about its mean (Kennedy and O'Hagan 2000). Le Gratiet and Garnier 2014 fit one level
after the other: given the level below, rho is a part of the trend of a universal kriging, with
the columns g(x) times the level below: its answers at the runs, its mean elsewhere. Rho is
integrated out like the rest of the trend.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from surrogate.regressors.columns import Term
from surrogate.regressors.gaussian_process import GaussianProcess
from surrogate.regressors.likelihood import HEAVY_TAILED
from surrogate.regressors.matern import weighted_sum
from surrogate.regressors.polynomial import design_matrix, linear_terms
from surrogate.space.space import Space

Array = NDArray[np.float64]
Numbers = NDArray[np.intp]

#: Coded points of two levels that are nearer are one point.
SAME = 1e-9


@dataclass(frozen=True, eq=False)
class LevelRuns:
    """The runs of a level below the truth.

    coded (n, d), values (n,); inputs: numbers of the inputs that the level takes, None for all
    """

    coded: Array
    values: Array
    inputs: tuple[int, ...] | None = None


class LevelProcess(GaussianProcess):
    """A level given the level below, in the words of `GaussianProcess`.

    below   the fitted process of the next cheaper level; None for the cheapest
    inputs  numbers of the inputs that the level takes; None for all. It takes those of the level
            below too
    scale   rho: "constant" or "linear" in the inputs

    The prior of its lengths has heavy tails: cheap levels have many runs, and what a level adds
    often depends on few inputs.
    """

    length_prior = HEAVY_TAILED

    def __init__(
        self,
        below: LevelProcess | None = None,
        inputs: tuple[int, ...] | None = None,
        scale: str = "constant",
        trend: str = "constant",
        nugget: str | float = "estimate",
        starts: int = 3,
        seed: int = 0,
        space: Space | None = None,
    ) -> None:
        super().__init__(trend, nugget, starts, seed, space)
        self.below, self.inputs, self.scale = below, inputs, scale

    def _take(self, X: ArrayLike, y: ArrayLike) -> None:
        super()._take(X, y)
        self.points_ = self.points_ * self.mask

    @property
    def mask(self) -> Array:
        """1 for each column of an input that the level takes, 0 for others, (c,)."""
        if self.inputs is None:
            return np.ones(len(self.columns_))
        return np.array([float(column.parameter in self.inputs) for column in self.columns_])

    def expanded(self, X: ArrayLike) -> Array:
        """Numeric columns (m, c) of coded points (m, d); zeros for inputs that are not taken."""
        return super().expanded(X) * self.mask

    def own_columns(self, parameter: int, nodes: Array) -> tuple[list[int], Array]:
        """As of `GaussianProcess`; none for an input that the level does not take."""
        if self.inputs is None or parameter in self.inputs:
            return super().own_columns(parameter, nodes)
        return [], np.empty((len(nodes), 0))

    def _linear_terms(self) -> list[Term]:
        """The constant, and each column of an input that is taken."""
        taken = self.mask
        return [t for t in linear_terms(self.columns_) if all(taken[j] for j, _ in t)]

    def _trend_terms(self) -> list[Term]:
        return self._linear_terms() if self.trend == "linear" else [()]

    def trend_columns(self, points: Array) -> Array:
        """F (n, q): those of the trend, then those of rho times the level below."""
        own = super().trend_columns(points)
        if self.below is None:
            return own
        return np.hstack([own, self.scale_columns(points) * self.below.mean(points)[:, None]])

    def scale_columns(self, points: Array) -> Array:
        """g (n, p), of which rho is made, at numeric columns (n, c)."""
        terms: list[Term] = self._linear_terms() if self.scale == "linear" else [()]
        return design_matrix(terms, points)

    def _trend_of_runs(self, points: Array) -> Array:
        """F (n, q) at runs: with the answers of the level below where it has a run at the point."""
        F = self.trend_columns(points)
        if self.below is None:
            return F
        twins, g = self.below.runs_at(points), self.scale_columns(points)
        known = twins >= 0
        F[known, -g.shape[1] :] = g[known] * self.below.standard_[twins[known], None]
        return F

    def _undetermined(self, size: int) -> str:
        if self.below is None:
            return super()._undetermined(size)
        return (
            f"the {size} coefficients of a {self.trend} trend and a {self.scale} scale of a "
            "cheaper level; add runs at which the cheaper level takes different values"
        )

    def mean(self, points: Array) -> Array:
        """The standardised mean (m,) at numeric columns (m, c) of all inputs."""
        points = points * self.mask
        sums = weighted_sum(points, self.points_, self.lengths_, self.weights_)
        return np.asarray(sums + self.trend_columns(points) @ self.trend_)

    def new_runs(self, points: Array) -> tuple[Array, Array]:
        """Values (m,) at numeric columns (m, c) and deviations of new runs, of all levels."""
        variance = np.sum(self.parts(points), axis=0) + self.predictive_variance * self.nugget_
        return self.unscaled(self.mean(points)), np.sqrt(variance)

    def rho(self, points: Array) -> tuple[Array, Array]:
        """Rho (m,) between standardised levels, and its variance (m,), at numeric columns."""
        g = self.scale_columns(points)
        p, share = g.shape[1], self.predictive_variance / (self.scale_**2 or 1.0)
        spread = np.einsum("ij,jk,ik->i", g, self.factors_.gain[-p:, -p:], g)
        return g @ self.trend_[-p:], share * spread

    def parts(self, points: Array) -> list[Array]:
        """What each level, cheapest first, adds to the variance (m,) here, in output units squared.

        Of the process, without a run's nugget; rho's mean square multiplies what comes from
        below (Le Gratiet and Garnier 2014, proposition 2).
        """
        points = points * self.mask
        _, variance = self._sums_and_variance(points, self.weights_[:, None])
        own = self.predictive_variance * np.maximum(variance - self.nugget_, 0.0)
        if self.below is None:
            return [own]
        rho, spread = self.rho(points)
        factor = (self.scale_ / (self.below.scale_ or 1.0)) ** 2 * (rho**2 + spread)
        return [*(factor * part for part in self.below.parts(points)), own]

    def errors_without(self, folds: list[Numbers]) -> list[Array]:
        """Errors y - prediction, standardised, of each fold of runs left out at all levels.

        folds: numbers of runs of this level. Lengths and nuggets are kept. A fold B that is left
        out of this level alone has the errors e = (Q_BB)^-1 (Q y)_B (see `kriging`) and leaves
        the trend b - (F' R^-1 F)^-1 F' R^-1 e, R^-1 F taken at B. Left out below as well, with
        errors d there, its answers at B are predicted, and rho d is added (Le Gratiet 2013,
        Multi-fidelity Gaussian process regression for computer experiments, section 4.3).
        """
        projected = self.factors_.projected
        errors: list[Array] = [
            np.asarray(np.linalg.solve(projected[np.ix_(fold, fold)], self.weights_[fold]))
            for fold in folds
        ]
        if self.below is None:
            return errors
        twins = [self.below.runs_at(self.points_[fold]) for fold in folds]
        left_below = self.below.errors_without([own[own >= 0] for own in twins])
        p = self.scale_columns(self.points_[:1]).shape[1]
        for error, fold, own, below in zip(errors, folds, twins, left_below, strict=True):
            left = self.factors_.solved[fold].T @ error
            rho = (self.trend_ - self.factors_.gain @ left)[-p:]
            known = own >= 0
            error[known] += self.scale_columns(self.points_[fold[known]]) @ rho * below
        return errors

    def runs_at(self, points: Array) -> Numbers:
        """Number of the run of this level at each of points (m, c); -1 where there is none."""
        apart = np.abs((points * self.mask)[:, None, :] - self.points_[None]).max(axis=2)
        nearest = apart.argmin(axis=1)
        return np.where(apart[np.arange(len(points)), nearest] < SAME, nearest, -1)
