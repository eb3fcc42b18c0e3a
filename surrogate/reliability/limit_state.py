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
from surrogate.estimator import Predictor
from surrogate.space.space import Space

Array = NDArray[np.float64]

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


def limit_state(
    predictor: Predictor, space: Space, limit: float, *, above: bool = True
) -> LimitState:
    """Failure where the prediction is above (or below) the limit."""
    return of_function(predictor.predict, space, limit, above=above)


def of_function(
    function: Callable[[Array], Array], space: Space, limit: float, *, above: bool = True
) -> LimitState:
    """Failure where a function of coded points (m, d) is above (or below) the limit."""
    sign = 1.0 if above else -1.0

    def g(u: Array) -> Array:
        return np.asarray(sign * (limit - function(coded_of(space, u))))

    return LimitState(space.size, g)
