"""Least squares, one output or many: coefficients, leverage, runs left out in closed form.

The formulas are those of Montgomery, Peck, Vining, Introduction to Linear Regression Analysis
(5th ed. 2012), chapters 3, 4 and 6.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import linalg

from surrogate.errors import FitError

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

#: A column whose part outside the earlier ones is smaller than this (relative) is aliased.
RANK_TOLERANCE = 1e-7
#: A run whose leverage is this close to 1 determines a coefficient alone.
LEVERAGE_TOLERANCE = 1e-10


@dataclass(frozen=True, eq=False)
class LeastSquares:
    """A least squares fit of n runs by p terms, of which r are told apart by the runs.

    names         p term names, the constant `1` first
    matrix        (n, p); y (n,)
    kept          (p,) False for terms that earlier terms reproduce; their coefficient is 0
    coefficients  (p,)
    alias         (r, p - r): dropped column = kept columns @ alias
    basis         (n, r) orthonormal columns Q of X = Q R; inverse (r, r) is R^-1
    """

    names: tuple[str, ...]
    matrix: Array
    y: Array
    kept: Mask
    coefficients: Array
    alias: Array
    basis: Array
    inverse: Array

    @property
    def residuals(self) -> Array:
        """y - X b, shape (n,)."""
        return self.y - self.matrix @ self.coefficients

    @property
    def freedom(self) -> int:
        """Residual degrees of freedom n - r."""
        return len(self.y) - int(self.basis.shape[1])

    @property
    def sse(self) -> float:
        """Sum of squared residuals."""
        return float(self.residuals @ self.residuals)

    @property
    def sst(self) -> float:
        """Sum of squares about the mean."""
        return float(((self.y - self.y.mean()) ** 2).sum())

    @property
    def residual_sd(self) -> float:
        """sqrt(SSE / (n - r)); NaN without residual degrees of freedom."""
        return float(np.sqrt(self.sse / self.freedom)) if self.freedom else np.nan

    @property
    def leverage(self) -> Array:
        """Diagonal of X (X'X)^-1 X', shape (n,)."""
        return np.asarray((self.basis**2).sum(axis=1))

    @property
    def estimable(self) -> Mask:
        """(p,) True where the runs determine the coefficient, whatever the other terms are."""
        result = self.kept.copy()
        result[self.kept] = ~(np.abs(self.alias) > 1e-8).any(axis=1)
        return result

    def leave_out(self, folds: Array) -> Array:
        """Predictions (n,) of each run by the fit without its fold, in closed form.

        For a fold B: y_B - prediction = (I - H_BB)^-1 e_B with H the hat matrix
        (Montgomery et al., appendix C.7). NaN where the rest cannot fit the model.
        """
        left_out = np.full(len(self.y), np.nan)
        residuals = self.residuals
        for fold in np.unique(folds):
            inside = np.flatnonzero(folds == fold)
            errors = _without(self.basis[inside], residuals[inside])
            if errors is not None:
                left_out[inside] = self.y[inside] - errors
        return left_out

    def leave_one_out(self) -> Array:
        """Predictions (n,) of each run by the fit without it: y - e / (1 - h)."""
        slack = 1.0 - self.leverage
        slack[slack < LEVERAGE_TOLERANCE] = np.nan
        return self.y - self.residuals / slack

    def standard_error(self, rows: Array) -> Array:
        """Standard deviation (m,) of a new observation at design rows (m, p)."""
        return self.residual_sd * self.spread(rows)

    def spread(self, rows: Array) -> Array:
        """sqrt(1 + x' (X'X)^-1 x) (m,) of design rows x (m, p)."""
        return np.asarray(np.sqrt(1.0 + ((rows[:, self.kept] @ self.inverse) ** 2).sum(axis=1)))

    def covariance(self, rows: Array) -> Array:
        """Covariances (m, n, n) of new observations at m sets of n design rows (m, n, p).

        s^2 ([x = y] + x' (X'X)^-1 y): observations at the same point are one observation.
        """
        kept = rows[..., self.kept] @ self.inverse
        same = (rows[:, :, None, :] == rows[:, None, :, :]).all(axis=3)
        return np.asarray(self.residual_sd**2 * (same + kept @ kept.swapaxes(1, 2)))


def _without(basis: Array, residuals: Array) -> Array | None:
    """(I - H)^-1 e (k,) of a fold with rows B (k, r) of the basis, H = B B'; None if singular.

    Solved in the smaller of runs and terms: (I - B B')^-1 = I + B (I - B'B)^-1 B' (Woodbury).
    """
    runs, terms = basis.shape
    if runs <= terms:
        rest = np.eye(runs) - basis @ basis.T
        regular = np.linalg.eigvalsh(rest)[0] > LEVERAGE_TOLERANCE
        return np.asarray(np.linalg.solve(rest, residuals), np.float64) if regular else None
    rest = np.eye(terms) - basis.T @ basis
    if np.linalg.eigvalsh(rest)[0] <= LEVERAGE_TOLERANCE:
        return None
    return np.asarray(residuals + basis @ np.linalg.solve(rest, basis.T @ residuals))


def least_squares(matrix: ArrayLike, y: ArrayLike, names: Iterable[str]) -> LeastSquares:
    """Fit y (n,) by the columns of matrix (n, p), called `names`.

    A column that earlier columns reproduce is dropped (coefficient 0), so lower
    terms, which come first, win. Raises `FitError` for values that are not finite.
    """
    return least_squares_of_many(matrix, np.asarray(y, dtype=float)[:, None], names)[0]


def least_squares_of_many(
    matrix: ArrayLike, Y: ArrayLike, names: Iterable[str]
) -> list[LeastSquares]:
    """Fits of outputs Y (n, k) by the same columns: one factorisation, which they share."""
    matrix, Y, names = np.asarray(matrix, float), np.asarray(Y, float), tuple(names)
    if not (np.isfinite(matrix).all() and np.isfinite(Y).all()):
        raise FitError("some values are not finite; leave failed runs out before fitting")
    kept = _independent(matrix)
    basis, upper = np.linalg.qr(matrix[:, kept])
    inverse = linalg.solve_triangular(upper, np.eye(kept.sum()))
    coefficients = np.zeros((Y.shape[1], matrix.shape[1]))
    coefficients[:, kept] = linalg.solve_triangular(upper, basis.T @ Y).T
    alias = linalg.solve_triangular(upper, basis.T @ matrix[:, ~kept])
    return [
        LeastSquares(names, matrix, y, kept, own, alias, basis, inverse)
        for y, own in zip(Y.T, coefficients, strict=True)
    ]


def _independent(matrix: Array) -> Mask:
    """(p,) which columns are not combinations of earlier ones (Gram-Schmidt, done twice)."""
    n, p = matrix.shape
    basis = np.zeros((n, min(n, p)))
    kept = np.zeros(p, dtype=bool)
    for j in range(p):
        rank = kept.sum()
        if rank == n:
            break
        rest = matrix[:, j].copy()
        for _ in range(2):
            rest -= basis[:, :rank] @ (basis[:, :rank].T @ rest)
        size = np.linalg.norm(rest)
        if size > RANK_TOLERANCE * np.linalg.norm(matrix[:, j]):
            basis[:, rank] = rest / size
            kept[j] = True
    return kept
