"""What makes a design good for a polynomial: small errors of its coefficients or predictions.

With the model matrix F (run, term) and V = (F'F)^-1, the coefficients have the covariance
sigma^2 V (Atkinson, Donev and Tobias, Optimum Experimental Designs, with SAS, 2007, chapter 10).
A criterion has two parts: its value for a design, and what it gains from exchanging one run.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Criterion(Protocol):
    """Larger is better, for both."""

    def value(self, matrix: Array) -> float:
        """Logarithm of the criterion, for a model matrix (run, term); -inf when singular."""
        ...

    def gains(self, new: Array, old: Array, inverse: Array) -> Array:
        """Factors (candidate,) of the criterion when row `old` is replaced by rows `new`.

        inverse: V of the design that holds the old row.
        """
        ...


class Determinant:
    """D: det(F'F), the smaller the joint confidence region of all coefficients."""

    def value(self, matrix: Array) -> float:
        """log det(F'F)."""
        return log_determinant(matrix)

    def gains(self, new: Array, old: Array, inverse: Array) -> Array:
        """(1 + g'Vg)(1 - f'Vf) + (f'Vg)^2 for a row f that becomes g (Fedorov 1972, 3.2)."""
        across = new @ inverse
        return np.asarray(
            (1.0 + (across * new).sum(axis=1)) * (1.0 - old @ inverse @ old) + (across @ old) ** 2
        )


@dataclass(frozen=True)
class MeanVariance:
    """1 / tr(V B): A when B is the identity, I when B is the mean of f f' over the ranges.

    A: mean variance of the coefficients. I (or V, Q): mean variance of predictions over the
    ranges, since the mean of f'Vf is tr(V B) (Box and Draper 1959).
    """

    moments: Array

    def value(self, matrix: Array) -> float:
        """-log tr(V B)."""
        if not np.isfinite(log_determinant(matrix)):
            return -np.inf
        return -float(np.log(np.vdot(np.linalg.inv(matrix.T @ matrix), self.moments)))

    def gains(self, new: Array, old: Array, inverse: Array) -> Array:
        """By Woodbury's identity for F'F - ff' + gg', a change of rank two.

        With K = [[1 + g'Vg, g'Vf], [f'Vg, f'Vf - 1]] and W the same products with VBV in place
        of V, the trace falls by tr(K^-1 W).
        """
        middle = inverse @ self.moments @ inverse
        now = np.vdot(inverse, self.moments)
        gg, gf, ff = (new @ inverse * new).sum(axis=1), new @ inverse @ old, old @ inverse @ old
        wgg, wgf, wff = (new @ middle * new).sum(axis=1), new @ middle @ old, old @ middle @ old
        determinant = (1.0 + gg) * (ff - 1.0) - gf**2
        # At zero the run carries a term alone, and the exchange would lose that term.
        lost = determinant > -1e-12
        fall = ((ff - 1.0) * wgg - 2.0 * gf * wgf + (1.0 + gg) * wff) / np.where(
            lost, -1.0, determinant
        )
        return np.where(lost, 0.0, now / (now - fall))


def log_determinant(matrix: Array) -> float:
    """log det(F'F) of a model matrix (run, term); -inf when a term cannot be estimated."""
    singular = np.linalg.svd(matrix, compute_uv=False)
    return float(2.0 * np.log(singular).sum()) if singular[-1] > 1e-9 else -np.inf
