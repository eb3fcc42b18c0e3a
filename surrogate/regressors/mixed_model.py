"""Linear mixed model: a polynomial, and a random shift of each batch or whole plot.

    y = X b + Z u + e,   u ~ N(0, s_u^2) a level of one parameter (batches, days, whole plots of a
                         split-plot design),   e ~ N(0, s_e^2)

The ratio t = s_u^2 / s_e^2 maximises the restricted likelihood (Patterson and Thompson 1971, doi
10.1093/biomet/58.3.545), so with V = I + t Z Z' it makes (n - p) log SSE + log |V| +
log |X' V^-1 X| small. In a group of k runs V^-1/2 takes (1 - 1 / sqrt(1 + k t)) of its mean from
each value, so that b is least squares of values and columns treated so. In balanced designs the
variances are those of the analysis of variance (Montgomery, Design and Analysis of Experiments,
section 14.4), unless that gives a negative one; then s_u = 0.

A term that is constant in each group is tested against the scatter between groups, with as many
degrees of freedom as there are groups less the terms of that kind; the others against the scatter
within them.
"""

from __future__ import annotations

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray
from scipy import optimize, stats

from surrogate.errors import FitError, nearest
from surrogate.regressors import regression
from surrogate.regressors.columns import Term, columns_of
from surrogate.regressors.least_squares import LeastSquares, least_squares
from surrogate.regressors.leave_one_out import by_refits
from surrogate.regressors.selection import CANDIDATES, Order, SelectedPolynomial
from surrogate.space.space import Space

Array = NDArray[np.float64]

#: Bounds of log t, below which there is no scatter between groups.
RATIOS = (-12.0, 12.0)


class MixedModel(SelectedPolynomial):
    """A polynomial with a random shift of each level of one parameter.

    random  the parameter with levels: batch, day, whole_plot. Predictions are of a new level of it
    order   terms of the other parameters: "linear", "interactions" or "quadratic"
    space   the Space of the inputs, which must have that parameter

    Fitted besides: `ratio_` s_u^2 / s_e^2, `between_` s_u and `within_` s_e, in the output's unit.
    """

    def __init__(self, random: str, order: Order = "linear", space: Space | None = None) -> None:
        super().__init__(order, space)
        self.random = random

    def select(self, values: Array, y: Array) -> list[Term]:
        """All terms of the order without the random parameter."""
        own = self._own(self.space)
        terms = CANDIDATES[self.order](self.columns_)
        return [t for t in terms if all(self.columns_[j].parameter != own for j, _ in t)]

    def minimum_runs(self, space: Space) -> int:
        """Runs that a fit needs: two more than terms; `FitError` where `random` has no levels."""
        own = self._own(space)
        columns = columns_of(space, space.size)
        terms = CANDIDATES[self.order](columns)
        return 2 + sum(all(columns[j].parameter != own for j, _ in term) for term in terms)

    def _own(self, space: Space | None) -> int:
        """Number of the random parameter."""
        levels = [] if space is None else [p.name for p in space.parameters if p.categorical]
        if space is None or self.random not in levels:
            known = f"; {nearest(self.random, levels)}" if levels else ""
            raise FitError(
                f"random: '{self.random}' is no parameter with levels, such as "
                f"batch: {{levels: [a, b]}}{known}"
            )
        return space.names.index(self.random)

    def fit(self, X: ArrayLike, y: ArrayLike) -> MixedModel:
        """Fit to coded points X (n, d) and values y (n,)."""
        matrix, outputs = self._matrix(X, y)
        self.values_, group = outputs, self._groups(self.points_)
        if group.max() < 1 or len(outputs) == group.max() + 1:
            raise FitError(
                f"{group.max() + 1} levels of {self.random} in {len(outputs)} runs do not tell "
                "scatter between levels from scatter within them; run some level more than once"
            )
        self.groups_ = group
        self.ratio_ = _ratio(matrix, outputs, group, self._names())
        self._set(_fitted(self.ratio_, matrix, outputs, group, self._names()))
        self.within_ = self.model_.residual_sd
        self.between_ = float(np.sqrt(self.ratio_)) * self.within_
        varies = [np.ptp(_centred(column, group)) > 1e-9 for column in matrix.T]
        self.inner_ = np.array(varies, dtype=bool)
        return self

    def _groups(self, points: Array) -> NDArray[np.intp]:
        """Number of each run's group, (n,); levels without runs are not counted."""
        assert self.space is not None
        own = self._own(self.space)
        levels = self.space.parameters[own].coded_levels
        nearest_level = np.abs(points[:, own, None] - levels).argmin(axis=1)
        return np.asarray(np.unique(nearest_level, return_inverse=True)[1].ravel(), dtype=np.intp)

    def leave_one_out(self) -> Array:
        """Predictions (n,) of each run by a fit without it."""
        return by_refits(self, self.points_, self.values_)

    @property
    def freedoms(self) -> tuple[int, int]:
        """Degrees of freedom of tests between groups, and within them."""
        kept, groups = self.model_.kept, int(self.groups_.max()) + 1
        between = groups - int((kept & ~self.inner_).sum())
        return between, len(self.groups_) - groups - int((kept & self.inner_).sum())

    def regression_table(
        self, *, confidence: float = 0.95, deterministic: bool = False
    ) -> xr.Dataset:
        """Table of the terms, each tested against its own scatter; see `regression.table`.

        Besides: `sd_between`, `sd_within`, `df_between`, `df_within`.
        """
        single = np.arange(len(self.groups_))[:, None]  # replicates are no pure error here
        table = regression.table(
            self.model_, single, confidence=confidence, deterministic=deterministic
        ).drop_vars(["box_cox", "box_cox_low", "box_cox_high"], errors="ignore")
        between, within = self.freedoms
        freedom = np.where(self.inner_, within, between)
        t, error = np.abs(table["t"].values), table["standard_error"].values
        known = freedom > 0
        safe = np.maximum(freedom, 1)
        half = stats.t.ppf(0.5 + confidence / 2.0, safe) * error
        for name, values in {
            "p": 2.0 * stats.t.sf(t, safe),
            "low": table["coefficient"].values - half,
            "high": table["coefficient"].values + half,
        }.items():
            table[name] = ("term", np.where(known, values, np.nan))
        table = table.assign(
            sd_between=self.between_, sd_within=self.within_, df_between=between, df_within=within
        )
        notes = filter(None, (self._told(between, within), table.attrs["notes"]))
        return table.assign_attrs(notes="\n".join(notes), transformation="")

    def _told(self, between: int, within: int) -> str:
        outer = [name for name, inner in zip(self._names(), self.inner_, strict=True) if not inner]
        return (
            f"Standard deviation between levels of {self.random} {self.between_:.3g}, within them "
            f"{self.within_:.3g}. Terms that do not vary within a level ({', '.join(outer)}) are "
            f"tested with {between} degrees of freedom, the others with {within}. R2 and Q2 of "
            "this table are of values less what levels share."
        )


