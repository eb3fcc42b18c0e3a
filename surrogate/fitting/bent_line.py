"""A line through medians that may bend, fitted by Bayes' rule.

    y = m + e,   e ~ N(0, C + t^2 I),   m = X beta,   beta ~ N(mean, diag(sd^2))

with C the covariance of the medians, and t how far a curve strays from such a line: unknown, log
uniform on `STRAYS`. Given t the posterior is that of linear regression with a normal prior
(Gelman et al. 2013, section 14.8); t is summed over its values by their marginal likelihoods.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: Standard deviations t of the logarithm of an error about the line.
STRAYS = np.geomspace(0.03, 1.0, 12)
#: Standard deviation of the level's prior: nothing is known of it.
WIDE = 30.0


@dataclass(frozen=True)
class Prior:
    """Means and standard deviations of the coefficients but the level."""

    mean: tuple[float, ...]
    sd: tuple[float, ...]


def bent_line(
    columns: Array, y: Array, covariance: Array, prior: Prior, draws: int, rng: np.random.Generator
) -> tuple[Array, Array]:
    """Posterior means (k,) and draws (draw, k) of the level and the coefficients of columns.

    columns (n, k - 1), y (n,), covariance (n, n). The level of a draw strays as a new median would.
    """
    X = np.column_stack([np.ones(len(y)), columns])
    mean, sd = np.array([y[-1], *prior.mean]), np.array([WIDE, *prior.sd])
    found = [_given(X, y - X @ mean, covariance + t**2 * np.eye(len(y)), sd) for t in STRAYS]
    evidence = np.array([one[2] for one in found])
    weights = np.exp(evidence - evidence.max())
    weights /= weights.sum()
    chosen = rng.choice(len(STRAYS), draws, p=weights)
    drawn = np.array(
        [mean + found[k][0] + found[k][1] @ rng.standard_normal(len(mean)) for k in chosen]
    )
    drawn[:, 0] += STRAYS[chosen] * rng.standard_normal(draws)
    return mean + sum(w * one[0] for w, one in zip(weights, found, strict=True)), drawn


def _given(X: Array, residual: Array, covariance: Array, sd: Array) -> tuple[Array, Array, float]:
    """Shift of the mean, root of the covariance and log evidence, given the covariance of y."""
    precision = X.T @ np.linalg.solve(covariance, X) + np.diag(sd**-2.0)
    inverse = np.linalg.inv(precision)
    shift = inverse @ (X.T @ np.linalg.solve(covariance, residual))
    return shift, np.linalg.cholesky(inverse), log_evidence(X, residual, covariance, sd)


def log_evidence(X: Array, residual: Array, covariance: Array, sd: Array) -> float:
    """Log marginal likelihood, up to a constant.

    residual (n,) y - X mean, covariance (n, n) of y about the line, sd (k,) of the prior
    """
    marginal = covariance + X @ np.diag(sd**2) @ X.T
    loss = float(residual @ np.linalg.solve(marginal, residual))
    return -0.5 * (float(np.linalg.slogdet(marginal)[1]) + loss)
