"""How far off a value on a mesh is, from its values on a family of similar meshes.

Four meshes or more: least squares of f + C h^p, and where p is out of bounds of one or two
terms of given order, with the uncertainty of Eca and Hoekstra 2014 (J. Comput. Phys. 262,
104-130), which grows when the scatter of the values exceeds their trend. Three meshes:
Richardson's estimate and the grid convergence index (ASME V&V 20-2009) where the values
approach a limit monotonically, and otherwise three times their range and no limit (Eca and
Hoekstra 2006, 2nd Workshop on CFD Uncertainty Analysis, Lisbon). Two meshes: three times their
difference.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.optimize import brentq, minimize_scalar

ORDERS = 0.5, 2.0
"""An observed order outside these is not believed."""
SAFE, CAREFUL = 1.25, 3.0
"""Factors on an error whose order is believed, and on one whose order is not."""
FIXED = {"h": (1.0,), "h^2": (2.0,), "h and h^2": (1.0, 2.0)}
"""Expansions of given order."""


@dataclass(frozen=True)
class Refined:
    """What a family of meshes says.

    limit        of vanishing element size; NaN where none can be said
    order        of the expansion that was fitted, NaN without one
    uncertainty  (n,) of the value on each mesh, for 95 %
    how          what was done
    limits       limit and standard deviation of each expansion that was fitted, {name: (2,)}:
                 where they differ, the sequence does not tell its limit
    """

    limit: float
    order: float
    uncertainty: np.ndarray
    how: str
    limits: Mapping[str, tuple[float, float]] = field(default_factory=dict)


def refined(sizes: Sequence[float], values: Sequence[float]) -> Refined:
    """Limit and uncertainties from values (n,) on element sizes (n,), any unit, n >= 2."""
    h, f = np.asarray(sizes, float), np.asarray(values, float)
    order = np.argsort(-h)
    back = np.argsort(order)
    found = _least_squares(h[order], f[order]) if len(h) > 3 else _few(h[order], f[order])
    return replace(found, uncertainty=found.uncertainty[back])


def observed_order(sizes: Sequence[float], values: Sequence[float]) -> float:
    """p of f + C h^p through three values, coarse to fine; NaN unless they converge."""
    (h1, h2, h3), (f1, f2, f3) = sizes, values
    if (f1 - f2) * (f2 - f3) <= 0:
        return np.nan
    ratio = (f1 - f2) / (f2 - f3)

    def miss(p):
        return (h1**p - h2**p) / (h2**p - h3**p) - ratio

    return brentq(miss, 0.01, 20.0) if miss(0.01) * miss(20.0) < 0 else np.nan


def _few(h, f):
    p = observed_order(h, f) if len(h) == 3 else np.nan
    if np.isnan(p):
        how = "two meshes" if len(h) == 2 else "no approach to a limit"
        return Refined(
            np.nan, np.nan, np.full(len(h), CAREFUL * np.ptp(f)), f"{how}: three times the range"
        )
    limit = f[2] + (f[2] - f[1]) / ((h[1] / h[2]) ** p - 1)
    believed = ORDERS[0] <= p <= ORDERS[1] + 0.1
    return Refined(
        limit,
        p,
        (SAFE if believed else CAREFUL) * np.abs(f - limit),
        "monotone: Richardson" + ("" if believed else ", order not believed"),
    )


@dataclass(frozen=True)
class _Fit:
    """An expansion f + sum C_k h^p_k: its limit, its values, its standard deviation."""

    limit: float
    fitted: np.ndarray
    deviation: float
    order: float


def _least_squares(h, f):
    fit = min((_believed(h, f, w) for w in (np.ones(len(h)), 1 / h)), key=lambda x: x.deviation)
    plain = [_fixed(h, f, np.ones(len(h)), powers, len(powers) + 1) for powers in FIXED.values()]
    limits = {name: (one.limit, one.deviation) for name, one in zip(FIXED, plain, strict=True)}
    error = np.abs(fit.fitted - fit.limit)
    off = np.abs(f - fit.fitted)
    step = np.ptp(f) / (len(f) - 1)
    trusted = ORDERS[0] <= fit.order <= ORDERS[1] + 0.1
    if fit.deviation < step:
        spread = (SAFE if trusted else CAREFUL) * error + fit.deviation + off
        return Refined(fit.limit, fit.order, spread, "least squares, a trend", limits)
    spread = CAREFUL * fit.deviation / max(step, 1e-300) * (error + fit.deviation + off)
    return Refined(fit.limit, fit.order, spread, "least squares, scatter above the trend", limits)


def _believed(h, f, weights):
    """The fit of free order, or the best of given orders when that one is out of bounds."""
    free = _free(h, f, weights)
    if ORDERS[0] <= free.order <= ORDERS[1]:
        return free
    powers = list(FIXED.values())[: 2 if free.order > ORDERS[1] else 3]
    return min((_fixed(h, f, weights, p, len(p) + 1) for p in powers), key=lambda x: x.deviation)


def _free(h, f, weights):
    """f + C h^p with p from 0.05 to 8; at an end of these, p is out of bounds anyhow."""
    grid = np.geomspace(0.05, 8.0, 60)
    misses = [_fixed(h, f, weights, (p,), 3).deviation for p in grid]
    best = int(np.argmin(misses))
    around = grid[max(best - 1, 0)], grid[min(best + 1, len(grid) - 1)]
    p = minimize_scalar(
        lambda p: _fixed(h, f, weights, (p,), 3).deviation,
        bounds=around,
        method="bounded",
        options={"xatol": 1e-6},
    ).x
    return _fixed(h, f, weights, (p,), 3)


def _fixed(h, f, weights, powers, unknowns):
    """Weighted least squares of f + sum C_k h^p_k; the deviation has n - unknowns freedoms."""
    w = len(h) * weights / weights.sum()
    columns = np.column_stack([np.ones(len(h)), *(h**p for p in powers)])
    found = np.linalg.lstsq(np.sqrt(w)[:, None] * columns, np.sqrt(w) * f, rcond=None)[0]
    fitted = columns @ found
    deviation = np.sqrt(np.sum(w * (f - fitted) ** 2) / (len(h) - unknowns))
    return _Fit(float(found[0]), fitted, float(deviation), float(np.mean(powers)))
