"""Reviews of an adaptive design: how near the answers have come to its aim, and when it ends."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from surrogate.adaptive import rare
from surrogate.adaptive.aim import (
    ACCURACY,
    INDEX_WIDTH,
    OPTIMUM,
    PROBABILITY,
    Review,
    Rule,
)
from surrogate.adaptive.answers import Answers, processes
from surrogate.adaptive.candidates import candidates
from surrogate.adaptive.choose import worthiest
from surrogate.adaptive.costs import Costs, costs
from surrogate.adaptive.expected_feasibility import UNSURE, deviations_away
from surrogate.adaptive.worth import Worth, prediction
from surrogate.errors import FitError
from surrogate.estimator import Regressor
from surrogate.fitting.fit import Fit, fit, rmse
from surrogate.regressors.cokriging import CoKriging
from surrogate.regressors.gaussian_process import GaussianProcess
from surrogate.regressors.level_process import LevelRuns
from surrogate.sensitivity.sobol import sobol
from surrogate.space.space import Space

Array = NDArray[np.float64]

#: Runs from one review to the next: so many, and at least this share of those there are.
EVERY, SHARE = 5, 0.1
#: Points of the parameters' law at which a side is judged.
SAMPLES = 20_000
REACHED, USED_UP, SPENT, NO_IMPROVEMENT, NOTHING_LEFT = (
    "reached",
    "runs used up",
    "seconds spent",
    "no improvement",
    "nothing left",
)


def is_due(rule: Rule, reviews: Sequence[Review], ended: int) -> bool:
    """Whether it is time for a review, when so many runs of the design have ended."""
    if not reviews:
        return True
    last = reviews[-1].runs
    return ended >= min(last + max(EVERY, int(SHARE * last)), rule.until.most) and ended > last


def reason(rule: Rule, reviews: Sequence[Review], rows: int, closed: bool = False) -> str:
    """Why the design, with so many rows, takes no more points; "" while it does.

    closed: no allowed point is left
    """
    if closed:
        return NOTHING_LEFT
    if reviews and rule.until.reaches(reviews[-1].figure):
        return REACHED
    if rows >= rule.until.most:
        return USED_UP
    if reviews and reviews[-1].runs >= rows and not affords(rule, reviews[-1]):
        return SPENT
    if rule.until.patience is not None and _stalled(rule, reviews, rule.until.patience):
        return NO_IMPROVEMENT
    return ""


def affords(rule: Rule, found: Review | Costs) -> bool:
    """Whether the seconds that are left suffice for the cheapest further run."""
    return not found.spent + found.step > rule.until.budget


def _stalled(rule: Rule, reviews: Sequence[Review], patience: int) -> bool:
    """Whether no review of the last `patience` runs is better than all before."""
    known = [one for one in reviews if np.isfinite(one.figure)]
    if not known:
        return False
    best = known[0]
    for one in known[1:]:
        if rule.until.better(one.figure, best.figure):
            best = one
    return reviews[-1].runs - best.runs >= patience


def review(rule: Rule, space: Space, answers: Answers) -> Review:
    """Lengths from the answers so far, the aim's figure, and the seconds that were spent."""
    spent = costs(rule, answers)
    return replace(_reviewed(rule, space, answers), spent=spent.spent, step=spent.step)


def _reviewed(rule: Rule, space: Space, answers: Answers) -> Review:
    if rule.aim.kind == PROBABILITY:
        return rare.review(rule.aim, space, answers)
    fits = {}
    for output in rule.aim.outputs:
        try:
            fits[output] = _fitted(rule, space, answers, output)
        except FitError:
            return Review(int(answers.ended.sum()), np.nan, np.nan, {})
    lengths = {name: _lengths(one) for name, one in fits.items()}
    found = Review(int(answers.ended.sum()), np.nan, np.nan, lengths)
    figure, estimate = _judged(rule, space, answers, fits, found)
    return Review(found.runs, figure, estimate, lengths)


def _judged(
    rule: Rule, space: Space, answers: Answers, fits: dict[str, Fit], found: Review
) -> tuple[float, float]:
    """The aim's figure, and its own estimate."""
    kind = rule.aim.kind
    if kind == ACCURACY and rule.until.figure == "rmse":
        return max(rmse(one.values, one.left_out) for one in fits.values()), np.nan
    if kind == ACCURACY:
        return min(one.q2 for one in fits.values()), np.nan
    if not any(np.ptp(one.values) > 0.0 for one in fits.values()):
        return np.nan, np.nan  # all answers are equal so far
    if kind == INDEX_WIDTH:
        return max(_index_width(one, space) for one in fits.values()), np.nan
    ready = processes(rule.aim, space, answers, found)
    worth = Worth(rule.aim, space, ready, rule.seed)
    if kind == OPTIMUM:
        points = candidates(space, answers.coded, answers.failed, seed=rule.seed)
        gain = worthiest(worth, space, answers, points, rule.seed)[1] if len(points) else 0.0
        return gain, rule.aim.sign * worth.best
    (process,) = ready.values()
    mean, deviation = prediction(process, space.sample(SAMPLES, seed=rule.seed))
    away = deviations_away(mean, deviation, rule.aim.value)
    return float((away < UNSURE).mean()), np.nan


def _fitted(rule: Rule, space: Space, answers: Answers, output: str) -> Fit:
    """The process of one output; with levels of fidelity their co-kriging."""
    estimator: Regressor = GaussianProcess()
    if rule.levels:
        *lower, truth = (answers.of_level(one.name) for one in rule.levels)
        below = zip(rule.levels, lower, strict=False)
        runs = [LevelRuns(*one.known(output), inputs=level.inputs) for level, one in below]
        estimator, answers = CoKriging(lower=runs), truth
    return fit(space, *answers.known(output), estimator, surrogate="process", output=output)


def _lengths(one: Fit) -> tuple[float, ...]:
    if isinstance(one.estimator, CoKriging):
        return tuple(np.concatenate([level.logs_ for level in one.estimator.levels_]).tolist())
    assert isinstance(one.estimator, GaussianProcess)
    return tuple(one.estimator.logs_.tolist())


def _index_width(one: Fit, space: Space) -> float:
    """Width of the widest interval of a total index, as the study's analysis gives it."""
    table = sobol(one, space)
    return float((table["total_high"] - table["total_low"]).max())
