"""What an adaptive design aims at, and when it ends."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

ACCURACY, INDEX_WIDTH, OPTIMUM = "accuracy", "index_width", "optimum"
TARGET, PROBABILITY = "target", "probability"
#: What is judged on the way to each aim, the first one by default.
FIGURES = {
    ACCURACY: ("q2", "rmse"),
    INDEX_WIDTH: ("width",),
    OPTIMUM: ("gain",),
    TARGET: ("unsure",),
    PROBABILITY: ("unsure",),
}
#: Smallest improvement that counts, as a share.
NOTICED = 0.05
#: The figures in words.
NAMES = {
    "q2": "Q2",
    "rmse": "RMSE",
    "width": "width of the widest interval of a total index",
    "gain": "expected improvement",
    "unsure": "share of the space whose side is unsure",
}


@dataclass(frozen=True)
class Aim:
    """What the next runs are for.

    kind     accuracy, index_width, optimum, target or probability
    outputs  scalar outputs that are judged; one for the last three kinds
    value    of a target, or the limit of a probability, in the output's unit
    sign     optimum: 1 for the smallest value, -1 for the largest; probability: 1 for above the
             limit, -1 for below
    unit     of the outputs, where it is one
    """

    kind: str
    outputs: tuple[str, ...]
    value: float = 0.0
    sign: Literal[1, -1] = 1
    unit: str = ""

    def __str__(self) -> str:
        names, value = ", ".join(self.outputs), f"{self.value:g} {self.unit}".rstrip()
        if self.kind == OPTIMUM:
            return f"the {'smallest' if self.sign > 0 else 'largest'} {names}"
        if self.kind == TARGET:
            return f"where {names} is {value}"
        if self.kind == PROBABILITY:
            side = "above" if self.sign > 0 else "below"
            return f"the probability that {names} is {side} {value}"
        if self.kind == INDEX_WIDTH:
            return f"narrow intervals of the total indices of {names}"
        return f"accuracy of {names}"


@dataclass(frozen=True)
class Until:
    """When the design ends.

    runs      most runs, the initial design included; None for any number
    figure    what is judged: q2, rmse, width, gain, unsure
    value     that it must reach; None: it is told and ends nothing
    patience  end after so many runs in which the figure did not improve; None for never
    seconds   of the solver that all runs may take, the initial ones included; None for any
    """

    runs: int | None
    figure: str
    value: float | None = None
    patience: int | None = None
    seconds: float | None = None

    @property
    def most(self) -> float:
        """Most runs, infinite where any number may be done."""
        return math.inf if self.runs is None else self.runs

    @property
    def budget(self) -> float:
        """Most seconds, infinite where any time may be spent."""
        return math.inf if self.seconds is None else self.seconds

    def reaches(self, figure: float) -> bool:
        """Whether a figure meets the goal; NaN never does."""
        if self.value is None:
            return False
        return figure >= self.value if self.figure == "q2" else figure <= self.value

    def better(self, figure: float, than: float) -> bool:
        """Whether a figure is better than another, by `NOTICED` of what is missing at least."""
        if self.figure == "q2":
            figure, than = 1.0 - figure, 1.0 - than
        return figure < (1.0 - NOTICED) * than


@dataclass(frozen=True)
class Level:
    """A level of fidelity.

    inputs   numbers of the parameters that it takes
    seconds  that a run of it counts; None: those that its runs have taken
    """

    name: str
    inputs: tuple[int, ...]
    seconds: float | None = None


@dataclass(frozen=True)
class Rule:
    """An adaptive design but for its initial points.

    batch     points that are chosen together and done before the next ones; None: a point for
              each free place, at once
    identity  equal for rules that choose the same points from the same answers
    levels    of fidelity, cheapest first, among which it chooses; () for one
    """

    aim: Aim
    until: Until
    batch: int | None = None
    seed: int = 0
    identity: str = ""
    levels: tuple[Level, ...] = ()


@dataclass(frozen=True)
class Review:
    """A look at the answers: lengths are searched for anew, and the aim is judged.

    runs      of the design that had ended
    figure    what `Until.figure` names; NaN when no surrogate could be fitted
    estimate  the best value of an optimum, the probability asked for; NaN for other aims
    lengths   output -> log lengths and log nugget of its process; of each level, cheapest first
    spent     seconds that the runs count so far, and `step` those of the cheapest further one
    """

    runs: int
    figure: float
    estimate: float
    lengths: Mapping[str, tuple[float, ...]]
    spent: float = math.nan
    step: float = math.nan
