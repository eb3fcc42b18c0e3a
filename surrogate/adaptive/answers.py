"""The points of an adaptive design, with the answers so far."""

from __future__ import annotations

from collections.abc import Mapping
from copy import copy
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from surrogate.adaptive.aim import PROBABILITY, Aim, Review
from surrogate.regressors.gaussian_process import GaussianProcess
from surrogate.space.space import Space

Array = NDArray[np.float64]
Truth = NDArray[np.bool_]

#: A matrix that is singular to rounding gets so much more nugget, so many times.
MORE_NUGGET, TIMES = 100.0, 4


@dataclass(frozen=True, eq=False)
class Answers:
    """Coded points (n, d) in the order in which they were chosen.

    ended   (n,) runs that ended, failed ones included; the others are under way or wait
    ok      (n,) of these, runs with an answer
    values  output -> (n,), NaN without an answer
    """

    coded: Array
    ended: Truth
    ok: Truth
    values: Mapping[str, Array]

    @property
    def failed(self) -> Truth:
        """Runs (n,) that ended without an answer."""
        return self.ended & ~self.ok

    @property
    def under_way(self) -> Array:
        """Coded points (k, d) of runs that have not ended."""
        return self.coded[~self.ended]

    def known(self, output: str) -> tuple[Array, Array]:
        """Coded points (m, d) and finite values (m,) of one output."""
        kept = self.ok & np.isfinite(self.values[output])
        return self.coded[kept], self.values[output][kept]

    def with_points(self, coded: Array) -> Answers:
        """The same with further points (k, d), under way."""
        none = np.zeros(len(coded), dtype=bool)
        gaps = np.full(len(coded), np.nan)
        return Answers(
            np.vstack([self.coded, coded]),
            np.append(self.ended, none),
            np.append(self.ok, none),
            {name: np.append(column, gaps) for name, column in self.values.items()},
        )


def process_for(aim: Aim, space: Space | None = None) -> GaussianProcess:
    """The process that learns for an aim; rare events lie at the far ends of unbounded inputs."""
    return GaussianProcess(space=space, normal_scores=aim.kind == PROBABILITY)


def processes(
    aim: Aim, space: Space, answers: Answers, review: Review
) -> dict[str, GaussianProcess]:
    """A process of each output that the review has lengths of, given the answers.

    Runs under way are believed to answer what is predicted: kriging believer (Ginsbourger, Le
    Riche and Carraro 2010, "Kriging is well-suited to parallelize optimization", section 4.2).
    The variance of the process is that of the runs that have an answer.
    """
    found = {}
    unfitted = process_for(aim, space)
    for output, lengths in review.lengths.items():
        logs = np.array(lengths)
        X, y = answers.known(output)
        one = _conditioned(unfitted, X, y, logs)
        waiting = answers.under_way
        if len(waiting):
            variance = one.variance_
            believed = np.append(y, one.predict(waiting))
            one = _conditioned(unfitted, np.vstack([X, waiting]), believed, logs)
            one.variance_ = variance
        found[output] = one
    return found


def _conditioned(unfitted: GaussianProcess, X: Array, y: Array, logs: Array) -> GaussianProcess:
    for times in range(TIMES):
        try:
            return copy(unfitted).condition(X, y, logs)
        except np.linalg.LinAlgError:
            if times == TIMES - 1:
                raise
            logs = np.append(logs[:-1], logs[-1] + np.log(MORE_NUGGET))
    raise AssertionError
