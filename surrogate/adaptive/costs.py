"""Seconds that the runs of an adaptive design have taken, and what a further one is to take."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from surrogate.adaptive.aim import Rule
from surrogate.adaptive.answers import Answers

Array = NDArray[np.float64]

#: Seconds of a run at least, so that nothing divides by zero.
LEAST = 1e-6


@dataclass(frozen=True, eq=False)
class Costs:
    """each: seconds of a run of each level, cheapest first; spent: of all runs, begun ones too."""

    each: Array
    spent: float

    @property
    def step(self) -> float:
        """Seconds of the cheapest further run."""
        return float(self.each.min())


def costs(rule: Rule, answers: Answers) -> Costs:
    """What the runs count: the seconds that a level is said to take, else those that it took.

    A run that has not ended counts the median of its level's; NaN before the first has ended.
    """
    if not rule.levels:
        each, total = _of(answers, None)
        return Costs(np.array([each]), total)
    found = [_of(answers.of_level(level.name), level.seconds) for level in rule.levels]
    return Costs(np.array([each for each, _ in found]), sum(total for _, total in found))


def _of(answers: Answers, told: float | None) -> tuple[float, float]:
    """Seconds of a run of one level, and of all."""
    count = len(answers.coded)
    if told is not None:
        return told, told * count
    if answers.seconds is None:
        return np.nan, np.nan
    known = answers.seconds[np.isfinite(answers.seconds)]
    if not len(known):
        return np.nan, np.nan
    each = max(float(np.median(known)), LEAST)
    return each, float(known.sum()) + each * (count - len(known))
