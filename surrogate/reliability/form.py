"""FORM: the limit state replaced by its tangent at the design point.

The design point u* is the point of g(u) = 0 nearest to the origin, beta = |u*| (negative where
the origin fails), and the probability Phi(-beta) (Hasofer and Lind 1974; Ditlevsen and Madsen,
Structural Reliability Methods, 2007, chapter 5). alpha = -u*/beta for beta > 0 points from
the design point to the origin; alpha^2 is each variable's importance.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import optimize
from scipy.special import ndtr

from surrogate.reliability.estimate import Estimate
from surrogate.reliability.limit_state import LimitState

Array = NDArray[np.float64]

#: Half-width of central differences, in standard deviations.
STEP = 1e-4
#: Starts besides the origin, their distance from it, and the seed of their directions.
STARTS, DISTANCE, SEED = 4, 2.0, 0
#: Directions of a larger cosine are one; searches stay within so many deviations.
ALIKE, FARTHEST = 0.8, 8.0
#: How near g = 0 must be reached, as a share of |g| at the origin or its spread.
REACHED = 1e-4


@dataclass(frozen=True)
class Form:
    """The design point (d,) and its index; `found` is False when no point of g = 0 was reached."""

    design_point: Array
    beta: float
    evaluations: int
    found: bool

    @property
    def probability(self) -> float:
        """Phi(-beta); NaN where no design point was found."""
        return float(ndtr(-self.beta))

    @property
    def importance(self) -> Array:
        """alpha^2 (d,), sums to 1."""
        length = float(self.design_point @ self.design_point)
        return self.design_point**2 / length if length > 0.0 else self.design_point

    @property
    def estimate(self) -> Estimate:
        """The same beside other methods; the error of the tangent has no interval."""
        return Estimate("form", self.probability, np.nan, np.nan, self.evaluations)


def form(state: LimitState, failing: Array | None = None) -> Form:
    """The design point, by sequential quadratic programming from several starts.

    failing  (k, d) points that fail, if some are known: the likeliest ones in different
             directions are starts too
    """
    directions = np.random.default_rng(SEED).standard_normal((STARTS, state.size))
    directions *= DISTANCE / np.linalg.norm(directions, axis=1, keepdims=True)
    starts = np.vstack([np.zeros(state.size), directions, *_likeliest(failing)])
    values = state.g(starts)
    count = len(starts)
    scale = max(float(np.abs(values).max()), np.finfo(float).tiny)
    shifts = STEP * np.eye(state.size)

    def g(u: Array) -> Array:
        nonlocal count
        count += 1
        return state.g(_near(u)[None, :]) / scale

    def gradient(u: Array) -> Array:
        nonlocal count
        count += 2 * state.size
        ends = state.g(np.vstack([_near(u) + shifts, _near(u) - shifts])).reshape(2, -1)
        return np.asarray((ends[0] - ends[1]) / (2.0 * STEP * scale))

    best: Array | None = None
    for start in starts:
        found = optimize.minimize(
            _half_square,
            start,
            jac=_itself,
            method="SLSQP",
            constraints=optimize.NonlinearConstraint(g, 0.0, 0.0, jac=gradient),
            options={"maxiter": 100, "ftol": 1e-10},
        ).x
        if not np.isfinite(found).all() or float(np.abs(g(found)).max()) > REACHED:
            continue
        if best is None or found @ found < best @ best:
            best = found
    if best is None:
        return Form(np.full(state.size, np.nan), np.nan, count, False)
    sign = 1.0 if values[0] > 0.0 else -1.0
    return Form(best, sign * float(np.linalg.norm(best)), count, True)


def _likeliest(failing: Array | None) -> list[Array]:
    """Points of most density, each away in direction from those before; `STARTS` at most."""
    chosen = list[Array]()
    if failing is None:
        return chosen
    for u in failing[np.argsort((failing**2).sum(axis=1), kind="stable")]:
        if all(u @ one < ALIKE * np.linalg.norm(u) * np.linalg.norm(one) for one in chosen):
            chosen.append(u)
        if len(chosen) == STARTS:
            break
    return chosen


def _near(u: Array) -> Array:
    """The point, or the nearest within `FARTHEST`: a step along no gradient has no length."""
    return np.clip(np.nan_to_num(u), -FARTHEST, FARTHEST)


def _half_square(u: Array) -> float:
    return float(u @ u) / 2.0


def _itself(u: Array) -> Array:
    return u
