"""A law through a learning curve, and what it says of more runs.

    error(n) = a n^-b + c,                        c >= 0     surrogates of any form
    error(n) = a ((n - 1) / (n - 1 - p))^(b / 2)             least squares of p given terms

The second is the error of least squares whose terms, the constant one of them, leave something
out, b = 1 for normal inputs (Breiman and Freedman 1983, doi
10.1080/01621459.1983.10477941): it stops falling at a.
Both are fitted to the medians of the subsets by weighted least squares of the logarithm. Weights
rise as n^2, because the largest subsets tell most of still larger ones (Figueroa et al. 2012, doi
10.1186/1472-6947-12-8, have them rise as n). The floor c is kept where it betters the fit
by more than the scatter of the medians; else c = 0, a straight line in logarithms.

Intervals come from draws of the medians. Each is an average over subsets of n of the N runs, of
which no more than n / N of the variance v of one such design remains (Hoeffding 1948, doi
10.1214/aoms/1177730196, theorem 5.2), and v over the number of subsets of what they scatter.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: Exponents b, and floors c as a share of the smallest error, that are tried.
EXPONENTS, FLOORS = np.linspace(0.0, 6.0, 121), np.linspace(0.0, 0.98, 50)
#: The floor is kept where it lowers the squared errors, in variances of a median, by this.
NEEDED = 4.0
#: Draws behind an interval, and its ends.
DRAWS, ENDS = 400, (0.05, 0.95)
#: Scatter of the logarithm of an error between designs, at least.
SCATTER = 0.02


@dataclass(frozen=True, eq=False)
class PowerLaw:
    """A law and draws of it: rows of log a, b and c, (3,) and (draw, 3).

    terms  p of least squares, 0 for surrogates of any form
    """

    best: Array
    draws: Array
    terms: int = 0

    @property
    def exponent(self) -> float:
        """b."""
        return float(self.best[1])

    @property
    def falls(self) -> bool:
        """True when the error surely falls: 95 % of the draws do."""
        return bool(np.quantile(self.draws[:, 1], ENDS[0]) > 0.0)

    def at(self, runs: float) -> tuple[float, float, float]:
        """Error at so many runs, with the ends of its 90 % interval."""
        return _with_ends(self._error(self.best, runs), self._error(self.draws, runs))

    def needed(self, error: float) -> tuple[float, float, float]:
        """Runs that bring the error down to this, with the ends of their 90 % interval.

        Infinite where the error never comes down so far.
        """
        return _with_ends(self._runs(self.best, error), self._runs(self.draws, error))

    def _error(self, laws: Array, runs: float) -> Array:
        log_a, b, c = laws.T
        return np.asarray(np.exp(log_a - b * abscissa(np.array(runs, float), self.terms)) + c)

    def _runs(self, laws: Array, error: float) -> Array:
        log_a, b, c = laws.T
        able = (error > c) & (b > 0.0)
        x = (log_a - np.log(np.where(able, error - c, 1.0))) / np.where(able, b, 1.0)
        with np.errstate(over="ignore"):
            if not self.terms:
                return np.where(able, np.exp(x), np.inf)
            share = np.exp(2.0 * x)  # (n - 1 - p) / (n - 1)
        able &= share < 1.0
        return np.where(able, 1.0 + self.terms / np.where(able, 1.0 - share, 1.0), np.inf)


def abscissa(runs: Array, terms: int = 0) -> Array:
    """Where runs (k,) stand, so that the logarithm of an error without a floor is a line."""
    n = np.asarray(runs, dtype=float)
    return np.asarray(0.5 * np.log((n - 1.0 - terms) / (n - 1.0)) if terms else np.log(n))


def power_law(
    runs: NDArray[np.intp], errors: Array, whole: int, *, terms: int = 0, seed: int = 0
) -> PowerLaw:
    """The law of errors (subset, k) of subsets of runs (k,) out of `whole`.

    Sizes of which less than half of the subsets have an error are left aside. Raises
    `ValueError` when fewer than three sizes are left.
    """
    logs = np.log(np.where(errors > 0.0, errors, np.nan))
    known = np.isfinite(logs)
    enough = (known.mean(axis=0) >= 0.5) | (known.any(axis=0) & (runs == whole))
    enough &= runs > terms + 1
    if enough.sum() < 3:
        raise ValueError("fewer than three sizes could be fitted")
    n, logs = np.asarray(runs, dtype=float)[enough], logs[:, enough]
    medians, covariance = np.nanmedian(logs, axis=0), _covariance(n, logs, whole)
    rng = np.random.default_rng(seed)
    drawn = rng.multivariate_normal(medians, covariance, size=DRAWS, method="cholesky")
    every = np.vstack([medians, drawn])
    found = _lines(n, every, terms)
    if not terms and _gain(n, medians) > NEEDED * covariance[0, 0]:
        found = np.vstack([_curved(n, one)[0] for one in every])
    return PowerLaw(found[0], found[1:], terms)


def _covariance(n: Array, logs: Array, whole: int) -> Array:
    """Of the medians (k, k), for v the median variance of the sizes up to half of the runs."""
    small = n <= max(0.5 * whole, n[0])
    variance = max(float(np.median(np.nanvar(logs[:, small], axis=0, ddof=1))), SCATTER**2)
    alone = 1.0 / len(logs)
    shared = (1.0 - alone) * np.minimum.outer(n, n) / whole
    return np.asarray(variance * (shared + alone * np.eye(len(n))))


def _weights(n: Array) -> Array:
    return np.asarray(n**2 / (n**2).sum())


def _lines(n: Array, logs: Array, terms: int) -> Array:
    """log a, b and c = 0 of each row of logs (m, k), by their closed form, (m, 3)."""
    weights, x = _weights(n), abscissa(n, terms)
    middle = weights @ x
    b = -(logs @ (weights * (x - middle))) / (weights @ (x - middle) ** 2)
    return np.column_stack([logs @ weights + b * middle, b, np.zeros(len(logs))])


def _curved(n: Array, logs: Array) -> tuple[Array, float]:
    """log a, b and c of the best of all exponents and floors, (3,), and its mean squared error.

    log a is that of least squares of log(error - c), with the weights of log(error).
    """
    errors, weights, x = np.exp(logs), _weights(n), np.log(n)
    c = FLOORS[:, None] * errors.min()
    own = weights * ((errors - c) / errors) ** 2  # (floor, k)
    own /= own.sum(axis=1, keepdims=True)
    log_a = (own * np.log(errors - c)).sum(axis=1) + EXPONENTS[:, None] * (own @ x)
    power = np.exp(log_a[..., None] - EXPONENTS[:, None, None] * x)  # (exponent, floor, k)
    loss = (np.log(power + c) - logs) ** 2 @ weights
    i, j = np.unravel_index(int(loss.argmin()), loss.shape)
    return np.array([log_a[i, j], EXPONENTS[i], c[j, 0]]), float(loss[i, j])


def _gain(n: Array, logs: Array) -> float:
    """How much a floor lowers the mean squared error of the logarithms."""
    log_a, b, _ = _lines(n, logs[None], 0)[0]
    line = ((log_a - b * np.log(n) - logs) ** 2) @ _weights(n)
    return float(line) - _curved(n, logs)[1]


def _with_ends(value: Array, draws: Array) -> tuple[float, float, float]:
    low, high = np.quantile(draws, ENDS, method="inverted_cdf")  # an end may be infinite
    return float(value), float(low), float(high)
