"""The points of an adaptive design, with the answers so far."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from copy import copy
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from surrogate.adaptive.aim import PROBABILITY, Aim, Level, Review
from surrogate.regressors.gaussian_process import GaussianProcess
from surrogate.regressors.level_process import LevelProcess
from surrogate.space.space import Space

Array = NDArray[np.float64]
Truth = NDArray[np.bool_]
Names = NDArray[np.str_]
Process = TypeVar("Process", bound=GaussianProcess)

#: A matrix that is singular to rounding gets so much more nugget, so many times.
MORE_NUGGET, TIMES = 100.0, 4


@dataclass(frozen=True, eq=False)
class Answers:
    """Coded points (n, d) in the order in which they were chosen.

    ended   (n,) runs that ended, failed ones included; the others are under way or wait
    ok      (n,) of these, runs with an answer
    values  output -> (n,), NaN without an answer
    levels  (n,) names of their levels of fidelity; None for one level
    seconds (n,) that they have taken, NaN where that is not known; None for not known at all
    """

    coded: Array
    ended: Truth
    ok: Truth
    values: Mapping[str, Array]
    levels: Names | None = None
    seconds: Array | None = None

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

    def of_level(self, name: str) -> Answers:
        """The points of one level of fidelity."""
        own = np.flatnonzero(self.levels == name)
        return Answers(
            self.coded[own],
            self.ended[own],
            self.ok[own],
            {output: column[own] for output, column in self.values.items()},
            None,
            None if self.seconds is None else self.seconds[own],
        )

    def with_points(self, coded: Array, levels: Sequence[str] = ()) -> Answers:
        """The same with further points (k, d), under way, of these levels of fidelity."""
        none = np.zeros(len(coded), dtype=bool)
        gaps = np.full(len(coded), np.nan)
        return Answers(
            np.vstack([self.coded, coded]),
            np.append(self.ended, none),
            np.append(self.ok, none),
            {name: np.append(column, gaps) for name, column in self.values.items()},
            None if self.levels is None else np.append(self.levels, np.array(levels, dtype=str)),
            None if self.seconds is None else np.append(self.seconds, gaps),
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
    unfitted = process_for(aim, space)
    return {
        output: _believing(unfitted, answers, output, np.array(lengths))
        for output, lengths in review.lengths.items()
    }


def level_processes(
    levels: Sequence[Level], space: Space, answers: Answers, review: Review
) -> dict[str, list[LevelProcess]]:
    """The processes of the levels of each output, cheapest first, as `processes` has them."""
    found: dict[str, list[LevelProcess]] = {}
    for output, lengths in review.lengths.items():
        own = found[output] = []
        for level, logs in zip(levels, np.split(np.array(lengths), len(levels)), strict=True):
            unfitted = LevelProcess(own[-1] if own else None, level.inputs, space=space)
            own.append(_believing(unfitted, answers.of_level(level.name), output, logs))
    return found


def _believing(unfitted: Process, answers: Answers, output: str, logs: Array) -> Process:
    """The process of one output, runs under way believed to answer what it predicts."""
    X, y = answers.known(output)
    one = _conditioned(unfitted, X, y, logs)
    waiting = answers.under_way
    if len(waiting):
        variance = one.variance_
        believed = np.append(y, one.predict(waiting))
        one = _conditioned(unfitted, np.vstack([X, waiting]), believed, logs)
        one.variance_ = variance
    return one


def _conditioned(unfitted: Process, X: Array, y: Array, logs: Array) -> Process:
    for times in range(TIMES):
        try:
            return copy(unfitted).condition(X, y, logs)
        except np.linalg.LinAlgError:
            if times == TIMES - 1:
                raise
            logs = np.append(logs[:-1], logs[-1] + np.log(MORE_NUGGET))
    raise AssertionError
