"""Shapley effects: shares of the variance that sum to 1, dependent parameters included.

With c(S) = E[Var(f | x outside S)] the Shapley effect of an input is its average increase
of c over all orders in which inputs can be added to S, over Var f (Owen 2014, doi
10.1137/130936233; Song, Nelson and Staum 2016, doi 10.1137/15M1048070, theorem 1). It lies
between first-order and total index when inputs are independent. c(S) is half the mean square
of f(X) - f(X') with X' redrawn inside S given the rest (Jansen's form; Broto, Bachoc and
Depecker 2020, doi 10.1137/18M1234631). All subsets are used up to `ALL_SUBSETS` inputs, above
them random orders and their reverses.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import combinations
from math import comb

import numpy as np
import xarray as xr
from scipy import stats

from surrogate.estimator import Array, Predictor, has_indices
from surrogate.sensitivity.conditional import Pairs
from surrogate.sensitivity.draws import Functions, Values, closed_form, spread
from surrogate.sensitivity.groups import Named, numbers
from surrogate.sensitivity.model import Analysed, Model, Predict, Seed, model, require_at_least
from surrogate.sensitivity.pick_freeze import (
    BLOCK,
    ROUNDING,
    jackknife,
    per_scrambling,
    unit_blocks,
)
from surrogate.sensitivity.table import Q2_NEEDED, Estimate, Variables, dataset
from surrogate.space.space import Space

ALL_SUBSETS = 8
#: Random orders a scrambling, each with its reverse, above `ALL_SUBSETS` inputs.
ORDERS = 16
#: Points on which effects of drawn surrogates are set side by side.
SAMPLES = 256
NAMES = ("shapley", "closed_first_order", "independent_total", "group_shapley")

Subset = tuple[int, ...]


def shapley(
    fit: Analysed,
    space: Space,
    *,
    groups: Named | None = None,
    seed: Seed = 0,
    confidence: float = 0.95,
    samples: int = 2**12,
    scramblings: int = 8,
    draws: int = 50,
    q2: float | None = None,
    q2_needed: float = Q2_NEEDED,
) -> xr.Dataset:
    """Shapley effects of one output, for independent and for dependent parameters.

    Arguments as for `sobol`. Effects sum to 1, so a group's is the sum of its parameters':
    `group_shapley` over dimension `group`, with an interval of its own. Variables `shapley`
    (sums to 1), `closed_first_order` = Var E[f | x_i] / Var f and `independent_total` =
    E[Var(f | x outside i)] / Var f, which are the Sobol' indices when parameters are
    independent; each with `_low`, `_high`, `_sampling`, `_surrogate`. Closed form where a
    surrogate has no interactions above second order and parameters are independent. All zero
    for an output that does not vary.
    """
    require_at_least(4, scramblings=scramblings)
    require_at_least(8, samples=samples)
    one = model(fit, space, q2=q2)
    exact = space.independent and _second_order(one.estimator)
    grouped = numbers(space, groups)
    measure = Measure(space, exact, seed, tuple(map(tuple, grouped)))
    if exact:
        values = measure.of(one.predictor)
        half = tuple(np.zeros_like(value) for value in values)
    else:
        values, half = _sampled(one, measure, samples, scramblings, confidence)
    spreads = spread(one, measure, draws=draws, confidence=confidence, seed=seed)
    variables: Variables = {}
    for name, value, width, part in zip(NAMES[: len(values)], values, half, spreads, strict=True):
        estimate = Estimate(value, width, part.below, part.above)
        dims = ("group",) if name.startswith("group") else ("parameter",)
        variables |= estimate.columns(name, dims, (0.0, 1.0))
    return dataset(
        one,
        variables,
        method="shapley",
        confidence=confidence,
        q2_needed=q2_needed,
        groups=groups,
        computed="closed form" if exact else "sampling",
        surrogate_part=spreads[0].how,
    )


@dataclass(frozen=True)
class Measure:
    """Effects of any surrogate on points common to all, or in closed form."""

    space: Space
    closed: bool
    seed: Seed = 0
    groups: tuple[Subset, ...] = ()

    def of(self, estimator: Predictor) -> Values:
        """The three kinds of effects of one estimator, each (d,); and the groups' (g,)."""
        if self.closed:
            return self.summed(_closed(estimator))
        return self.effects(self._increases(estimator.predict).sum(axis=-1))

    def effects(self, parts: Array) -> Values:
        """The same from unscaled effects (3, d)."""
        return self.summed(effects(parts))

    def summed(self, found: Values) -> Values:
        """The effects, and the sum of the Shapley effects of each group if there are some."""
        sums = np.array([found[0][list(group)].sum() for group in self.groups])
        return (*found, sums) if self.groups else found

    def of_functions(self, functions: Functions, pairs: int) -> list[Values]:
        """The same for each column of functions(coded) (run, count)."""
        return [
            self.effects(parts) for parts in np.moveaxis(self._increases(functions, pairs), -1, 0)
        ]

    def _increases(self, predict: Predict, runs: int = SAMPLES) -> Array:
        generator = np.random.default_rng(self.seed)
        runs = min(runs, SAMPLES)
        u = next(unit_blocks(2 * self.space.size, runs, runs, generator))
        return increases(predict, self.space, [u], runs, generator)


