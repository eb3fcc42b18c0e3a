"""Derivatives of a cheap model by differences.

First derivatives by the five-point rule, whose error falls with the fourth power of the
step (Abramowitz and Stegun 1964, 25.3.6):

    f'(x) = (f(x-2h) - 8 f(x-h) + 8 f(x+h) - f(x+2h)) / 12 h + O(h^4)

The step is a share of how far an input varies: 1e-3 for first derivatives, where rounding
(1e-16 / h) and truncation (h^4) are both near 1e-12 of the answer's size.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Function = Callable[[list[Array]], list[Array]]

STEP, STEP_OF_HESSIAN = 1e-3, 1e-2
_RULE = ((-2.0, 1.0), (-1.0, -8.0), (1.0, 8.0), (2.0, -1.0))


def apply_jacobian(
    model: Function,
    scales: Sequence[Array],
    point: Sequence[Array],
    out: int,
    where: int,
    along: Array,
    step: float = STEP,
) -> Array:
    """J v of output vector `out` by input vector `where`; shape of that output.

    One derivative along v, scaled so that no input moves farther than `step` of its scale.
    """
    size = float(np.max(np.abs(along) / scales[where], initial=0.0))
    if size == 0.0:
        return np.zeros_like(np.asarray(model(list(point))[out], dtype=float))
    unit = along / size
    total = sum(
        weight * np.asarray(model(_moved(point, where, by * step * unit))[out], dtype=float)
        for by, weight in _RULE
    )
    return np.asarray(total / (12.0 * step) * size)


def gradient(
    model: Function,
    scales: Sequence[Array],
    point: Sequence[Array],
    out: int,
    where: int,
    sens: Array,
    step: float = STEP,
) -> Array:
    """J^T s of output vector `out` by input vector `where`; shape of that input."""
    size = len(point[where])
    columns = [apply_jacobian(model, scales, point, out, where, one, step) for one in np.eye(size)]
    return np.array([float(column @ sens) for column in columns])


def apply_hessian(
    model: Function,
    scales: Sequence[Array],
    point: Sequence[Array],
    out: int,
    first: int,
    second: int,
    sens: Array,
    along: Array,
) -> Array:
    """Derivative of J^T s (by input vector `first`) along v of input vector `second`."""

    def slopes(moved: list[Array]) -> list[Array]:
        return [gradient(model, scales, moved, out, first, sens, STEP_OF_HESSIAN)]

    return apply_jacobian(slopes, scales, point, 0, second, along, STEP_OF_HESSIAN)


def _moved(point: Sequence[Array], where: int, by: Array) -> list[Array]:
    moved = list(point)
    moved[where] = moved[where] + by
    return moved
