"""Hidden extrapolation: points inside of every range, but outside of the cloud of runs.

A point x0 extrapolates when x0' (X'X)^-1 x0 is above the largest of the training runs, X
being the matrix of the constant and the coded inputs (Montgomery, Peck and Vining 2012,
section 3.8).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from surrogate.regressors.columns import columns_of, expand
from surrogate.space.space import Space

Array = NDArray[np.float64]
#: Parts of the inputs that the runs do not vary are smaller than this share of those they do.
RANK = 1e-9


@dataclass(frozen=True, eq=False)
class Cloud:
    """The cloud of training points in the columns of X, of which they vary r directions.

    directions  (r, c + 1) orthonormal; sizes (r,) root sums of squares along them
    largest     x0' (X'X)^-1 x0 of the training point farthest out
    """

    space: Space
    directions: Array
    sizes: Array
    largest: float

    def leaves_out(self, coded: Array) -> NDArray[np.bool_]:
        """Which coded points (m, d) lie outside."""
        new = _matrix(self.space, coded)
        along = new @ self.directions.T
        away = np.abs(new - along @ self.directions).max(axis=1) > 1e-6
        leverage = ((along / self.sizes) ** 2).sum(axis=1)
        return np.asarray((leverage > self.largest * (1.0 + 1e-9)) | away)


def cloud(space: Space, training: Array) -> Cloud:
    """The cloud of training points (n, d)."""
    X = _matrix(space, training)
    _, sizes, directions = np.linalg.svd(X, full_matrices=False)
    kept = sizes > RANK * sizes[0]
    sizes, directions = sizes[kept], directions[kept]
    largest = float((((X @ directions.T) / sizes) ** 2).sum(axis=1).max())
    return Cloud(space, directions, sizes, largest)


def extrapolates(space: Space, training: Array, coded: Array) -> NDArray[np.bool_]:
    """Which coded points (m, d) lie outside of the cloud of the training points (n, d)."""
    return cloud(space, training).leaves_out(coded)


def _matrix(space: Space, coded: Array) -> Array:
    columns = expand(coded, columns_of(space, space.size))
    return np.column_stack([np.ones(len(columns)), columns])
