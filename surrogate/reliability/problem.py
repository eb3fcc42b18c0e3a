"""What is asked: how probable it is that an output passes a limit."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from surrogate.fitting.best import BEST

if TYPE_CHECKING:  # the words of a study file are read without NumPy
    import numpy as np
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

AUTO = "auto"
METHODS = (AUTO, "crude", "importance", "subset")


@dataclass(frozen=True)
class Failure:
    """An output on the wrong side of a limit.

    sign       1: it fails above the limit, -1: below
    surrogate  a surrogate's name, or best of the output
    method     one of `METHODS`
    """

    name: str
    output: str
    limit: float
    sign: Literal[1, -1] = 1
    unit: str = ""
    surrogate: str = BEST
    method: str = AUTO

    def margin(self, values: Array) -> Array:
        """How far values (m,) of the output stay on the safe side; 0 or less is failure."""
        return self.sign * (self.limit - values)

    def __str__(self) -> str:
        side = "above" if self.sign > 0 else "below"
        return f"{self.output} {side} {self.limit:g} {self.unit}".rstrip()
