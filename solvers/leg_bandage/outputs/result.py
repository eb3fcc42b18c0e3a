"""A solved run, for exports and pictures."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from ..equilibrium.model import Model
from ..geometry.leg import Leg


@dataclass(frozen=True)
class Result:
    """A solved run.

    leg      undeformed
    model    the boundary value problem
    u        (ndof,) its displacements at rest
    values   the outputs
    seconds  that it took
    states   displacements at rest in other postures and at other times, by name
    """

    leg: Leg
    model: Model
    u: np.ndarray
    values: dict[str, float | np.ndarray]
    seconds: float
    states: Mapping[str, np.ndarray] = field(default_factory=dict)
