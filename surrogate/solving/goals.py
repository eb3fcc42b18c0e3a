"""What is wanted of the outputs: a value to hit, a value to push, or a desirability.

Desirability after Derringer and Suich (1980), "Simultaneous optimization of several
response variables", J. Quality Technology 12, 214-219.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: Default half-width of a target, as a share of the range that the output spans in the runs.
CLOSE = 0.05


@dataclass(frozen=True)
class Target:
    """An output between `low` and `high`; `value` is best. All in the output's unit.

    Without `low` and `high`: `CLOSE` of the output's range about the value.
    """

    output: str
    value: float
    low: float | None = None
    high: float | None = None

    def __str__(self) -> str:
        if self.low is None or self.high is None:
            return f"{self.output} = {self.value:.4g}"
        return f"{self.output} from {self.low:.4g} to {self.high:.4g}"

    def ends(self, spanned: float) -> tuple[float, float]:
        """Where the goal ends, for an output that spans so much in the runs."""
        half = CLOSE * spanned
        return (
            self.value - half if self.low is None else self.low,
            self.value + half if self.high is None else self.high,
        )


@dataclass(frozen=True)
class Objective:
    """An output to be as small (`sign` 1) or as large (-1) as can be."""

    output: str
    sign: Literal[1, -1] = 1

    def __str__(self) -> str:
        return f"{self.output} as {'small' if self.sign > 0 else 'large'} as can be"


@dataclass(frozen=True)
class Desire:
    """How much a value of an output is worth, from 0 (not acceptable) to 1.

    aim         maximise: 0 up to `low`, 1 from `high`; minimise: 1 up to `low`, 0 from
                `high`; target: 0 outside of them, 1 at `value`
    exponent    of the way from 0 to 1: large values want the best
    importance  weight in the geometric mean over the outputs
    """

    output: str
    aim: Literal["maximise", "minimise", "target"]
    low: float
    high: float
    value: float = np.nan
    exponent: float = 1.0
    importance: float = 1.0

    def __str__(self) -> str:
        if self.aim == "target":
            return f"{self.output} near {self.value:.4g} ({self.low:.4g} to {self.high:.4g})"
        word = "large" if self.aim == "maximise" else "small"
        return f"{self.output} {word} ({self.low:.4g} to {self.high:.4g})"

    def of(self, y: Array) -> Array:
        """Desirability of values of the output, same shape."""
        share: Array
        if self.aim == "maximise":
            share = (y - self.low) / (self.high - self.low)
        elif self.aim == "minimise":
            share = (self.high - y) / (self.high - self.low)
        else:
            below = (y - self.low) / (self.value - self.low)
            above = (self.high - y) / (self.high - self.value)
            share = np.minimum(below, above)
        return np.asarray(np.clip(share, 0.0, 1.0) ** self.exponent)

    def shortfall(self, y: Array) -> Array:
        """How far values miss what is acceptable, as a share of the way from 0 to 1."""
        return np.asarray(
            np.maximum(0.0, np.maximum(self.low - y, y - self.high)) / (self.high - self.low)
            if self.aim == "target"
            else np.maximum(0.0, (self.low - y) if self.aim == "maximise" else (y - self.high))
            / (self.high - self.low)
        )

    def acceptable(self, y: Array) -> NDArray[np.bool_]:
        """Which values are worth more than nothing."""
        return np.asarray(self.of(y) > 0.0)


Goal = Target | Objective | Desire


def overall(desires: tuple[Desire, ...], values: dict[str, Array]) -> Array:
    """Geometric mean of the desirabilities, weighted by importance."""
    total = sum(one.importance for one in desires)
    with np.errstate(divide="ignore"):
        logs = sum(one.importance * np.log(one.of(values[one.output])) for one in desires)
    return np.asarray(np.exp(np.asarray(logs) / total))
