"""Optimal designs by exchange, for any polynomial and criterion.

The coordinates of each run in turn take their best values, from several random starts (Meyer
and Nachtsheim 1995, doi 10.1080/00401706.1995.10485889). With constraints whole runs are
exchanged for feasible candidates (Fedorov 1972).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from surrogate.designs.criteria import Criterion
from surrogate.designs.model import Model

Array = NDArray[np.float64]

#: Singular starts are lifted by this much of the identity (Meyer and Nachtsheim 1995, 3.2);
#: by less, rounding of their gains would exceed `TIE`.
RIDGE = 1e-4
#: Gains that differ by less than this share are equal: symmetric designs tie but for rounding,
#: and the first of them must be taken for the same seed to give the same runs on every processor.
TIE = 1e-5
#: Passes over all coordinates, after which a start is taken as converged.
PASSES = 60


def best_of(
    model: Model,
    criterion: Criterion,
    runs: int,
    starts: int,
    seed: int | None,
    kept: Array | None = None,
) -> Array:
    """The best design (run, parameter) of `starts` searches.

    kept: points (run, parameter) that are there already and stay; they are not returned.
    """
    rng = np.random.default_rng(seed)
    there = np.empty((0, model.size)) if kept is None else model.matrix(kept)
    found = [_search(model, criterion, runs, there, rng) for _ in range(starts)]
    logs = np.array([criterion.value(np.vstack([model.matrix(one), there])) for one in found])
    return found[int(np.argmax(logs >= logs.max() - TIE))]


def _search(
    model: Model, criterion: Criterion, runs: int, there: Array, rng: np.random.Generator
) -> Array:
    """Exchange from a random start, until a pass over the runs changes nothing."""
    design = model.start(runs, rng)
    matrix = np.vstack([model.matrix(design), there])
    for _ in range(PASSES):
        if not any([_improve(model, criterion, design, matrix, run) for run in range(runs)]):
            break
    return design


def _improve(model: Model, criterion: Criterion, design: Array, matrix: Array, run: int) -> bool:
    """Change coordinates of one run, best first, while the criterion grows; True when any changed.

    Changes `design` and its model matrix in place.
    """
    for changes in range(2 * len(model.values)):
        rows = model.neighbours(design[run])
        new = model.matrix(rows)
        # Not updated from step to step: rounding would build up.
        lifted = matrix.T @ matrix + RIDGE * np.eye(model.size)
        gains = criterion.gains(new, matrix[run], np.asarray(np.linalg.inv(lifted)))
        best = int(np.argmax(gains >= gains.max() * (1.0 - TIE)))
        if gains[best] <= 1.0 + 1e-6:
            return changes > 0
        design[run], matrix[run] = rows[best], new[best]
    return True
