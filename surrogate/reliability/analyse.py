"""The probability of failure of a surrogate, with both parts of its interval."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from surrogate.fitting.fit import Fit
from surrogate.reliability import doubt
from surrogate.reliability.estimate import Estimate, Interval, Population
from surrogate.reliability.form import Form, form
from surrogate.reliability.importance import importance
from surrogate.reliability.limit_state import coded_of, state_of
from surrogate.reliability.problem import Failure
from surrogate.reliability.sampling import fitting_method, sampled
from surrogate.reliability.solution import DesignPoint, Reliability
from surrogate.reliability.subset import population
from surrogate.space.space import Space

Array = NDArray[np.float64]

#: Points of a level of the population that draws the tail and starts the search of FORM.
POINTS = 4000
#: Places of the curve down to the tail, points beyond the last one, and how near to 1 it goes.
PLACES, FEWEST, FREQUENT = 50, 10, 0.01


def analyse(
    problem: Failure, space: Space, fit: Fit, *, seed: int = 0, confidence: float = 0.95
) -> Reliability:
    """The answer to one problem by the fit of its output."""
    method = fitting_method(problem, space, fit.predict, seed)
    one = sampled(method, problem, space, fit.predict, seed=seed, confidence=confidence)
    points = _population(problem, space, fit, seed)
    tangent = _tangent(problem, space, fit, points)
    if problem.method == "importance" and tangent is not None:
        state = state_of(problem, space, fit.predict)
        one = importance(state, tangent.design_point, seed=seed, confidence=confidence)
    error, how = _error(problem, space, fit, one, method, seed, confidence)
    low, high = _together(one, error)
    return Reliability(
        problem,
        fit.surrogate,
        one,
        low,
        high,
        error,
        how,
        None if tangent is None else _described(space, tangent),
        *_tail(problem, points),
    )


def _population(problem: Failure, space: Space, fit: Fit, seed: int) -> Population:
    """Weighted points from far to near the limit; with constraints, of the law itself."""
    if space.region is None:
        return population(state_of(problem, space, fit.predict), samples=POINTS, seed=seed)
    X = space.sample(POINTS, seed=seed)
    g = problem.margin(fit.predict(X))
    return Population(X, np.full(POINTS, 1.0 / POINTS), g)


def _tangent(problem: Failure, space: Space, fit: Fit, points: Population) -> Form | None:
    """The design point, where all parameters are continuous and nothing constrains them."""
    if space.region is not None or not all(one.continuous for one in space.parameters):
        return None
    found = form(state_of(problem, space, fit.predict), points.failing)
    return found if found.found else None


def _described(space: Space, found: Form) -> DesignPoint:
    columns = space.decode(coded_of(space, found.design_point[None]))
    return DesignPoint(
        found.beta,
        found.probability,
        {name: float(column[0]) for name, column in columns.items()},
        dict(zip(space.names, found.importance.tolist(), strict=True)),
    )


def _error(
    problem: Failure,
    space: Space,
    fit: Fit,
    one: Estimate,
    method: str,
    seed: int,
    confidence: float,
) -> tuple[Interval, str]:
    """The interval of the surrogate's error alone, and how it was found."""
    p = one.probability
    if p > 0.0:
        factors = doubt.of_draws(problem, space, fit, seed=seed, confidence=confidence)
        if factors is not None:
            return (p * factors[0], min(p * factors[1], 1.0)), "posterior draws"
    low, high = doubt.of_ends(problem, space, fit, method, seed=seed, confidence=confidence)
    return (min(p, low), max(p, high)), "ends of the surrogate's interval"


def _together(one: Estimate, error: Interval) -> Interval:
    """Both parts as independent errors of log p; plainly the outer ends where p is 0."""
    p = one.probability
    if not p > 0.0:
        return 0.0, max(one.high, error[1])
    lows = [np.log(p / low) if low > 0.0 else np.inf for low in (one.low, error[0])]
    highs = np.log([one.high / p, error[1] / p])
    below, above = np.linalg.norm(lows), np.linalg.norm(highs)
    return float(p * np.exp(-below)), float(min(p * np.exp(above), 1.0))


def _tail(problem: Failure, points: Population) -> tuple[Array, Array]:
    """Values of the output, and the probability of passing each: the weights beyond it."""
    order = np.argsort(points.g, kind="stable")
    beyond = np.cumsum(points.weight[order])
    rare = np.geomspace(beyond[min(FEWEST, len(order)) - 1], 0.5, PLACES)
    wanted = np.concatenate([rare, 1.0 - rare[::-1][rare[::-1] > FREQUENT]])
    places = np.unique(np.minimum(np.searchsorted(beyond, wanted), len(order) - 1))
    return problem.limit - problem.sign * points.g[order][places], beyond[places]
