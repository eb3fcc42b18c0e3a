"""What the solver said at draws of the posterior, in numbers and in a sentence."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Tested:
    """What the solver says of one output at draws of the posterior.

    solver, predicted, low, high  (run,) solver, surrogate and the ends of its 95 % interval
    cases                         (pair,) measured cases, `rows` (pair,) the runs made at them
    differences                   (pair,) measured - solver
    expected                      root mean square of the differences when the posterior is right
    discrepancy                   whether reality may differ from the solver
    """

    output: str
    unit: str
    solver: Array
    predicted: Array
    low: Array
    high: Array
    cases: NDArray[np.intp]
    rows: NDArray[np.intp]
    differences: Array
    expected: float
    discrepancy: bool

    @property
    def inside(self) -> int:
        """Runs inside the surrogate's 95 % interval."""
        return int(((self.low <= self.solver) & (self.solver <= self.high)).sum())

    @property
    def off(self) -> float:
        """Root mean square of solver - surrogate."""
        return rms(self.solver - self.predicted)

    @property
    def away(self) -> float:
        """Root mean square of measured - solver."""
        return rms(self.differences)

    @property
    def figures(self) -> dict[str, float]:
        """What the runs say, in numbers."""
        return {
            "runs": len(self.solver),
            "inside": self.inside,
            "rmse": self.off,
            "measured_rms": self.away,
            "expected_rms": self.expected,
        }

    def __str__(self) -> str:
        unit = f" {self.unit}".rstrip()
        return (
            f"{self.output}: from the surrogate by {self.off:.2g}{unit}, "
            f"{self.inside} of {len(self.solver)} runs inside its 95 % interval; from the "
            f"measurements by {self.away:.2g}{unit} ({self.expected:.2g} expected of "
            f"their error{' and the discrepancy' if self.discrepancy else ''})"
        )


def sentence(found: tuple[Tested, ...]) -> str:
    """What the runs say of all outputs; empty without runs."""
    if not found:
        return ""
    runs = len(found[0].solver)
    draws = f"{runs} draw{'s' * (runs != 1)} of the posterior"
    return f"The solver was run at {draws}. It differs (RMS) in {'; in '.join(map(str, found))}."


def rms(values: Array) -> float:
    """Root mean square; NaN of nothing."""
    return float(np.sqrt(np.mean(np.square(values)))) if len(values) else float("nan")
