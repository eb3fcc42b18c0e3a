"""What freezing a group of parameters costs, computed for the group as a whole."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy import stats

from surrogate.estimator import Array
from surrogate.sensitivity.conditional import points as law_points
from surrogate.sensitivity.draws import Measure, Spread, spread
from surrogate.sensitivity.model import Model, Seed
from surrogate.sensitivity.pick_freeze import (
    ROUNDING,
    block_size,
    per_scrambling,
    pick_freeze,
    pilot,
    unit_blocks,
)
from surrogate.sensitivity.unexplained import Unexplained


@dataclass(frozen=True)
class VarianceKept:
    """Share of one output's variance that the parameters kept explain, and its interval.

    share         1 - total index of the frozen group (Sobol' 1993), with low and high; of
                  dependent inputs 1 - E[Var(f | kept inputs)] / Var f
    frozen_error  mean square of f(x) - f(kept x, frozen at their values), over the variance:
                  the share that the reduced model misses. At least 1 - share, and twice
                  that on average over places to freeze at (Sobol', Tarantola, Gatelli,
                  Kucherenko and Mauntz 2007, doi 10.1016/j.ress.2006.07.001)
    """

    output: str
    share: float
    low: float
    high: float
    frozen_error: float


def variance_kept(
    one: Model,
    frozen: list[int],
    at: Array,
    *,
    samples: int = 2**14,
    scramblings: int = 8,
    draws: int = 100,
    confidence: float = 0.95,
    seed: Seed = 0,
) -> VarianceKept:
    """Variance kept when the inputs numbered `frozen` rest at the coded point `at` (d,)."""
    if not frozen:
        return VarianceKept(one.output, 1.0, 1.0, 1.0, 0.0)
    options = {"draws": draws, "confidence": confidence, "seed": seed}
    total, half, surrogate = (_lost if one.space.independent else _lost_dependent)(
        one, frozen, samples, scramblings, options
    )
    low = 1.0 - (total + np.hypot(half, surrogate.above.item(0)))
    high = 1.0 - (total - np.hypot(half, surrogate.below.item(0)))
    low, high = (0.0 if np.isnan(low) else low), (1.0 if np.isnan(high) else high)
    return VarianceKept(
        one.output,
        float(np.clip(1.0 - total, 0.0, 1.0)),
        float(np.clip(low, 0.0, 1.0)),
        float(np.clip(high, 0.0, 1.0)),
        frozen_error(one, frozen, at, samples=samples, seed=seed),
    )


def _lost(
    one: Model, frozen: list[int], samples: int, scramblings: int, options: dict[str, Any]
) -> tuple[float, float, Spread]:
    """Total index of the group, half-width of its sampling interval, the surrogate's part."""
    sampled = pick_freeze(
        one.predict,
        one.space,
        groups=[frozen],
        samples=samples,
        scramblings=scramblings,
        confidence=options["confidence"],
        seed=options["seed"],
    )
    measure = Measure(one.space, groups=[frozen], seed=options["seed"])
    surrogate = spread(one, measure, **options)[1]
    return sampled.total[0], sampled.half["total"][0], surrogate


def _lost_dependent(
    one: Model, frozen: list[int], samples: int, scramblings: int, options: dict[str, Any]
) -> tuple[float, float, Spread]:
    """The same for dependent inputs, of E[Var(f | kept inputs)] / Var f."""
    measure = Unexplained(one.space, tuple(frozen), options["seed"])
    runs = per_scrambling(samples, scramblings)
    (share,), (error,) = measure.sampled(one.predict, runs, scramblings)
    quantile = stats.t.ppf(0.5 + 0.5 * options["confidence"], scramblings - 1)
    surrogate = spread(one, measure, **options)[0]
    return float(share[0]), float(quantile * error[0]), surrogate


def frozen_error(
    one: Model, frozen: list[int], at: Array, *, samples: int, seed: Seed = None
) -> float:
    """E (f(x) - f(x with `frozen` inputs at `at`))^2 / Var f, by one scrambled sequence.

    0 for a function that varies by rounding only.
    """
    runs = per_scrambling(samples, 1)
    centre, width = pilot(one.predict, one.space)
    generator = np.random.default_rng(seed)
    squares, mean, second = 0.0, np.zeros(width), np.zeros(width)
    for u in unit_blocks(one.space.size, runs, block_size(4 * width, runs), generator):
        points = law_points(one.space, u)
        values = (one.predict(points) - centre).reshape(len(points), -1)
        points[:, frozen] = at[frozen]
        reduced = (one.predict(points) - centre).reshape(len(points), -1)
        squares += ((values - reduced) ** 2).sum() / runs
        mean += values.sum(axis=0) / runs
        second += (values**2).sum(axis=0) / runs
    variance = (second - mean**2).sum()
    return float(squares / variance) if variance > ROUNDING * (centre**2).sum() else 0.0