def _second_order(estimator: Predictor | None) -> bool:
    """True when first and second order make up the variance of the estimator, in closed form."""
    if not has_indices(estimator):
        return False
    first, _, second = closed_form(estimator)
    return bool(abs(first.sum() + 0.5 * np.nansum(second) - 1.0) <= 1e-9)


def _closed(estimator: Predictor) -> Values:
    """The three kinds of effects (d,) from the estimator's own indices.

    S_i + sum_j S_ij / 2, and a share of what lies above second order in proportion to the
    input's part in it: exact up to third order, near enough for drawn surrogates beyond.
    """
    first, total, second = closed_form(estimator)
    pairs = np.nan_to_num(second)
    above = np.maximum(total - first - pairs.sum(axis=1), 0.0)
    rest = max(1.0 - first.sum() - 0.5 * pairs.sum(), 0.0)
    share = rest * above / above.sum() if above.sum() > 0.0 else 0.0
    return first + 0.5 * pairs.sum(axis=1) + share, first, total


def _sampled(
    one: Model, measure: Measure, samples: int, scramblings: int, confidence: float
) -> tuple[Values, Values]:
    """Effects and half-widths of their sampling intervals."""
    runs = per_scrambling(samples, scramblings)
    parts = []
    for generator in np.random.default_rng(measure.seed).spawn(scramblings):
        blocks = unit_blocks(2 * one.space.size, runs, min(runs, _block(one)), generator)
        parts.append(increases(one.predict, one.space, blocks, runs, generator).sum(axis=-1))
    values, errors = jackknife(measure.effects, np.stack(parts))
    quantile = stats.t.ppf(0.5 + 0.5 * confidence, scramblings - 1)
    return values, tuple(quantile * error for error in errors)


def _block(one: Model) -> int:
    """Points at once: a power of two that keeps an array output in bounded memory."""
    width = np.asarray(one.predict(one.space.sample(1, seed=0))).size
    return 1 << int(np.log2(max(BLOCK // (4 * width), 1)))


def effects(parts: Array) -> Values:
    """Shares from average increases, Var - c(all but i), c(i), in the rows of parts (3, d).

    All zero where nothing varies.
    """
    variance = parts[0].sum()
    return tuple(parts / variance if variance > 0.0 else np.zeros_like(parts))


def increases(
    predict: Predict,
    space: Space,
    blocks: Iterable[Array],
    runs: int,
    generator: np.random.Generator,
) -> Array:
    """Unscaled effects (3, d, component) over the points of `blocks`, `runs` in all.

    Zero for a component that varies by rounding only.
    """
    d = space.size
    weights = _weights(d, generator)
    costs, size = dict.fromkeys(weights, 0.0), 0.0
    for u in blocks:
        pairs = Pairs.of(space, u)
        values = np.asarray(predict(pairs.points())).reshape(len(u), -1)
        size = size + (values**2).sum(axis=0) / runs
        for subset in weights:
            moved = np.asarray(predict(pairs.partners(subset))).reshape(len(u), -1)
            costs[subset] = costs[subset] + ((values - moved) ** 2).sum(axis=0) / (2.0 * runs)
    everything = tuple(range(d))
    varies = costs[everything] > ROUNDING * size
    average = sum(weight[:, None] * costs[subset] for subset, weight in weights.items())
    alone = np.stack(
        [
            costs[everything] - costs[everything[:i] + everything[i + 1 :]]
            if d > 1
            else costs[everything]
            for i in range(d)
        ]
    )
    last = np.stack([costs[(i,)] for i in range(d)])
    return np.stack([average, alone, last]) * varies


def _weights(d: int, generator: np.random.Generator) -> dict[Subset, Array]:
    """Weights (d,) of c(S) in the Shapley sums, for every subset S that is evaluated.

    All subsets: 1 / (d comb(d - 1, |S| - 1)) for members, minus 1 / (d comb(d - 1, |S|)) for
    the others. Random orders: the same from the orders drawn.
    """
    if d <= ALL_SUBSETS:
        return {
            subset: _weight(subset, d)
            for size in range(1, d + 1)
            for subset in combinations(range(d), size)
        }
    needed = [(i,) for i in range(d)] + [tuple(j for j in range(d) if j != i) for i in range(d)]
    weights = {subset: np.zeros(d) for subset in [*needed, tuple(range(d))]}
    for order in [generator.permutation(d) for _ in range(ORDERS)]:
        for way in (order, order[::-1]):
            for k, i in enumerate(way):
                with_i, without = (tuple(sorted(way[:n].tolist())) for n in (k + 1, k))
                weights.setdefault(with_i, np.zeros(d))[i] += 0.5 / ORDERS
                if without:
                    weights[without][i] -= 0.5 / ORDERS
    return weights


def _weight(subset: Subset, d: int) -> Array:
    size, member = len(subset), np.isin(np.arange(d), subset)
    joining = 1.0 / (d * comb(d - 1, size - 1))
    leaving = 1.0 / (d * comb(d - 1, size)) if size < d else 0.0
    return np.where(member, joining, -leaving)
