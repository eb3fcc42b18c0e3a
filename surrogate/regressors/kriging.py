"""Universal kriging with known correlations R = correlations + nugget I and trend F b.

Santner, Williams, Notz, The Design and Analysis of Computer Experiments (2nd ed. 2018),
section 3.2; leaving runs out in closed form: Dubrule 1983.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import linalg

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Factored:
    """What correlations R (n, n) and trend columns F (n, q) give, whatever the values are.

    factor  (n, n) lower Cholesky factor of R
    F       (n, q);  solved (n, q) R^-1 F
    gain    (q, q) (F' R^-1 F)^-1
    """

    factor: Array
    F: Array
    solved: Array
    gain: Array

    def trend(self, y: Array) -> Array:
        """Generalised least squares coefficients (q, ...) of values y (n, ...)."""
        return np.asarray(self.gain @ (self.solved.T @ y))

    def weights(self, y: Array) -> Array:
        """Q y for values y (n, ...), by way of what the trend leaves of them."""
        rest = y - self.F @ self.trend(y)
        return np.asarray(linalg.lapack.dpotrs(self.factor, rest, lower=1)[0])

    def variance(self, y: Array, weights: Array) -> Array:
        """y' Q y / (n - q) of each output, the variance by restricted maximum likelihood."""
        n, q = self.F.shape
        return np.asarray(np.maximum((y * weights).sum(axis=0) / (n - q), 1e-300))

    @property
    def projected(self) -> Array:
        """Q (n, n) = R^-1 - R^-1 F (F' R^-1 F)^-1 F' R^-1."""
        inverse = linalg.lapack.dpotri(self.factor, lower=1)[0]
        inverse += inverse.T  # the upper triangle was zero, so only the diagonal is doubled
        np.fill_diagonal(inverse, 0.5 * inverse.diagonal())
        return np.asarray(inverse.T - self.solved @ self.gain @ self.solved.T)  # .T: rows are read

    @property
    def log_determinant(self) -> float:
        """log |R| + log |F' R^-1 F|."""
        return float(
            2.0 * np.log(np.diag(self.factor)).sum() - np.linalg.slogdet(self.gain).logabsdet
        )


def factored(matrix: Array, F: Array) -> Factored:
    """Factor R = `matrix` (n, n), which is overwritten, for trend columns F (n, q).

    Raises LinAlgError when R is not positive definite to rounding.
    """
    factor = linalg.cholesky(matrix.T, lower=True, overwrite_a=True, check_finite=False)
    solved = linalg.cho_solve((factor, True), F, check_finite=False)
    return Factored(factor, F, solved, np.asarray(np.linalg.inv(F.T @ solved), dtype=np.float64))


def left_out_errors(
    factors: Factored, weights: Array, folds: NDArray[np.intp]
) -> tuple[Array, Array]:
    """y - prediction (n,) without each run's fold (n,), and its variance, the process's being 1.

    For a fold B: (Q_BB)^-1 (Q y)_B, and the diagonal of (Q_BB)^-1.
    """
    projected, error, variance = factors.projected, np.empty(len(folds)), np.empty(len(folds))
    for fold in np.unique(folds):
        inside = np.flatnonzero(folds == fold)
        inverse = np.linalg.inv(projected[np.ix_(inside, inside)])
        error[inside], variance[inside] = inverse @ weights[inside], inverse.diagonal()
    return error, variance
