"""The limit state g(u) in standard normal space: failure is g <= 0.

The isoprobabilistic transform is the space's own: u standard normal, Phi(u) uniform, and from
there the quantiles of the joint law, copula included (for a Gaussian copula this is the Nataf
transform; Der Kiureghian and Liu 1986, doi 10.1061/(ASCE)0733-9399(1986)112:1(85)).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr

from surrogate.errors import StudyError
from surrogate.reliability.problem import Failure
from surrogate.space.space import Space

Array = NDArray[np.float64]
#: Coded points (m, d) -> values (m,).
Function = Callable[[Array], Array]

#: Keeps probabilities away from 1, where double precision ends (u = 8.2).
LARGEST = 1.0 - 1e-16


@dataclass(frozen=True)
class LimitState:
    """A function g of m points (m, size) in standard normal space, values (m,)."""

    size: int
    g: Callable[[Array], Array]


def coded_of(space: Space, u: Array) -> Array:
    """Coded points (m, d) of standard normal ones (m, d).

    Raises `StudyError` for a space with constraints, which has no such transform.
    """
    if space.region is not None:
        raise StudyError(
            "reliability: parameters joined by constraints: have no transform to the standard "
            "normal space; drop the constraints, or say the dependence by correlation:"
        )
    return space.quantile(np.minimum(ndtr(u), LARGEST))


def state_of(problem: Failure, space: Space, function: Function) -> LimitState:
    """The limit state of a function of coded points."""
    return LimitState(space.size, lambda u: problem.margin(function(coded_of(space, u))))
