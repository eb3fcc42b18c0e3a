"""What is read from a Gaussian process that has its runs, lengths and nugget."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from surrogate.estimator import Groups
from surrogate.regressors import anova
from surrogate.regressors.columns import Column
from surrogate.regressors.kriging import Factored
from surrogate.space.space import Space

Array = NDArray[np.float64]


class Process(Protocol):
    """What a draw or a joint law needs of a `FittedProcess`."""

    space: Space | None
    n_features_in_: int
    columns_: tuple[Column, ...]
    points_: Array
    standard_: Array
    lengths_: Array
    nugget_: float
    noise_: Array
    widening_: float
    offset_: float
    scale_: float
    weights_: Array
    trend_: Array
    factors_: Factored

    def noise_at(self, points: Array) -> Array:
        """Variance (m,) of new runs about the process, in nuggets."""

    @property
    def predictive_variance(self) -> float:
        """Variance of the process, in the output's unit squared."""

    @property
    def interval_freedom(self) -> int:
        """Degrees of freedom of its predictions."""

    def expanded(self, X: ArrayLike) -> Array:
        """Numeric columns (m, c) of coded points (m, d)."""

    def trend_columns(self, points: Array) -> Array:
        """F (m, q) at numeric columns."""

    def own_columns(self, parameter: int, nodes: Array) -> tuple[list[int], Array]:
        """Numbers of one parameter's columns, and their values (m, own) at its nodes (m,)."""

    def factor(self, parameter: int, nodes: Array) -> Array:
        """Part of each term (n + q, m) that depends on one parameter."""

    def sobol_indices(self, groups: Groups | None = None) -> anova.SobolIndices:
        """Indices of its mean."""
