"""The next points of an adaptive design, from the answers so far."""

from __future__ import annotations

import zlib

import numpy as np
from numpy.typing import NDArray

from surrogate.adaptive import rare
from surrogate.adaptive.aim import PROBABILITY, Review, Rule
from surrogate.adaptive.answers import Answers, processes
from surrogate.adaptive.candidates import LEADING, STEPS, allowed, around, candidates, farthest
from surrogate.adaptive.worth import Worth
from surrogate.space.space import Space

Array = NDArray[np.float64]


def choose(rule: Rule, space: Space, answers: Answers, review: Review, count: int = 1) -> Array:
    """The next coded points (k, d), one after the other; fewer than `count` when none is left.

    Each counts the ones before it, and runs under way, as answered by what is predicted. The
    same answers give the same points. Without a surrogate, and as long as all answers are equal,
    the points fill the space.
    """
    chosen = np.empty((0, space.size))
    for _ in range(count):
        now = answers.with_points(chosen)
        seed = seed_of(rule, len(now.coded))
        if near := _near_the_limit(rule, space, now, review, seed):
            chosen = np.vstack([chosen, *near])
            continue
        points = candidates(space, now.coded, now.failed, seed=seed)
        if not len(points):
            break
        ready = processes(rule.aim, space, now, review)
        if any(process.scale_ > 0.0 for process in ready.values()):
            worth = Worth(rule.aim, space, ready, rule.seed)
            one, _ = worthiest(worth, space, now, points, seed)
        else:
            one = points[farthest(space, points, now.coded)]
        chosen = np.vstack([chosen, one])
    return chosen


def _near_the_limit(
    rule: Rule, space: Space, answers: Answers, review: Review, seed: int
) -> list[Array]:
    """The point (1, d) that tells most of a probability; none where `worthiest` has to choose.

    That is so for the other aims, in spaces with constraints, as long as all answers are equal,
    and where no process could be fitted.
    """
    if rule.aim.kind != PROBABILITY or space.region is not None or not review.lengths:
        return []
    (process,) = processes(rule.aim, space, answers, review).values()
    if not process.scale_ > 0.0:
        return []
    if rare.explores(len(answers.coded)):
        found = rare.exploring(space, process, answers, review.estimate, seed)
    else:
        found = rare.telling(rule.aim, space, process, answers, seed)
    return [found] if len(found) else []


def worthiest(
    worth: Worth, space: Space, answers: Answers, points: Array, seed: int
) -> tuple[Array, float]:
    """The candidate (d,) of most worth, looked for near the best ones too, and its worth."""
    value = worth.of(points)
    for number, step in enumerate(STEPS):
        best = points[np.argsort(-value, kind="stable")[:LEADING]]
        more = around(space, best, step, seed=seed + number)
        more = allowed(space, more, answers.coded, answers.failed)
        if len(more):
            points, value = np.vstack([points, more]), np.append(value, worth.of(more))
    first = int(np.argmax(value))
    return points[first], float(value[first])


def seed_of(rule: Rule, row: int) -> int:
    """A seed for each row of the design."""
    return zlib.crc32(f"{rule.seed} {row}".encode())
