"""Subset simulation: a rare failure as a chain of frequent ones.

P = P(F1) P(F2 | F1) ..., F_j = {g <= t_j}, each t_j the p0 quantile of the level's points (Au
and Beck 2001, doi 10.1016/S0266-8920(01)00019-4). The next level's points come from Markov
chains: u' = sqrt(1 - s^2) u + s e, e standard normal, kept where g(u') <= t_j (Papaioannou,
Betz, Zwirglmaier and Straub 2015, doi 10.1016/j.probengmech.2015.06.006). s is moved after each
step towards an acceptance of 0.44.

The chains' points depend on each other, so the interval comes from independent repeats: their
mean, and Student's t on it, by its coefficient of variation on the logarithm of the probability.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from surrogate.reliability.estimate import Estimate, Population
from surrogate.reliability.limit_state import LimitState

Array = NDArray[np.float64]

#: Probability of each level.
SHARE = 0.1
#: Levels at most: probabilities below SHARE ** LEVELS count as 0.
LEVELS = 12
#: Scale s of the first steps, its bounds, and the acceptance that it is moved to.
SCALE, SMALLEST, LARGEST, ACCEPTED = 0.6, 0.1, 1.0, 0.44


@dataclass(frozen=True)
class Chain:
    """One simulation: the probability, and all its points as a weighted population."""

    probability: float
    population: Population
    evaluations: int


def chain(state: LimitState, samples: int, generator: np.random.Generator) -> Chain:
    """One subset simulation with `samples` points a level.

    Points between two thresholds stand for the probability between them, so that all points
    together, weighted, stand for the whole space.
    """
    u = generator.standard_normal((samples, state.size))
    g = state.g(u)
    seeds = max(1, round(SHARE * samples))
    reached, evaluations = 1.0, samples
    points, weights, values = [], [], []
    for _ in range(LEVELS):
        order = np.argsort(g, kind="stable")
        u, g = u[order], g[order]
        threshold = float(g[seeds - 1])
        if threshold <= 0.0 or threshold >= g[-1]:
            break
        points.append(u[seeds:])
        weights.append(np.full(samples - seeds, reached / samples))
        values.append(g[seeds:])
        reached *= seeds / samples
        u, g = _grown(state, u[:seeds], g[:seeds], threshold, samples, generator)
        evaluations += samples - seeds
    points.append(u)
    weights.append(np.full(len(u), reached / len(u)))
    values.append(g)
    population = Population(*map(np.concatenate, (points, weights, values)))
    return Chain(reached * float((g <= 0.0).mean()), population, evaluations)


def _grown(
    state: LimitState,
    u: Array,
    g: Array,
    threshold: float,
    samples: int,
    generator: np.random.Generator,
) -> tuple[Array, Array]:
    """`samples` points below the threshold, by chains from the seeds u (k, d) that lie there."""
    points, values = [u], [g]
    count, scale = len(u), SCALE
    while count < samples:
        step = generator.standard_normal(u.shape)
        moved = np.sqrt(1.0 - scale**2) * u + scale * step
        there = state.g(moved)
        kept = there <= threshold
        u, g = np.where(kept[:, None], moved, u), np.where(kept, there, g)
        points.append(u)
        values.append(g)
        count += len(u)
        scale = float(np.clip(scale * np.exp(kept.mean() - ACCEPTED), SMALLEST, LARGEST))
    return np.concatenate(points)[:samples], np.concatenate(values)[:samples]


def subset(
    state: LimitState,
    *,
    samples: int = 2_000,
    repeats: int = 10,
    confidence: float = 0.95,
    seed: int = 0,
) -> Estimate:
    """Probability of failure from independent repeats with `samples` points a level."""
    generators = [np.random.default_rng(s) for s in np.random.SeedSequence(seed).spawn(repeats)]
    chains = [chain(state, samples, one) for one in generators]
    found = np.array([one.probability for one in chains])
    evaluations = sum(one.evaluations for one in chains)
    mean = float(found.mean())
    if mean <= 0.0:
        return Estimate("subset", 0.0, 0.0, SHARE**LEVELS, evaluations)
    variation = float(found.std(ddof=1)) / mean / np.sqrt(repeats)
    wide = np.exp(float(stats.t.ppf(0.5 + confidence / 2.0, repeats - 1)) * variation)
    return Estimate("subset", mean, mean / wide, min(1.0, mean * wide), evaluations)


def population(state: LimitState, *, samples: int = 2_000, seed: int = 0) -> Population:
    """Weighted points from far to near the limit and beyond it, of one simulation."""
    return chain(state, samples, np.random.default_rng(seed)).population
