"""What the error of a surrogate makes of a probability of failure.

Functions that are as plausible as its mean fail with other probabilities. Where the joint law of
the errors at several points is known (Gaussian process), functions are drawn at points u_i of the
region m - 3 s <= 0, in which nearly all of them fail, found by subset simulation; with q the
probability of the region, a drawn function Y fails with probability q mean_i [Y(u_i) <= 0]. The
quantiles of its ratio to the mean's own share among the same points scale the estimate.

Elsewhere the errors at all points are taken as one: the ends are the probabilities with which
the lower and the upper end of the surrogate's interval fail. That is wider.
"""

from __future__ import annotations

from functools import partial

import numpy as np
from numpy.typing import NDArray
from scipy import linalg

from surrogate.estimator import HasJoint, has_joint
from surrogate.fitting.fit import Fit
from surrogate.reliability.estimate import Interval
from surrogate.reliability.limit_state import coded_of, state_of
from surrogate.reliability.problem import Failure
from surrogate.reliability.sampling import sampled
from surrogate.reliability.subset import population
from surrogate.space.space import Space

Array = NDArray[np.float64]

#: Points of a level of the search for the region, and how far out it reaches, in deviations.
POINTS, FAR = 2000, 3.0
#: Points at which functions are drawn, draws, and failing points that they need.
JOINT, DRAWS, ENOUGH = 800, 400, 10


def of_draws(
    problem: Failure, space: Space, fit: Fit, *, seed: int = 0, confidence: float = 0.95
) -> Interval | None:
    """Factors on the probability, (at most 1, at least 1); None where draws cannot tell.

    They cannot without a joint law, and where the region is too large beside the event.
    """
    if space.region is not None or not has_joint(fit.estimator) or not fit.offers_std:
        return None
    region = state_of(problem, space, partial(_worse, problem, fit))
    inside = population(region, samples=POINTS, seed=seed).failing
    if len(inside) < ENOUGH:
        return None
    rng = np.random.default_rng(seed)
    X = coded_of(space, inside[rng.permutation(len(inside))[:JOINT]])
    mean, drawn = _drawn(fit.estimator, X, rng)
    own = int((problem.margin(mean) <= 0.0).sum())
    if own < ENOUGH:
        return None
    shares = (problem.margin(drawn) <= 0.0).sum(axis=1) / own
    tail = 0.5 * (1.0 - confidence)
    low, high = np.quantile(shares, [tail, 1.0 - tail])
    return min(float(low), 1.0), max(float(high), 1.0)


def _worse(problem: Failure, fit: Fit, X: Array) -> Array:
    """The prediction moved towards failure by `FAR` deviations."""
    mean, std = fit.predict(X, return_std=True)
    return np.asarray(mean + problem.sign * FAR * std)


def _drawn(estimator: HasJoint, X: Array, rng: np.random.Generator) -> tuple[Array, Array]:
    """Means (n,) and drawn functions (draws, n) at coded points, by the law of the errors."""
    (mean,), (covariance,) = estimator.predict_joint(X[None])
    scale, vectors = linalg.eigh(covariance)
    root = vectors * np.sqrt(np.maximum(scale, 0.0))
    errors = rng.standard_normal((DRAWS, len(mean))) @ root.T
    freedom = getattr(estimator, "interval_freedom", None)
    if freedom:
        errors *= np.sqrt(freedom / rng.chisquare(freedom, size=(DRAWS, 1)))
    return mean, mean + errors


def of_ends(
    problem: Failure,
    space: Space,
    fit: Fit,
    method: str,
    *,
    seed: int = 0,
    confidence: float = 0.95,
) -> Interval:
    """Probabilities with which the safer and the worse end of the interval fail."""
    low, high = (
        sampled(
            method, problem, space, partial(_end, problem, fit, away, confidence), seed=seed
        ).probability
        for away in (-1, 1)
    )
    return low, high


def _end(problem: Failure, fit: Fit, away: int, confidence: float, X: Array) -> Array:
    """The safer (-1) or the worse (1) end of the surrogate's interval at coded points."""
    mean, (half,) = fit.half_widths(X, (confidence,))
    return np.asarray(mean + away * problem.sign * half)
