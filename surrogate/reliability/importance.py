"""Importance sampling about the design point of FORM.

Points v ~ N(u*, I) count with the ratio of densities phi(v) / phi(v - u*), so that the
probability is the mean of 1{g(v) <= 0} exp(|u*|^2 / 2 - v . u*) (Melchers 1989, Structural
Safety 6, 3-10). The interval is that of the mean. Failure far from the design point is met
rarely: subset simulation is the check.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from surrogate.reliability.estimate import Estimate
from surrogate.reliability.limit_state import LimitState

Array = NDArray[np.float64]


def importance(
    state: LimitState,
    design_point: Array,
    *,
    samples: int = 20_000,
    confidence: float = 0.95,
    seed: int = 0,
) -> Estimate:
    """Probability of failure from `samples` points about the design point (d,)."""
    generator = np.random.default_rng(seed)
    v = design_point + generator.standard_normal((samples, state.size))
    ratio = np.exp(design_point @ design_point / 2.0 - v @ design_point)
    terms = np.where(state.g(v) <= 0.0, ratio, 0.0)
    mean = float(terms.mean())
    half = float(stats.norm.ppf(0.5 + confidence / 2.0) * terms.std(ddof=1) / np.sqrt(samples))
    return Estimate("importance", mean, max(mean - half, 0.0), min(mean + half, 1.0), samples)
