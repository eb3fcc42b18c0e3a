"""The adaptive designs of a study, as the execution of their runs asks for points.

What is chosen follows from what the results folder holds, and is written there before a run
begins: so a design that is resumed goes on as if nothing had been, and workers that share
the folder choose each point once.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from surrogate.adaptive.aim import Review, Rule
from surrogate.adaptive.answers import Answers
from surrogate.adaptive.by_seconds import choose_levels
from surrogate.adaptive.choose import choose
from surrogate.adaptive.costs import costs
from surrogate.adaptive.judge import USED_UP, is_due, reason, review
from surrogate.adaptive.kept import State
from surrogate.execution.growth import Find
from surrogate.runs.identity import RunInputs
from surrogate.study.asked_runs import AskedRuns
from surrogate.study.grown_designs import kept


class Growing:
    """Chooses points when places are free; see `surrogate.execution.growth.Growth`.

    asked  the runs as far as the designs have grown
    """

    def __init__(self, asked: AskedRuns) -> None:
        self.asked = asked
        self._seen = set(asked.keys)

    @property
    def ahead(self) -> int:
        """Runs that may still be added, at most."""
        return sum(one.ahead for one in self.asked.outcomes.values())

    def more(self, find: Find, free: int) -> Mapping[str, RunInputs]:
        """Runs that were not asked for before: chosen now, or by others that share the folder."""
        new: dict[str, RunInputs] = {}
        grown = True
        while grown and not new:  # a point of another design is no new run, and takes no place
            self.asked, left = self.asked.grown(), free
            for name, state in self.asked.states.items():
                left -= self._grow(name, state, find, left)
            self.asked, grown = self.asked.grown(), left < free
            runs = zip(self.asked.keys, self.asked.calls, strict=True)
            new = {key: call for key, call in runs if key not in self._seen}
        self._seen |= new.keys()
        return new

    def _grow(self, name: str, state: State, find: Find, free: int) -> int:
        """Choose points of one design; returns how many."""
        rule, answers = self.asked.rules[name], self._answers(name, find)
        rows, ended = len(answers.coded), int(answers.ended.sum())
        count = _count(rule, answers, free)
        if not count and ended < rows:
            return 0
        reviews = list(state.reviews)
        if reason(rule, reviews, rows, state.closed) not in ("", USED_UP):
            return 0
        store = kept(self.asked.folder, rule)
        if is_due(rule, reviews, ended) or (not count and ended > reviews[-1].runs):
            reviews.append(review(rule, self.asked.space, answers))
            store.add_review(reviews[-1])
        if not count or reason(rule, reviews, rows):
            return 0
        latest, space = _latest(reviews), self.asked.space
        if not rule.levels:
            coded = choose(rule, space, answers, latest, count)
            store.add_points(rows, coded)
        elif latest.lengths:
            coded, levels = choose_levels(rule, space, answers, latest, count)
            store.add_points(rows, coded, levels)
        else:  # of some level there is no answer yet
            return 0
        return len(coded)

    def _answers(self, name: str, find: Find) -> Answers:
        """The design's points with what is known of their runs."""
        sizes = [len(coded) for coded in self.asked.points.values()]
        start = sum(sizes[: list(self.asked.designs).index(name)])
        coded = self.asked.designs[name].coded
        records = [find(key) for key in self.asked.keys[start : start + len(coded)]]
        return Answers(
            coded,
            np.array([one is not None for one in records], dtype=bool),
            np.array([one is not None and one.status == "ok" for one in records], dtype=bool),
            values={
                output: np.array(
                    [one.outputs.get(output, np.nan) if one else np.nan for one in records],
                    dtype=float,
                )
                for output in self.asked.rules[name].aim.outputs
            },
            levels=np.array(self.asked.designs[name].levels)
            if self.asked.rules[name].levels
            else None,
            seconds=np.array([one.seconds if one else np.nan for one in records], dtype=float),
        )


def _count(rule: Rule, answers: Answers, free: int) -> int:
    """Points that may be chosen now: a batch when all before it have ended, else one a place.

    No more than runs and seconds are left for.
    """
    if rule.batch is not None:
        free = rule.batch if answers.ended.all() else 0
    left = rule.until.most - len(answers.coded)
    if rule.until.seconds is not None:
        cost = costs(rule, answers)
        if np.isfinite(cost.spent + cost.step):  # else none has ended
            left = min(left, (rule.until.seconds - cost.spent) // cost.step)
        else:
            left = 0
    return int(max(0, min(free, left)))


def _latest(reviews: list[Review]) -> Review:
    """The last review with lengths; without one the last."""
    return next((one for one in reversed(reviews) if one.lengths), reviews[-1])