def _centred(column: Array, group: NDArray[np.intp]) -> Array:
    """A column (n,) less its mean in each group."""
    return np.asarray(column - (np.bincount(group, column) / np.bincount(group))[group])


def _treated(ratio: float, columns: Array, group: NDArray[np.intp]) -> Array:
    """V^-1/2 times columns (n, k)."""
    count = np.bincount(group)
    share = 1.0 - 1.0 / np.sqrt(1.0 + count * ratio)
    means = np.stack([np.bincount(group, column) / count for column in columns.T], axis=1)
    return np.asarray(columns - (share[:, None] * means)[group])


def _fitted(
    ratio: float, matrix: Array, y: Array, group: NDArray[np.intp], names: list[str]
) -> LeastSquares:
    both = _treated(ratio, np.column_stack([matrix, y]), group)
    return least_squares(both[:, :-1], both[:, -1], names)


def _ratio(matrix: Array, y: Array, group: NDArray[np.intp], names: list[str]) -> float:
    """s_u^2 / s_e^2 of the largest restricted likelihood; 0 where the groups do not scatter."""
    count = np.bincount(group)

    def deviance(ratio: float) -> float:
        model = _fitted(ratio, matrix, y, group, names)
        if model.freedom < 1:
            raise FitError("as many terms as runs: there is no scatter to tell apart; add runs")
        determinant = -2.0 * float(np.log(np.abs(np.linalg.det(model.inverse))))
        least = max(model.sse, 1e-300)
        scatter = float(np.log1p(count * ratio).sum())
        return float(model.freedom * np.log(least)) + scatter + determinant

    found = optimize.minimize_scalar(
        lambda log: deviance(float(np.exp(log))),
        bounds=RATIOS,
        method="bounded",
        options={"xatol": 1e-9},
    )
    ratio = float(np.exp(found.x))
    return ratio if float(found.fun) < deviance(0.0) else 0.0
