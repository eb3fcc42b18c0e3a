"""The product Matern 5/2 correlation and the posterior of its lengths.

    k(x, x') = prod_j m(|x_j - x'_j| / l_j),   m(r) = (1 + s + s^2 / 3) exp(-s),  s = sqrt(5) r

one length l_j for each column (Rasmussen and Williams 2006, equation 4.17; products of
it as in Roustant, Ginsbourger, Deville 2012, DiceKriging). A product, and not the
radial form, has exact Sobol' indices.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import linalg

ROOT5 = np.sqrt(5.0)
#: Median and spread of the log-normal prior of a length. Without one, a dozen runs often put
#: every length at its bound, and 95 % intervals then cover 50 to 75 % of new runs.
PRIOR_MEDIAN, PRIOR_SPREAD = 3.0, 1.5
#: Correlations evaluated at once: small enough to stay in the cache.
BLOCK = 200_000


def correlation(a: np.ndarray, b: np.ndarray, lengths: np.ndarray) -> np.ndarray:
    """Correlations (m, n) of points a (m, c) and b (n, c); lengths (c,)."""
    distance, product = np.zeros((len(a), len(b))), np.ones((len(a), len(b)))
    for j, length in enumerate(lengths):
        s = np.abs(np.subtract.outer(a[:, j], b[:, j]))
        s *= ROOT5 / length
        distance -= s
        s += s * s / 3.0
        s += 1.0
        product *= s
    np.exp(distance, out=distance)
    product *= distance
    return product


def weighted_sum(
    points: np.ndarray, centres: np.ndarray, lengths: np.ndarray, weights: np.ndarray
) -> np.ndarray:
    """sum_i weights[i] k(point, centre_i) at points (m, c), in blocks that fit the cache.

    weights (n,) or (n, draws); returns (m,) or (m, draws).
    """
    result = np.empty((len(points), *weights.shape[1:]))
    step = max(BLOCK // len(centres), 1)
    for start in range(0, len(points), step):
        part = slice(start, start + step)
        result[part] = correlation(points[part], centres, lengths) @ weights
    return result


@dataclass(frozen=True, eq=False)
class Conditioned:
    """Kriging algebra for fixed lengths and nugget; R = correlations + nugget I.

    factor     (n, n) lower Cholesky factor of R
    projected  (n, n) Q = R^-1 - R^-1 F (F' R^-1 F)^-1 F' R^-1, for trend columns F (n, q)
    weights    (n,) Q y;  trend (q,) generalised least squares coefficients
    gain       (q, q) (F' R^-1 F)^-1
    variance   y' Q y / (n - q), the process variance by restricted maximum likelihood
    deviance   -2 log restricted likelihood, up to a constant
    """

    factor: np.ndarray
    projected: np.ndarray
    weights: np.ndarray
    trend: np.ndarray
    gain: np.ndarray
    variance: float
    deviance: float


def condition(matrix: np.ndarray, F: np.ndarray, y: np.ndarray) -> Conditioned:
    """Condition on y (n,) with R = `matrix` (n, n) and trend columns F (n, q).

    Harville 1974 gives the restricted likelihood. Raises LinAlgError when R is not
    positive definite to rounding.
    """
    n, q = F.shape
    factor = linalg.cholesky(matrix, lower=True, check_finite=False)
    inverse = linalg.lapack.dpotri(factor, lower=1)[0]
    inverse += inverse.T  # the upper triangle was zero, so only the diagonal is doubled
    np.fill_diagonal(inverse, 0.5 * inverse.diagonal())
    solved = inverse @ F
    information = F.T @ solved
    gain = np.linalg.inv(information)
    projected = inverse - solved @ gain @ solved.T
    trend = gain @ (solved.T @ y)
    rest = y - F @ trend
    weights = linalg.cho_solve((factor, True), rest, check_finite=False)
    variance = max(float(rest @ weights) / (n - q), 1e-300)
    deviance = (
        (n - q) * np.log(variance)
        + 2.0 * np.log(np.diag(factor)).sum()
        + np.linalg.slogdet(information)[1]
    )
    return Conditioned(factor, projected, weights, trend, gain, variance, float(deviance))


class Posterior:
    """Restricted likelihood times prior, of log lengths (c,) and log nugget, with gradient.

    points (n, c); F (n, q) trend columns; y (n,). The prior of each log length is normal.
    """

    def __init__(self, points: np.ndarray, F: np.ndarray, y: np.ndarray):
        self.F, self.y = F, y
        first, second = np.triu_indices(len(points), 1)
        self.distances = np.ascontiguousarray(ROOT5 * np.abs(points[first] - points[second]).T)
        self.pairs = first * len(points) + second

    def __call__(self, logs: np.ndarray) -> tuple[float, np.ndarray]:
        """-2 log posterior and its gradient at (log lengths, log nugget), shape (c + 1,).

        With G = Q - Q y (Q y)' / variance the derivative along dR is sum G o dR.
        """
        nugget = np.exp(logs[-1])
        pairs, slopes = self._correlations(np.exp(logs[:-1]))
        try:
            state = condition(self._matrix(pairs, nugget), self.F, self.y)
        except linalg.LinAlgError:
            return 1e10, np.zeros_like(logs)
        z = (logs[:-1] - np.log(PRIOR_MEDIAN)) / PRIOR_SPREAD
        G = state.projected - np.outer(state.weights, state.weights) / state.variance
        along = 2.0 * G.take(self.pairs) * pairs
        gradient = np.append(slopes @ along + 2.0 * z / PRIOR_SPREAD, nugget * np.trace(G))
        return state.deviance + float(z @ z), gradient

    def _correlations(self, lengths: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Correlations of the pairs (P,) and d log correlation / d log length (c, P)."""
        pairs, slopes = np.exp(-(1.0 / lengths) @ self.distances), np.empty_like(self.distances)
        for distance, length, slope in zip(self.distances, lengths, slopes, strict=True):
            s = distance / length
            polynomial = s / 3.0
            polynomial += 1.0
            polynomial *= s
            polynomial += 1.0
            pairs *= polynomial
            np.add(s, 1.0, out=slope)
            slope *= s
            slope *= s
            slope /= polynomial
        return pairs, slopes / 3.0

    def _matrix(self, pairs: np.ndarray, nugget: float) -> np.ndarray:
        matrix = np.zeros((len(self.y), len(self.y)))
        matrix.ravel()[self.pairs] = pairs
        matrix += matrix.T
        np.fill_diagonal(matrix, 1.0 + nugget)
        return matrix
