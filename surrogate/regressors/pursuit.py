"""Orthogonal least squares: terms one by one, each the one that reduces the residual most.

Chen, Billings, Luo 1989, Orthogonal least squares methods. For many runs see `moments`.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import linalg

Array = NDArray[np.float64]

#: An expansion of more terms is not sparse.
TERMS = 200


def pursue(matrix: Array, y: Array, steps: int) -> list[int]:
    """Columns of matrix (n, p) in the order of orthogonal least squares, the first one first.

    Squared norms and products with y of all columns, less their parts along those taken,
    are kept up to date by one matrix-vector product a step, O(n p).
    """
    squares, along = (matrix**2).sum(axis=0), y @ matrix
    floor = 1e-10 * squares + 1e-300
    taken, basis = [], np.empty((len(y), steps))
    for k in range(steps):
        column = strongest(squares, along, floor) if k else 0
        if column is None:
            break
        direction = matrix[:, column].copy()
        for _ in range(2):
            direction -= basis[:, :k] @ (basis[:, :k].T @ direction)
        basis[:, k] = direction / np.linalg.norm(direction)
        shadow = basis[:, k] @ matrix
        squares, along = squares - shadow**2, along - (basis[:, k] @ y) * shadow
        squares[column] = 0.0
        taken.append(column)
    return taken


def strongest(squares: Array, along: Array, floor: Array) -> int | None:
    """The column that reduces the residual most; None when no column does.

    squares, along: squared norms (p,) and products with y (p,), less the parts along columns
    taken; below `floor` nothing but rounding is left. Of columns that gain the same but for
    rounding, as aliased terms do, the first one is taken.
    """
    gains = np.where(squares > floor, along**2 / np.maximum(squares, floor), -1.0)
    column = int(np.argmax(gains >= (1.0 - 1e-9) * gains.max()))
    return column if gains[column] > 0.0 else None


def best_count(matrix: Array, y: Array, folds: NDArray[np.intp]) -> tuple[int, float]:
    """Number of terms with the smallest mean squared error on folds (n,), and that error.

    The error is a share of the variance. For each fold the terms are chosen without it.
    """
    steps = min(
        int(np.min([(folds != k).sum() for k in np.unique(folds)])) - 1, matrix.shape[1], TERMS
    )
    squares = np.zeros(max(steps, 1))
    for fold in np.unique(folds):
        inside = folds == fold
        order = pursue(matrix[~inside], y[~inside], len(squares))
        errors = _path_errors(matrix[:, order], y, inside)
        squares[: len(order)] += errors
        squares[len(order) :] += errors[-1]
    count = int(squares.argmin()) + 1
    total = float(((y - y.mean()) ** 2).sum())
    varies = total > 1e-28 * float(y @ y)  # by more than rounding
    return count, float(squares[count - 1]) / total if varies else 1.0


def _path_errors(matrix: Array, y: Array, inside: NDArray[np.bool_]) -> Array:
    """Squared error (k,) on the fold `inside` of fits by the first 1, 2, ... k columns."""
    basis, upper = np.linalg.qr(matrix[~inside])
    rotated = linalg.solve_triangular(upper, matrix[inside].T, trans="T").T
    predicted = np.cumsum(rotated * (basis.T @ y[~inside]), axis=1)
    return np.asarray(((y[inside, None] - predicted) ** 2).sum(axis=0))
