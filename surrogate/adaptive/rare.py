"""Points that tell most of a probability, however rare the event is.

The region in which the event may lie, m - 2 s <= 0 with m and s of the process of the distance
to the limit, is found by subset simulation in standard normal space, so that its points follow
the law of the parameters there. Among them the next run is the one that takes most of the
targeted mean square error,

    sum_j w_j c(x, z_j)^2 / (s^2(x) + t^2),   w_j = phi(m_j / s_j) / s_j,

c being the covariance given the runs, t^2 the nugget's variance, z_j points of the region
(Picheny, Ginsbourger, Roustant, Haftka and Kim 2010, "Adaptive designs of experiments for
accurate approximation of a target region", J. Mechanical Design 132, 071008; sampling from the
region: Bect, Li and Vazquez 2017, "Bayesian subset simulation", SIAM/ASA JUQ 5, 762-786).

A process that is sure of itself too early (few runs, a kink, one of several regions seen) leaves
regions out, however far `UNSURE` reaches. So some runs do not ask it: each is the point farthest
from all runs in the ball of standard normal space outside of which lies a tenth of the probability
of the event, so that no region that counts lies beyond. They are those that follow on 1, 3, 6,
10, 15, .. runs: a share that falls but never ends.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray
from scipy import stats
from scipy.spatial import cKDTree

from surrogate.adaptive.aim import Aim, Review
from surrogate.adaptive.answers import Answers, process_for, processes
from surrogate.adaptive.expected_feasibility import UNSURE
from surrogate.adaptive.expected_improvement import density, positive
from surrogate.adaptive.variance import covariances
from surrogate.adaptive.worth import prediction
from surrogate.regressors.gaussian_process import GaussianProcess
from surrogate.reliability.limit_state import coded_of, state_of
from surrogate.reliability.problem import Failure
from surrogate.reliability.sampling import fitting_method, sampled
from surrogate.reliability.subset import population
from surrogate.space.space import Space

Array = NDArray[np.float64]

#: Points of a level of a review, of two repeats.
REVIEWED = 2000
#: Points of a level; of the region that are candidates, and that are told of.
POINTS, CANDIDATES, TOLD = 1000, 400, 400
#: Share of the event's probability that may lie beyond the ball that is explored, smallest
#: probability that it is reckoned with, and points among which one is chosen.
BEYOND, RAREST, EXPLORED = 0.1, 1e-10, 5000
#: Candidates nearer to a point so far, in the columns of the process, are that point.
APART = 1e-3


def review(aim: Aim, space: Space, answers: Answers) -> Review:
    """Lengths from the answers so far, the probability, and the share of the law that is unsure.

    That share is P(m - 2 s <= 0) - P(m + 2 s <= 0), each sampled as the probability itself.
    """
    (output,), ended = aim.outputs, int(answers.ended.sum())
    X, y = answers.known(output)
    try:
        (one,) = process_for(aim, space).fit_many(X, y[:, None])
    except ValueError:  # too few runs
        return Review(ended, np.nan, np.nan, {})
    found = Review(ended, np.nan, np.nan, {output: tuple(one.logs_.tolist())})
    if not np.ptp(y) > 0.0:
        return found
    (process,) = processes(aim, space, answers, found).values()
    safer, mean, worse = (
        _probability(aim, space, partial(_moved, aim, process, away)) for away in (-1.0, 0.0, 1.0)
    )
    return replace(found, figure=worse - safer, estimate=mean)


def _probability(aim: Aim, space: Space, predict: Callable[[Array], Array]) -> float:
    asked = _asked(aim)
    method = fitting_method(asked, space, predict)
    return sampled(method, asked, space, predict, level=REVIEWED, repeats=2).probability


def telling(aim: Aim, space: Space, process: GaussianProcess, answers: Answers, seed: int) -> Array:
    """The coded point (1, d) that tells most of the probability; (0, d) when all are done."""
    rng = np.random.default_rng(seed)
    hopeful = state_of(_asked(aim), space, partial(_moved, aim, process, 1.0))
    found = population(hopeful, samples=POINTS, seed=seed)
    inside = found.failing if len(found.failing) else found.u[-POINTS:]
    points = np.unique(coded_of(space, inside), axis=0)
    told = points[rng.permutation(len(points))[:TOLD]]
    X = _apart(process, points[rng.permutation(len(points))], answers)[:CANDIDATES]
    if not len(X):
        return X
    mean, deviation = prediction(process, told)
    s = positive(deviation)
    weights = density((mean - aim.value) / s) / s
    _, own = process.predict(X, return_std=True)
    worth = covariances(process, X, told) ** 2 @ weights / own**2
    best = int(np.argmax(worth))
    return X[best : best + 1]


def explores(runs: int) -> bool:
    """Whether the next run explores: after n (n + 1) / 2 runs."""
    return math.isqrt(8 * runs + 1) ** 2 == 8 * runs + 1


def exploring(
    space: Space, process: GaussianProcess, answers: Answers, probability: float, seed: int
) -> Array:
    """The coded point (1, d) that is farthest from all runs; (0, d) when all are done.

    probability  of the event, as far as it is known
    """
    rng = np.random.default_rng(seed)
    ball = stats.chi2.isf(BEYOND * max(RAREST, probability), space.size) ** 0.5
    u = rng.standard_normal((EXPLORED, space.size))
    u *= ball * rng.random((EXPLORED, 1)) ** (1.0 / space.size) / np.linalg.norm(u, axis=1)[:, None]
    X = _apart(process, coded_of(space, u), answers)
    if not len(X):
        return X
    distance, _ = cKDTree(process.expanded(answers.coded)).query(process.expanded(X))
    best = int(np.argmax(distance))
    return X[best : best + 1]


def _asked(aim: Aim) -> Failure:
    return Failure("aim", aim.outputs[0], aim.value, aim.sign)


def _moved(aim: Aim, process: GaussianProcess, away: float, X: Array) -> Array:
    """The prediction moved towards the event: by 1, as far as leaves a side unsure."""
    if away == 0.0:
        return np.asarray(process.predict(X))
    mean, deviation = prediction(process, X)
    return np.asarray(mean + aim.sign * away * UNSURE * deviation)


def _apart(process: GaussianProcess, points: Array, answers: Answers) -> Array:
    """Those points that are apart from all so far and not next to a failed one."""
    distance, nearest = cKDTree(process.expanded(answers.coded)).query(process.expanded(points))
    return np.asarray(points[(distance > APART) & ~answers.failed[nearest]])
