"""Polynomials that a few wild runs hardly move: Huber's M-estimate.

    minimise sum rho(e_i / s),   rho(u) = u^2 / 2 where |u| <= c, c |u| - c^2 / 2 beyond,

with c = 1.345, which keeps 95 % of the efficiency of least squares when errors are normal, and
the scale s = median |e_i| / 0.6745 (Huber 1964, doi 10.1214/aoms/1177703732; Huber and Ronchetti,
Robust Statistics, 2nd ed. 2009, sections 7.3 to 7.8). Found by least squares with the weights
min(1, c s / |e_i|), again and again (Holland and Welsch 1977). A run is suspicious when its
error is beyond s sqrt(n / (n - p)) times the quantile 1 - 0.05 / (2 n) of Student's t with n - p
degrees of freedom: among n good runs one is suspected in 5 to 9 % of the cases (s is estimated).
A wild run that has all the leverage is followed, as by least squares.

The table is that of least squares through the pseudo-values y* = fit + K s psi(e / s) / m, with m
the share of errors within c s and K = 1 + p (1 - m) / (n m), which has the same coefficients
and the standard errors of Huber and Ronchetti, equation 7.83.
"""

from __future__ import annotations

import math
from typing import Self

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray
from scipy import stats

from surrogate.regressors.columns import Term, columns_of
from surrogate.regressors.least_squares import least_squares
from surrogate.regressors.leave_one_out import by_refits
from surrogate.regressors.polynomial import TermRegressor
from surrogate.regressors.selection import CANDIDATES, Order, SelectedPolynomial
from surrogate.space.space import Space

Array = NDArray[np.float64]

EFFICIENT = 1.345
#: Median of |error| of a standard normal law.
NORMAL_MEDIAN = 0.6744897501960817
#: Steps at most, and the change of the weights at which they end.
STEPS, END = 200, 1e-10
#: Chance that some run is suspected among good ones.
CHANCE = 0.05
#: Errors below this share of the output's spread are rounding.
ROUNDING = 1e-10
PSEUDO = (
    "Huber's estimate: wild runs count less. R2, tests and Q2 are of values in which their "
    "errors are cut off."
)


class Huber(SelectedPolynomial):
    """Huber's M-estimate of a polynomial, on all terms of an order.

    order    terms: "linear", "interactions" or "quadratic"
    epsilon  errors beyond so many scales count by their size, not its square
    space    as for `Polynomial`

    Fitted besides: `scale_`, robust standard deviation of the errors, and `suspicious_`, numbers
    of the suspicious runs, counted from 0.
    """

    def __init__(
        self, order: Order = "linear", epsilon: float = EFFICIENT, space: Space | None = None
    ) -> None:
        super().__init__(order, space)
        self.epsilon = epsilon

    def select(self, values: Array, y: Array) -> list[Term]:
        """All terms of the order."""
        return self.candidates()

    def minimum_runs(self, space: Space) -> int:
        """Runs that a fit needs: two for each term, for half of them may be wild."""
        return 2 * len(CANDIDATES[self.order](columns_of(space, space.size)))

    def fit(self, X: ArrayLike, y: ArrayLike) -> Self:
        """Fit to coded points X (n, d) and values y (n,)."""
        if not self.epsilon > 0.0:
            raise ValueError(f"epsilon {self.epsilon}: give a number above 0, such as {EFFICIENT}")
        matrix, outputs = self._matrix(X, y)
        self.values_ = outputs
        coefficients, limit = self._reweighted(matrix, outputs)
        fitted = matrix @ coefficients
        errors = outputs - fitted
        self.scale_ = _scale(errors)
        self.suspicious_ = np.flatnonzero(np.abs(errors) > max(self._suspected(len(errors)), limit))
        self._set(least_squares(matrix, fitted + self._pseudo(errors, limit), self._names()))
        return self

    def _reweighted(self, matrix: Array, y: Array) -> tuple[Array, float]:
        """Coefficients (p,) at which weighted least squares repeats itself, and its c s."""
        weights, limit, names = np.ones(len(y)), math.inf, self._names()
        for _ in range(STEPS):
            roots = np.sqrt(weights)
            model = least_squares(matrix * roots[:, None], y * roots, names)
            errors = np.abs(y - matrix @ model.coefficients)
            limit = max(self.epsilon * _scale(errors), ROUNDING * float(np.ptp(y)), 1e-300)
            before, weights = weights, limit / np.maximum(errors, limit)
            if np.abs(weights - before).max() <= END:
                break
        return model.coefficients, limit

    def _suspected(self, n: int) -> float:
        """Size of an error that is suspicious among n; infinite where nothing can be."""
        freedom = n - len(self.terms_)
        if freedom < 1:
            return math.inf
        quantile = float(stats.t.isf(CHANCE / (2.0 * n), freedom))
        return quantile * self.scale_ * math.sqrt(n / freedom)

    def _pseudo(self, errors: Array, limit: float) -> Array:
        """Errors (n,) whose least squares table is that of the estimate."""
        inside = float(np.mean(np.abs(errors) <= limit))
        correction = 1.0 + len(self.terms_) / len(errors) * (1.0 - inside) / inside
        return np.clip(errors, -limit, limit) * correction / inside

    def leave_one_out(self) -> Array:
        """Predictions (n,) of each run by a fit without it."""
        return by_refits(self, self.points_, self.values_)

    def regression_table(
        self, *, confidence: float = 0.95, deterministic: bool = False
    ) -> xr.Dataset:
        """Table of the coefficients with robust standard errors; see the module."""
        table = TermRegressor.regression_table(
            self, confidence=confidence, deterministic=deterministic
        )
        table.attrs["notes"] = "\n".join(filter(None, (PSEUDO, table.attrs["notes"])))
        return table


def _scale(errors: Array) -> float:
    """Robust standard deviation of errors (n,)."""
    return float(np.median(np.abs(errors))) / NORMAL_MEDIAN
