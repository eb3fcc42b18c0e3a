"""An adaptive design of a known function, a point at a time."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from surrogate.adaptive.aim import Review, Rule
from surrogate.adaptive.answers import Answers
from surrogate.adaptive.choose import choose
from surrogate.adaptive.judge import is_due, review
from surrogate.designs.latin_hypercube import latin_hypercube
from surrogate.space.space import Space

Array = NDArray[np.float64]


def grown(space: Space, of: Callable[[Array], Array], rule: Rule, start: int, seed: int) -> Array:
    """Coded points of a whole design: a Latin hypercube of `start` runs, then chosen ones.

    of  the function of coded points (m, d), values (m,)
    """
    (output,) = rule.aim.outputs
    coded, reviews = latin_hypercube(space, runs=start, seed=seed), list[Review]()
    while len(coded) < rule.until.runs:
        all_ok = np.ones(len(coded), dtype=bool)
        answers = Answers(coded, all_ok, all_ok, {output: of(coded)})
        if is_due(rule, reviews, len(coded)):
            reviews.append(review(rule, space, answers))
        coded = np.vstack([coded, choose(rule, space, answers, reviews[-1])])
    return coded
