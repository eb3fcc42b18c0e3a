"""A law through a learning curve, and what it says of more runs.

With x = log(n / N) for N runs that there are,

    log error(n) = log a - b x - q x^2                     surrogates of any form
    error(n) = a (n / N)^-b + c,            c > 0          the same, where a floor is seen
    error(n) = a ((n - 1) / (n - 1 - p))^(b / 2)           least squares of p given terms

The first is a power law that bends: errors of Gaussian processes and of sparse polynomials fall
slowly with few runs, then faster (q > 0). It goes on straight from twice the runs on, and where
it would turn up it levels out. The prior of b and q comes from the curves of eighteen published
functions, `ANY_FORM`; it has little weight where the curve is clear (`bent_line`). The floor is
taken where a power law with it betters the fit by more than the scatter of the medians (weights
rise as n^2, because the largest subsets tell most of still larger ones; Figueroa et al. 2012, doi
10.1186/1472-6947-12-8, have them rise as n). The third is the error of least squares whose terms,
the constant one of them, leave something out, b = 1 for normal inputs (Breiman and Freedman 1983,
doi 10.1080/01621459.1983.10477941): it stops falling.

Intervals come from draws. Each median is an average over subsets of n of the N runs, of which no
more than n / N of the variance v of one such design remains (Hoeffding 1948, doi
10.1214/aoms/1177730196, theorem 5.2), and v over the number of subsets of what they scatter.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from surrogate.fitting.bent_line import Prior, bent_line

Array = NDArray[np.float64]

#: Slope and bend, empirical Bayes by the largest marginal likelihood of
#: the curves of Gaussian processes and polynomial chaos: `benchmarks/learning_prior.py`.
ANY_FORM = Prior((-1.85, -0.14), (1.0, 0.2))
#: Slope of least squares of given terms: that of Breiman and Freedman, more or less.
GIVEN_TERMS = Prior((-1.0,), (0.5,))
#: The bend ends here: at twice the runs.
STRAIGHT = float(np.log(2.0))
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
    """A law and draws of it: rows of log a, b, q and c, (4,) and (draw, 4).

    whole  runs that there are, N
    terms  p of least squares, 0 for surrogates of any form
    """

    best: Array
    draws: Array
    whole: int
    terms: int = 0

    @property
    def exponent(self) -> float:
        """b: how steeply the error falls at the runs that there are."""
        return float(self.best[1])

    @property
    def bend(self) -> float:
        """q: above 0 where the error falls faster and faster."""
        return float(self.best[2])

    @property
    def floor(self) -> float:
        """c."""
        return float(self.best[3])

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
        log_a, b, q, c = laws.T
        x = self._place(runs)
        lowest = np.where(q < 0.0, -b / np.where(q < 0.0, 2.0 * q, 1.0), np.inf)
        lowest = np.where(lowest < STRAIGHT, lowest, np.inf)
        x = np.minimum(x, np.maximum(np.where(b > 0.0, lowest, 0.0), 0.0))
        bent = np.minimum(x, STRAIGHT)
        return np.asarray(np.exp(log_a - b * x - q * bent * (2.0 * x - bent)) + c)

    def _runs(self, laws: Array, error: float) -> Array:
        log_a, b, q, c = laws.T
        able = (error > c) & (b > 0.0)
        drop = np.where(able, log_a - np.log(np.where(able, error - c, 1.0)), 0.0)
        square = b**2 + 4.0 * q * drop  # of b x + q x^2 = drop
        x = 2.0 * drop / (np.where(able, b, 1.0) + np.sqrt(np.maximum(square, 0.0)))
        slope = b + 2.0 * q * STRAIGHT
        beyond = (square < 0.0) | (x > STRAIGHT)
        able &= (drop < 0.0) | ~beyond | (slope > 0.0)
        straight = (drop + q * STRAIGHT**2) / np.where(slope > 0.0, slope, 1.0)
        x = np.where(beyond & (drop > 0.0), straight, x) + abscissa(self.whole, self.terms)
        with np.errstate(over="ignore"):
            if not self.terms:
                return np.where(able, np.exp(x), np.inf)
            share = np.exp(2.0 * x)  # (n - 1 - p) / (n - 1)
        able &= share < 1.0
        return np.where(able, 1.0 + self.terms / np.where(able, 1.0 - share, 1.0), np.inf)

    def _place(self, runs: float) -> Array:
        return abscissa(runs, self.terms) - abscissa(self.whole, self.terms)


def abscissa(runs: Array | float, terms: int = 0) -> Array:
    """Where runs stand, so that the logarithm of an error without bend and floor is a line."""
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
    medians, covariance = np.nanmedian(logs, axis=0), covariance_of_medians(n, logs, whole)
    rng = np.random.default_rng(seed)
    if not terms and _gain(n, medians) > NEEDED * covariance[0, 0]:
        drawn = rng.multivariate_normal(medians, covariance, size=DRAWS, method="cholesky")
        found = np.vstack([_curved(n / whole, one)[0] for one in (medians, *drawn)])
        return PowerLaw(found[0], found[1:], whole)
    x = abscissa(n, terms) - abscissa(whole, terms)
    columns = x[:, None] if terms else np.column_stack([x, x**2])
    prior = GIVEN_TERMS if terms else ANY_FORM
    best, draws = bent_line(columns, medians, covariance, prior, DRAWS, rng)
    return PowerLaw(_rows(best[None])[0], _rows(draws), whole, terms)


def _rows(found: Array) -> Array:
    """log a, b, q and c of levels and coefficients (m, 2 or 3)."""
    rows = np.zeros((len(found), 4))
    rows[:, 0], rows[:, 1 : found.shape[1]] = found[:, 0], -found[:, 1:]
    return rows


def covariance_of_medians(n: Array, logs: Array, whole: int) -> Array:
    """Covariance (k, k) of the medians of logs (subset, k) at n (k,) of `whole` runs.

    v is the median variance of the sizes up to half of the runs.
    """
    small = n <= max(0.5 * whole, n[0])
    variance = max(float(np.median(np.nanvar(logs[:, small], axis=0, ddof=1))), SCATTER**2)
    alone = 1.0 / len(logs)
    shared = (1.0 - alone) * np.minimum.outer(n, n) / whole
    return np.asarray(variance * (shared + alone * np.eye(len(n))))


def _weights(n: Array) -> Array:
    return np.asarray(n**2 / (n**2).sum())


def _curved(n: Array, logs: Array) -> tuple[Array, float]:
    """log a, b, q = 0 and c of the best of all exponents and floors, (4,), and its loss.

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
    return np.array([log_a[i, j], EXPONENTS[i], 0.0, c[j, 0]]), float(loss[i, j])


def _gain(n: Array, logs: Array) -> float:
    """How much a floor lowers the mean squared error of the logarithms about a line."""
    weights, x = _weights(n), np.log(n)
    about, level = x - weights @ x, weights @ logs
    slope = (weights * about) @ logs / ((weights * about) @ about)
    line = ((level + slope * about - logs) ** 2) @ weights
    return float(line) - _curved(n, logs)[1]


def _with_ends(value: Array, draws: Array) -> tuple[float, float, float]:
    low, high = np.quantile(draws, ENDS, method="inverted_cdf")  # an end may be infinite
    return float(value), float(low), float(high)
