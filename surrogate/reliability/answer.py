"""The probability that an output passes a limit, by its surrogate, and both parts of its error.

Sampling: the interval of subset simulation on the fitted surrogate. Surrogate: the probability
of each of several surrogates that the runs allow (`surrogate.sensitivity.draws`), all on the
same weighted points, relative to that of the fitted one; its quantiles are the interval. Both are
ratios to the probability, taken as independent, so that they add in squares on its logarithm:

    log(end / P) = -+ sqrt(log^2(end of sampling / P) + log^2(end of surrogate / P)).
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from surrogate.estimator import Predictor, has_draws
from surrogate.fitting.fit import Fit
from surrogate.reliability.estimate import Estimate, Population
from surrogate.reliability.form import Form, form
from surrogate.reliability.importance import importance
from surrogate.reliability.limit_state import coded_of, limit_state
from surrogate.reliability.subset import population, subset
from surrogate.sensitivity.draws import refits
from surrogate.sensitivity.model import Learnt

Array = NDArray[np.float64]

#: Draws of the surrogate, and points a level of the population that they are compared on.
DRAWS, POINTS = 50, 4_000


@dataclass(frozen=True)
class Reliability:
    """What the surrogate says of a failure.

    sampling   by subset simulation on the surrogate, with the interval of its sampling
    surrogate  ends of the interval for the surrogate's error; NaN where it has no draws
    how        the kind of draws, in words
    tangent    FORM, with the design point
    checks     other methods, to compare
    """

    sampling: Estimate
    surrogate: tuple[float, float]
    how: str
    tangent: Form
    checks: tuple[Estimate, ...]

    @property
    def probability(self) -> float:
        """Of failure."""
        return self.sampling.probability

    @property
    def interval(self) -> tuple[float, float]:
        """Ends of the interval for sampling and surrogate together."""
        ends = ((self.sampling.low, self.surrogate[0]), (self.sampling.high, self.surrogate[1]))
        return _joined(self.probability, *ends[0]), _joined(self.probability, *ends[1])


def _joined(centre: float, sampled: float, drawn: float) -> float:
    """One end: distances from the centre added in squares on the logarithm."""
    if centre <= 0.0 or min(sampled, drawn) <= 0.0:
        return min(sampled, drawn) if centre > 0.0 else max(sampled, drawn)
    size = float(np.hypot(np.log(sampled / centre), np.log(drawn / centre)))
    return min(1.0, centre * float(np.exp(size if sampled > centre else -size)))


def reliability(
    fit: Fit, limit: float, *, above: bool = True, confidence: float = 0.95, seed: int = 0
) -> Reliability:
    """The probability that the fit's output is above (or below) the limit.

    Raises `StudyError` for a space with constraints.
    """
    state = limit_state(fit, fit.space, limit, above=above)
    sampling = subset(state, confidence=confidence, seed=seed)
    tangent = form(state)
    checks = [tangent.estimate]
    if tangent.found:
        checks.append(importance(state, tangent.design_point, confidence=confidence, seed=seed))
    points = population(state, samples=POINTS, seed=seed)
    drawn, how = _drawn(fit, seed)
    sign = 1.0 if above else -1.0
    coded = coded_of(fit.space, points.u)
    fitted = points.probability(sign * (limit - fit.predict(coded)) <= 0.0)
    found = _probabilities(drawn, points, coded, sign, limit)
    ends = (np.nan, np.nan)
    if len(found) > 1 and fitted > 0.0:
        low, high = np.quantile(found, [0.5 - confidence / 2.0, 0.5 + confidence / 2.0])
        ratio = sampling.probability / fitted
        ends = (min(low, fitted) * ratio, max(high, fitted) * ratio)
    return Reliability(sampling, (float(ends[0]), float(ends[1])), how, tangent, tuple(checks))


def _drawn(fit: Fit, seed: int) -> tuple[Iterable[Predictor], str]:
    """Surrogates that the runs allow, and how they were drawn."""
    if has_draws(fit.estimator):
        return fit.estimator.posterior_draws(DRAWS, seed=seed), "posterior draws"
    return refits(Learnt(fit.estimator, fit.coded, fit.values), DRAWS, seed)


def _probabilities(
    drawn: Iterable[Predictor], points: Population, coded: Array, sign: float, limit: float
) -> Array:
    """The probability of each drawn surrogate on the same points."""
    return np.array(
        [points.probability(sign * (limit - one.predict(coded)) <= 0.0) for one in drawn]
    )
