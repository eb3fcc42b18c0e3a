"""How far an adaptive design is, or why it ended, in words and as data."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from surrogate.adaptive.aim import NAMES, OPTIMUM, PROBABILITY, Review, Rule
from surrogate.adaptive.judge import (
    NO_IMPROVEMENT,
    NOTHING_LEFT,
    REACHED,
    SPENT,
    USED_UP,
    reason,
)
from surrogate.adaptive.kept import State, as_data, from_data

#: The attribute of a runs dataset that holds the outcomes of its adaptive designs.
ATTRIBUTE = "adaptive"


@dataclass(frozen=True, eq=False)
class Outcome:
    """An adaptive design as it stands.

    aim, kind  in words, and which of the five
    identity   of its rule
    initial    runs before the first choice, rows: all, most: at most, None for any number
    unit       of the value and of figures that have one
    figure     what is judged, goal: that it must reach, NaN for none
    ended      why it takes no more points; "" while it does
    batch      points chosen together; None for one as soon as a place is free
    budget     seconds of the solver that all runs may take, None for any
    """

    aim: str
    kind: str
    identity: str
    initial: int
    rows: int
    most: int | None
    unit: str
    figure: str
    goal: float
    reviews: tuple[Review, ...]
    ended: str
    batch: int | None = None
    budget: float | None = None

    @property
    def ahead(self) -> int:
        """Runs that may still be added, at most, as far as the costs of a run are known."""
        if self.ended:
            return 0
        left = [] if self.most is None else [self.most - self.rows]
        if self.budget is not None and math.isfinite(self._spent):
            left.append(int((self.budget - self._spent) // self.reviews[-1].step))
        return max(min(left, default=0), 0)

    @property
    def _spent(self) -> float:
        """Seconds at the last review; NaN without one."""
        return self.reviews[-1].spent if self.reviews else math.nan

    @property
    def last(self) -> float:
        """The figure of the last review; NaN without one."""
        return self.reviews[-1].figure if self.reviews else math.nan

    def __str__(self) -> str:
        parts = [f"{self._counted}, aim: {self.aim}"]
        if not self.reviews:
            parts.append(self._plan)
        if math.isfinite(self.last):
            parts.append(self._judged)
        if self.ended:
            parts.append(f"ended: {self._why}")
        return "; ".join(parts)

    @property
    def _counted(self) -> str:
        runs = f"{self.rows} of at most {self.most} runs" if self.most else f"{self.rows} runs"
        if self.budget is None:
            return runs
        spent = f"{self._spent:.3g} " if math.isfinite(self._spent) else ""
        return f"{runs}, {spent}of at most {self.budget:.4g} s of the solver"

    @property
    def _plan(self) -> str:
        steps = f"{self.batch} points at a time" if self.batch else "a point for each free place"
        unit = f" {self.figure_unit}".rstrip()
        goal = f", until {NAMES[self.figure]} {self.goal:g}{unit}" * math.isfinite(self.goal)
        return f"after the first {self.initial} runs, {steps}{goal}"

    @property
    def figure_unit(self) -> str:
        """Unit of the figure; shares have none."""
        return self.unit if self.figure in ("rmse", "gain") else ""

    @property
    def _judged(self) -> str:
        goal = f" (goal {self.goal:g})" if math.isfinite(self.goal) else ""
        estimate = self.reviews[-1].estimate
        what = {OPTIMUM: "best value", PROBABILITY: "probability"}.get(self.kind)
        unit = f" {self.unit}".rstrip() if self.kind == OPTIMUM else ""
        first = f"{what} {estimate:.4g}{unit}, " if what and math.isfinite(estimate) else ""
        found = f"{self.last:.4f}" if self.figure == "q2" else f"{self.last:.3g}"
        return f"{first}{NAMES[self.figure]} {found} {self.figure_unit}".rstrip() + goal

    @property
    def _why(self) -> str:
        missed = ", the goal is not reached" if math.isfinite(self.goal) else ""
        return {
            REACHED: "the goal is reached",
            USED_UP: f"the runs are used up{missed}",
            SPENT: f"the seconds are spent{missed}",
            NO_IMPROVEMENT: f"the figure does not improve any more{missed}",
            NOTHING_LEFT: f"no allowed point is left{missed}",
        }[self.ended]


@dataclass(frozen=True)
class Grown:
    """An adaptive design when the study is analysed.

    paid  a sentence for each output: whether choosing the points paid, as far as it can be told
    """

    outcome: Outcome
    paid: tuple[str, ...] = ()


def outcome(rule: Rule, initial: int, state: State) -> Outcome:
    """The outcome of a design with so many initial points."""
    rows, goal = initial + len(state.points), rule.until.value
    return Outcome(
        str(rule.aim),
        rule.aim.kind,
        rule.identity,
        initial,
        rows,
        rule.until.runs,
        rule.aim.unit,
        rule.until.figure,
        math.nan if goal is None else goal,
        state.reviews,
        reason(rule, state.reviews, rows, state.closed),
        rule.batch,
        rule.until.seconds,
    )


def outcome_data(found: Outcome) -> dict[str, Any]:
    """The outcome as JSON data."""
    goal = found.goal if math.isfinite(found.goal) else None
    reviews = [as_data(one) for one in found.reviews]
    return {**vars(found), "goal": goal, "reviews": reviews, "sentence": str(found)}


def outcome_from(data: Mapping[str, Any]) -> Outcome:
    """The outcome in JSON data."""
    words = {key: value for key, value in data.items() if key != "sentence"}
    goal = math.nan if words["goal"] is None else float(words["goal"])
    reviews = tuple(from_data(one) for one in words["reviews"])
    return Outcome(**{**words, "goal": goal, "reviews": reviews})
