"""Crude Monte Carlo: the share of random points that fail.

The interval is that of Clopper and Pearson 1934 (Biometrika 26, 404), exact for a binomial
count: it holds for no failures too.
"""

from __future__ import annotations

import numpy as np
from scipy import stats

from surrogate.reliability.estimate import Estimate
from surrogate.reliability.limit_state import LimitState

#: Points evaluated at once.
BLOCK = 50_000


def crude(
    state: LimitState, *, samples: int = 100_000, confidence: float = 0.95, seed: int = 0
) -> Estimate:
    """Probability of failure from `samples` points."""
    generator = np.random.default_rng(seed)
    failures = 0
    for start in range(0, samples, BLOCK):
        u = generator.standard_normal((min(BLOCK, samples - start), state.size))
        failures += int((state.g(u) <= 0.0).sum())
    return of_count(failures, samples, confidence)


def of_count(failures: int, samples: int, confidence: float = 0.95) -> Estimate:
    """The estimate when so many of the samples fail."""
    found = stats.binomtest(failures, samples).proportion_ci(confidence, method="exact")
    return Estimate("crude", failures / samples, float(found.low), float(found.high), samples)
