"""Orthogonal least squares: terms one by one, each the one that reduces the residual most.

Chen, Billings, Luo 1989, Orthogonal least squares methods. For many runs see `moments`.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: An expansion of more terms is not sparse.
TERMS = 200
#: The search for a number of terms ends at this many times the best one so far, and these more.
BEYOND, MORE = 2, 20


def pursue(matrix: Array, y: Array, steps: int) -> list[int]:
    """Columns of matrix (n, p) in the order of orthogonal least squares, the first one first."""
    every = np.ones((1, len(y)))
    return [int(columns[0]) for columns, _ in _sweep(matrix, y, every, steps)]


def strongest(squares: Array, along: Array, floor: Array) -> NDArray[np.intp]:
    """The column that reduces the residual most, -1 when none does; of each row of (..., p).

    squares, along: squared norms (..., p) and products with y, less the parts along columns
    taken; below `floor` nothing but rounding is left. Of columns that gain the same but for
    rounding, as aliased terms do, the first one is taken.
    """
    gains = np.where(squares > floor, along**2 / np.maximum(squares, floor), -1.0)
    largest = gains.max(axis=-1, keepdims=True)
    columns = np.argmax(gains >= (1.0 - 1e-9) * largest, axis=-1)
    return np.where(largest[..., 0] > 0.0, columns, -1)


def best_count(matrix: Array, y: Array, folds: NDArray[np.intp]) -> tuple[int, float]:
    """Number of terms with the smallest mean squared error on folds (n,), and that error.

    The error is a share of the variance. For each fold the terms are chosen without it.
    """
    squares = _errors_on_folds(matrix, y, folds)
    count = int(np.argmin(squares)) + 1
    total = float(((y - y.mean()) ** 2).sum())
    varies = total > 1e-28 * float(y @ y)  # by more than rounding
    return count, squares[count - 1] / total if varies else 1.0


def _errors_on_folds(matrix: Array, y: Array, folds: NDArray[np.intp]) -> list[float]:
    """Squared error of all runs by 1, 2, ... terms, each fold predicted by a fit without it."""
    fitted = (folds != np.unique(folds)[:, None]).astype(float)
    steps = max(min(int(fitted.sum(axis=1).min()) - 1, matrix.shape[1], TERMS), 1)
    errors: list[float] = []
    smallest, count = np.inf, 1
    for _, left in _sweep(matrix, y, fitted, steps):
        errors.append(float((left**2).sum()))
        if errors[-1] < smallest:
            smallest, count = errors[-1], len(errors)
        if len(errors) >= BEYOND * count + MORE:
            break
    return errors


def _sweep(
    matrix: Array, y: Array, fitted: Array, steps: int
) -> Iterator[tuple[NDArray[np.intp], Array]]:
    """Orthogonal least squares on several sets of the runs, which take a term each at a step.

    fitted (sets, n) is 1 for the runs of a set, 0 for those left out. Gives the column that each
    set takes, -1 for none, and what it misses at the runs left out (sets, n), 0 at its own. The
    sweep ends when no set takes one.

    A direction is orthonormal on the runs of its set; the same combination of columns continues
    it to the others, where it predicts. Squared norms and products with y of all columns, less
    their parts along those taken, are kept up to date by one matrix product a step, O(sets n p).
    """
    squares, along = fitted @ matrix**2, (fitted * y) @ matrix
    floor = 1e-10 * squares + 1e-300
    basis = np.zeros((len(fitted), steps, len(y)))
    left = (1.0 - fitted) * y
    for k in range(steps):
        columns = strongest(squares, along, floor) if k else np.zeros(len(fitted), dtype=np.intp)
        some = columns >= 0
        if not some.any():
            return
        direction = matrix[:, columns].T * some[:, None]
        for _ in range(2):
            parts = basis[:, :k] @ (fitted * direction)[:, :, None]
            direction -= (parts.transpose(0, 2, 1) @ basis[:, :k])[:, 0]
        size = np.sqrt(((fitted * direction) ** 2).sum(axis=1))
        basis[:, k] = direction / np.where(some, size, 1.0)[:, None]
        inside = fitted * basis[:, k]
        shadow, height = inside @ matrix, inside @ y
        squares, along = squares - shadow**2, along - height[:, None] * shadow
        squares[np.arange(len(fitted)), columns] = 0.0
        left -= height[:, None] * (basis[:, k] - inside)
        yield columns, left
