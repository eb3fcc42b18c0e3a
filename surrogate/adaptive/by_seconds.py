"""The next points of an adaptive design with levels of fidelity, and the levels to run there.

Point and level are those of `next_level`. A process of few runs of the truth may be sure that it
is the cheap one, scaled, and then never asks for the truth again. So a level is run next, whatever
its process says, while its n runs are so few that 2 n^2 is less than the runs of the level below:
a share that falls but never ends, as of the runs that explore in `rare`.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from surrogate.adaptive.aim import Review, Rule
from surrogate.adaptive.answers import Answers, level_processes
from surrogate.adaptive.candidates import APART, candidates, spread
from surrogate.adaptive.choose import seed_of
from surrogate.adaptive.costs import costs
from surrogate.adaptive.next_level import choose
from surrogate.adaptive.worth import REFERENCE
from surrogate.space.space import Space

Array = NDArray[np.float64]
Truth = NDArray[np.bool_]

#: Candidates at which no level has a run yet.
COUNT = 500


def choose_levels(
    rule: Rule, space: Space, answers: Answers, review: Review, count: int = 1
) -> tuple[Array, tuple[str, ...]]:
    """Coded points (k, d) and the level of each; none when no seconds or points are left.

    `count` places are chosen one after the other; a place of a level brings those of cheaper
    levels that it lacks. Each counts the ones before it as answered by what is predicted.
    """
    names = [level.name for level in rule.levels]
    rows, levels = np.empty((0, space.size)), list[str]()
    reference = space.sample(REFERENCE, seed=rule.seed)
    for _ in range(count):
        now = answers.with_points(rows, levels)
        cost = costs(rule, now)
        ready = level_processes(rule.levels, space, now, review)
        points, done = _places(rule, space, now)
        left, outputs = rule.until.budget - cost.spent, list(ready.values())
        for least in (neglected(rule, now), 0):
            found = choose(outputs, points, reference, cost.each, done=done, left=left, least=least)
            if found is not None:
                break
        if found is None:
            break
        point, level = found
        new = np.flatnonzero(~done[point, : level + 1])
        rows = np.vstack([rows, np.tile(points[point], (len(new), 1))])
        levels += [names[k] for k in new]
    return rows, tuple(levels)


def neglected(rule: Rule, answers: Answers) -> int:
    """Number of the dearest level with too few runs beside the level below it; 0 for none."""
    runs = np.array([len(answers.of_level(level.name).coded) for level in rule.levels])
    return int(np.flatnonzero(np.append(True, 2 * runs[1:] ** 2 < runs[:-1]))[-1])


def _places(rule: Rule, space: Space, answers: Answers) -> tuple[Array, Truth]:
    """Candidates (m, d), new ones and those of cheaper levels, and which levels have them.

    A place where a level has failed is left out.
    """
    new = candidates(
        space, answers.coded, answers.failed, seed=seed_of(rule, len(answers.coded)), count=COUNT
    )
    old = np.unique(answers.coded, axis=0)
    points = np.vstack([new, old])
    done, failed = np.zeros((2, len(points), len(rule.levels)), dtype=bool)
    for number, level in enumerate(rule.levels):
        own = answers.of_level(level.name)
        if len(own.coded):
            distance, nearest = cKDTree(spread(space, own.coded)).query(spread(space, points))
            done[:, number] = distance <= APART
            failed[:, number] = done[:, number] & own.failed[nearest]
    kept = ~failed.any(axis=1) & ~done.all(axis=1)
    return points[kept], done[kept]
