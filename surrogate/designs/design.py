"""A design: named coded points and how they came about."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np


@dataclass(frozen=True)
class Design:
    """Where to run the solver.

    name     as in the study: train, test, ...
    method   what made it
    options  of that method, its seed included
    coded    points, shape (run, parameter), augmentations included
    added    (augmentation, number of rows) in the order of the rows at the end
    """

    name: str
    method: str
    options: Mapping[str, Any]
    coded: np.ndarray
    added: tuple[tuple[str, int], ...] = field(default=())

    @property
    def runs(self) -> int:
        """Number of rows."""
        return len(self.coded)
