"""Recursive co-kriging: a few runs of the truth, and many of cheaper levels of fidelity.

Each level is a `LevelProcess` above the next cheaper one (Kennedy and O'Hagan 2000; Le Gratiet
and Garnier 2014, Recursive co-kriging model for design of computer experiments with multiple
levels of fidelity, doi 10.1615/Int.J.UncertaintyQuantification.2014006914).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, Self, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray
from sklearn.base import BaseEstimator, RegressorMixin
from sklearn.utils.validation import check_is_fitted, validate_data

from surrogate.errors import nearest
from surrogate.regressors import paths
from surrogate.regressors.level_process import LevelProcess, LevelRuns
from surrogate.space.space import Space

Array = NDArray[np.float64]

SCALES = ("constant", "linear")


class CoKriging(RegressorMixin, BaseEstimator):
    """Co-kriging of several levels of fidelity on coded inputs.

    scale   rho, what a unit of the cheaper level is worth: "constant" or "linear" in the inputs
    trend, nugget, starts, seed  of each level's process, as of `gaussian_process`
    space   the Space of the inputs; None for numeric inputs uniform on [-1, 1]
    lower   `LevelRuns` of the levels below the truth, cheapest first, as the study has them

    Fitted: `levels_`, the process of each level, cheapest first.
    """

    def __init__(
        self,
        scale: str = "constant",
        trend: str = "constant",
        nugget: str | float = "estimate",
        starts: int = 3,
        seed: int = 0,
        space: Space | None = None,
        lower: Sequence[LevelRuns] = (),
    ) -> None:
        self.scale = scale
        self.trend = trend
        self.nugget = nugget
        self.starts = starts
        self.seed = seed
        self.space = space
        self.lower = lower

    def fit(self, X: ArrayLike, y: ArrayLike) -> Self:
        """Fit to runs of the truth: coded points X (n, d) and values y (n,)."""
        if self.scale not in SCALES:
            raise ValueError(f"scale '{self.scale}': {nearest(self.scale, SCALES)}")
        points, values = validate_data(self, X, y, y_numeric=True, ensure_min_samples=2)
        self.levels_: list[LevelProcess] = []
        for runs in (*self.lower, LevelRuns(points, values)):
            below = self.levels_[-1] if self.levels_ else None
            level = LevelProcess(
                below,
                runs.inputs,
                self.scale,
                self.trend,
                self.nugget,
                self.starts,
                self.seed,
                self.space,
            )
            self.levels_.append(level.fit(runs.coded, runs.values))
        return self

    @property
    def truth(self) -> LevelProcess:
        """The process of the last level."""
        check_is_fitted(self)
        return self.levels_[-1]

    def minimum_runs(self, space: Space) -> int:
        """Runs of the truth that a fit needs: two more than trend and rho have coefficients."""
        words = (self.trend, self.scale) if self.lower else (self.trend,)
        ones = [LevelProcess(trend=word).minimum_runs(space) - 2 for word in words]
        return 2 + sum(ones)

    @property
    def interval_freedom(self) -> int:
        """Degrees of freedom n - q of the truth's process."""
        return self.truth.interval_freedom

    @overload
    def predict(self, X: ArrayLike, return_std: Literal[False] = False) -> Array: ...
    @overload
    def predict(self, X: ArrayLike, return_std: Literal[True]) -> tuple[Array, Array]: ...
    def predict(self, X: ArrayLike, return_std: bool = False) -> Array | tuple[Array, Array]:
        """The truth's values (m,) at coded X (m, d); with the standard deviation of a new run."""
        one = self.truth
        points = one.expanded(X)
        return one.new_runs(points) if return_std else one.unscaled(one.mean(points))

    def variance_of_levels(self, X: ArrayLike) -> Array:
        """What each level, cheapest first, adds to the truth's variance (m, levels) at X (m, d)."""
        return np.column_stack(self.truth.parts(self.truth.expanded(X)))

    def leave_one_out(self) -> Array:
        """Predictions (n,) of each run of the truth without the runs of all levels at its point."""
        return self.leave_out(np.arange(len(self.truth.points_)))

    def leave_out(self, folds: ArrayLike) -> Array:
        """Predictions (n,) of each run without its fold (n,), left out at all levels.

        In closed form, lengths and nuggets kept: see `LevelProcess.errors_without`.
        """
        one, numbers = self.truth, np.asarray(folds)
        runs = [np.flatnonzero(numbers == fold) for fold in np.unique(numbers)]
        errors = np.empty(len(numbers))
        for own, error in zip(runs, one.errors_without(runs), strict=True):
            errors[own] = error
        return one.unscaled(one.standard_ - errors)

    def posterior_draws(self, size: int, seed: int | None = None) -> list[Draw]:
        """Functions that are as plausible as the mean, given the runs of all levels.

        Rho, trends, process variances and processes are drawn; lengths and nuggets are kept
        (Le Gratiet, Cannamela and Iooss 2014, section 4).
        """
        rng = np.random.default_rng(seed)
        check_is_fitted(self)
        drawn = Paths([paths.draw(level, size, rng) for level in self.levels_], self.levels_)
        return [Draw(drawn, number) for number in range(size)]


@dataclass(frozen=True, eq=False)
class Paths:
    """Drawn functions of the truth: those of each level, and the processes of the levels."""

    own: list[paths.Paths]
    levels: list[LevelProcess]

    def predict(self, X: ArrayLike, which: int | slice) -> Array:
        """Values (m,) of path number `which`, or (m, k) of a slice of them, at coded X (m, d).

        A level's own path has rho times the mean of the level below; what the path below
        differs from that mean by is added.
        """
        values = self.own[0].predict(X, which)
        for own, level, below in zip(self.own[1:], self.levels[1:], self.levels, strict=False):
            points = level.expanded(X)
            g = level.scale_columns(points)
            rho = g @ own.trend[-g.shape[1] :, which]
            mean = below.unscaled(below.mean(points)).reshape((-1,) + (1,) * (values.ndim - 1))
            share = level.scale_ / (below.scale_ or 1.0)
            values = own.predict(X, which) + share * rho * (values - mean)
        return np.asarray(values)


@dataclass(frozen=True)
class Draw:
    """One drawn function of the truth."""

    paths: Paths
    number: int

    def predict(self, X: ArrayLike) -> Array:
        """Values (m,) at coded X (m, d)."""
        return self.paths.predict(X, self.number)
