"""Hidden extrapolation: points inside of every range, but outside of the cloud of runs.

A point x0 extrapolates when x0' (X'X)^-1 x0 is above the largest of the training runs, X
being the matrix of the constant and the coded inputs (Montgomery, Peck and Vining 2012,
section 3.8).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from surrogate.regressors.columns import columns_of, expand
from surrogate.space.space import Space

Array = NDArray[np.float64]
#: Parts of the inputs that the runs do not vary are smaller than this share of those they do.
RANK = 1e-9


def extrapolates(space: Space, training: Array, coded: Array) -> NDArray[np.bool_]:
    """Which coded points (m, d) lie outside of the cloud of the training points (n, d)."""
    X, new = _matrix(space, training), _matrix(space, coded)
    _, sizes, directions = np.linalg.svd(X, full_matrices=False)
    kept = sizes > RANK * sizes[0]
    scaled = directions[kept].T / sizes[kept]
    largest = ((X @ scaled) ** 2).sum(axis=1).max()
    outside = np.abs(new - new @ directions[kept].T @ directions[kept]).max(axis=1) > 1e-6
    return np.asarray((((new @ scaled) ** 2).sum(axis=1) > largest * (1.0 + 1e-9)) | outside)


def _matrix(space: Space, coded: Array) -> Array:
    columns = expand(coded, columns_of(space, space.size))
    return np.column_stack([np.ones(len(columns)), columns])
