"""How good a candidate is, as one number to be large.

Candidates that meet goal and limits surely enough come before all others. Among the others the
surer one is better; where none has a chance, the one whose prediction misses by less.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from surrogate.solving.goals import Objective, overall
from surrogate.solving.outlook import Outlook
from surrogate.solving.problem import Problem
from surrogate.solving.promise import compared, met

Array = NDArray[np.float64]

#: A candidate that is not sure enough is worse than any sure one by so many standard deviations
#: of an objective.
BEHIND = 1e3
#: Weight of closeness beside a probability or a desirability: it decides only between equals.
TIE = 1e-3


@dataclass(frozen=True, eq=False)
class Judgement:
    """What is known of candidates (m,).

    merit        to be large
    probability  that the solver meets goal and limits there
    values       expectation of each objective, desirability, or distance from the target
    """

    merit: Array
    probability: Array
    outcomes: Mapping[str, Array]
    objectives: Mapping[str, Array]
    desirability: Array | None


@dataclass(frozen=True, eq=False)
class Merit:
    """Judges candidates of a problem by an outlook.

    ideal  the best value of each objective alone, in its spreads, for a Pareto front: then
           the largest weighted distance from it is minimised (Steuer and Choo 1983,
           Mathematical Programming 26, 326-344)
    """

    problem: Problem
    outlook: Outlook
    ideal: Array | None = None

    @cached_property
    def ends(self) -> dict[str, tuple[float, float]]:
        """Where each target ends, by its output."""
        return {one.output: one.ends(self._spanned(one.output)) for one in self.problem.targets}

    @cached_property
    def _sure(self) -> float:
        """How sure a candidate must look: half a standard error of the draws more than asked."""
        asked = self.problem.sure
        drawn = self.outlook.inputs if self.outlook.inputs > 1 else self.outlook.errors
        more = 0.5 * np.sqrt(asked * (1.0 - asked) / drawn)
        return float(min(asked + more, 0.5 * (1.0 + asked)))

    def _spread(self, output: str) -> float:
        return float(self.outlook.fits[output].values.std()) or 1.0

    def _spanned(self, output: str) -> float:
        return float(np.ptp(self.outlook.fits[output].values)) or 1.0

    def judge(self, coded: Array, weights: Array | None = None) -> Judgement:
        """The candidates (m, d), a chunk after the other; weights (m, objectives)."""
        step = self.outlook.at_once
        parts = [
            self._judge(coded[k : k + step], None if weights is None else weights[k : k + step])
            for k in range(0, len(coded), step)
        ]
        return _joined(parts)

    def _judge(self, coded: Array, weights: Array | None) -> Judgement:
        means = self.outlook.means(coded)
        outcomes = self.outlook.outcomes(coded, means)
        columns = self._columns(coded)
        every = {name: self.outlook.for_errors(column) for name, column in columns.items()}
        probability = met(self.problem, self.ends, every, outcomes).mean(axis=1)
        short = self._shortfall(columns, means)
        objectives = {
            one.output: self._objective(one, means[one.output], outcomes[one.output])
            for one in self.problem.objectives
        }
        desirability = (
            overall(self.problem.desires, means).mean(axis=1) if self.problem.desires else None
        )
        merit = self._merit(probability, short, objectives, desirability, weights)
        return Judgement(merit, probability, outcomes, objectives, desirability)

    def _columns(self, coded: Array) -> dict[str, Any]:
        """Physical inputs that limits name, (m, draws or 1) each."""
        named = {name for limit in self.problem.limits for name in limit.names}
        every = self.outlook.points(coded)
        flat = every.reshape(-1, every.shape[-1])
        return {
            p.name: p.decode(flat[:, j]).reshape(every.shape[:2])
            for j, p in enumerate(self.outlook.space.parameters)
            if p.name in named
        }

    def _shortfall(self, columns: Mapping[str, Any], means: Mapping[str, Array]) -> Array:
        """How far predictions miss, (m,): targets in their half-widths, limits in spreads."""
        total = np.zeros(len(next(iter(means.values()))))
        for one in self.problem.targets:
            low, high = self.ends[one.output]
            total += (np.abs(means[one.output] - one.value) / (0.5 * (high - low))).mean(axis=1)
        for desire in self.problem.desires:
            total += desire.shortfall(means[desire.output]).mean(axis=1)
        for limit in self.problem.limits:
            margin = limit.margin(compared(self.problem, limit, columns, means))
            size = np.abs(margin[np.isfinite(margin)]).mean() if np.isfinite(margin).any() else 1.0
            total += np.nan_to_num(np.maximum(0.0, -margin) / (size or 1.0), nan=1e3).mean(axis=1)
        return total

    def _objective(self, one: Objective, mean: Array, outcome: Array) -> Array:
        """What is pushed: the mean, or with a probability the value that is kept so surely."""
        if self.problem.probability is None:
            return np.asarray(mean.mean(axis=1))
        share = self.problem.probability if one.sign > 0 else 1.0 - self.problem.probability
        return np.asarray(np.quantile(outcome, share, axis=1))

    def _merit(
        self,
        probability: Array,
        short: Array,
        objectives: Mapping[str, Array],
        desirability: Array | None,
        weights: Array | None,
    ) -> Array:
        near = TIE / (1.0 + short)
        if desirability is not None:
            return np.asarray(desirability + near - TIE * short / (1.0 + short))
        if not objectives:
            return np.asarray(probability - TIE * short)
        pushed = self.pushed(objectives)
        if weights is None or self.ideal is None:
            cost = pushed.mean(axis=1)
        else:
            away = weights * (pushed - self.ideal)
            cost = away.max(axis=1) + TIE * away.sum(axis=1)
        sure = probability >= self._sure
        return np.where(sure, -cost, -BEHIND * (2.0 - probability + short / (1.0 + short)))

    def pushed(self, objectives: Mapping[str, Array]) -> Array:
        """The objectives (m, objectives), each to be small, in spreads of its output."""
        return np.column_stack(
            [
                one.sign * objectives[one.output] / self._spread(one.output)
                for one in self.problem.objectives
            ]
        )


def _joined(parts: list[Judgement]) -> Judgement:
    """The judgements of chunks of candidates as one."""
    worth = [one.desirability for one in parts if one.desirability is not None]
    return Judgement(
        np.concatenate([one.merit for one in parts]),
        np.concatenate([one.probability for one in parts]),
        _by_name([one.outcomes for one in parts]),
        _by_name([one.objectives for one in parts]),
        np.concatenate(worth) if worth else None,
    )


def _by_name(parts: list[Mapping[str, Array]]) -> dict[str, Array]:
    return {name: np.concatenate([one[name] for one in parts]) for name in parts[0]}
