"""Sobol' indices of any function by pick-freeze on scrambled Sobol' sequences.

Two independent points A and B of the inputs are mixed: A_i is A with input i taken
from B, B_i is B with input i taken from A. With numerators and denominators averaged
over the points,

    S_i   = 2 E[(f(A) - f(A_i)) (f(B_i) - f(B))]             / D_i
    T_i   = (E[(f(A) - f(A_i))^2] + E[(f(B) - f(B_i))^2])    / D_i
    S_ij  = 4 E[(f(B_i) - f(B)) (f(A_j) - f(A))]             / mean D
    D_i   = E[(f(A) - f(B))^2] + E[(f(A_i) - f(B_i))^2]      (= 4 Var f)

S_i and T_i are the estimators of Azzini, Mara and Rosati 2021, "Comparison of two sets
of Monte Carlo estimators of Sobol' indices", Environmental Modelling and Software 144,
doi 10.1016/j.envsoft.2021.105167; the numerator of S_i is Owen's double difference (2013,
"Better estimation of small Sobol' sensitivity indices", ACM TOMACS 23, doi
10.1145/2457459.2457460). All are sums of products of differences: they do not depend on the
mean of f, and they vanish with the effect. `benchmarks/sensitivity.py estimators` measures
them against Janon's, Jansen's and Saltelli's forms.

The points come in independent scramblings of a Sobol' sequence. The scatter between
scramblings gives the standard error (jackknife of the ratio, Student quantile; see
L'Ecuyer, Nakayama, Owen and Tuffin 2023, "Confidence intervals for randomized
quasi-Monte Carlo estimators"); a bootstrap over the points of one sequence would not
know that they are spread more evenly than random ones, and covers always. The price is a
larger error than one sequence of all the points has; eight scramblings keep it low (with
errors of order 1/n the half-width t sqrt(R) is 6.4 at R = 4, 6.7 at 8 and 8.5 at 16).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from scipy import stats
from scipy.stats import qmc

from surrogate.estimator import Array, Groups
from surrogate.sensitivity.model import Predict, Seed, require_at_least
from surrogate.space.space import Space

#: Names of the indices, in the order in which tuples of them are passed about.
INDICES = ("first_order", "total", "second_order")

#: A variance below this share of the square of the mean is rounding: the function is constant.
ROUNDING = 1e-28
#: Most numbers held at once in the block of function values: 32 MB.
BLOCK = 4_000_000


@dataclass(frozen=True)
class Mixing:
    """How the points A and B are mixed.

    size  number d of the inputs or groups
    of    uniform numbers u (run, 2 inputs) -> the coded points A, B, A_1 .. A_d, B_1 .. B_d
    """

    size: int
    of: Callable[[Array], Iterator[Array]]


@dataclass(frozen=True)
class Sampled:
    """Indices with the half-widths of their sampling intervals.

    first_order, total: shape (d,); second_order: (d, d), symmetric, NaN on the diagonal; all
    zero for a constant function;
    `half` maps the same names to half-widths of the same shapes; evaluations: of f.
    """

    first_order: Array
    total: Array
    second_order: Array
    half: dict[str, Array]
    evaluations: int


def pick_freeze(
    predict: Predict,
    space: Space,
    *,
    groups: Groups | None = None,
    mixing: Mixing | None = None,
    samples: int = 2**14,
    scramblings: int = 8,
    confidence: float = 0.95,
    seed: Seed = 0,
) -> Sampled:
    """Sobol' indices of `predict` over the independent inputs of `space`.

    predict      coded points (run, parameter) -> values (run,) or (run, ...); the indices
                 of an array are those of its components weighted by variance (Gamboa,
                 Janon, Klein and Lagnoux 2014, doi 10.1214/14-EJS895)
    groups       lists of input numbers that are moved together; default: each input alone.
                 The indices are then those of the groups, which must not overlap
    mixing       in place of groups: the indices are those of what it exchanges
    samples      number of pairs (A, B), rounded up to `scramblings` powers of two;
                 (2 d + 2) evaluations each for d groups, in blocks of bounded memory
    scramblings  independent randomisations; their scatter gives the intervals
    """
    require_at_least(4, scramblings=scramblings)
    require_at_least(8, samples=samples)
    moments = product_moments(
        predict,
        space,
        mixing or independent(space, groups),
        samples=samples,
        scramblings=scramblings,
        seed=seed,
    )
    values, errors = jackknife(ratios, moments)
    quantile = stats.t.ppf(0.5 + 0.5 * confidence, scramblings - 1)
    first_order, total, second_order = values
    half = {name: quantile * error for name, error in zip(INDICES, errors, strict=True)}
    evaluations = scramblings * per_scrambling(samples, scramblings) * moments.shape[-1]
    return Sampled(first_order, total, second_order, half, evaluations)


def per_scrambling(samples: int, scramblings: int) -> int:
    """Smallest power of two with at least `samples` points over all scramblings."""
    return 1 << max(3, int(np.ceil(np.log2(samples / scramblings))))


def product_moments(
    predict: Predict,
    space: Space,
    mixing: Mixing,
    *,
    samples: int,
    scramblings: int,
    seed: Seed = None,
) -> Array:
    """Means of products f(X) f(X') over the points, shape (scramblings, k, k).

    The k = 2 d + 2 columns, for a mixing of size d, are A, B, A_1 .. A_d, B_1 .. B_d, less a rough
    mean of f so that no digits are lost; components of an array are summed. All zero for a
    function that varies by rounding only.
    """
    k = 2 * mixing.size + 2
    runs = per_scrambling(samples, scramblings)
    centre, width = pilot(predict, space)
    block = block_size(width * k, runs)
    moments = np.zeros((scramblings, k, k))
    for r, generator in enumerate(np.random.default_rng(seed).spawn(scramblings)):
        for u in unit_blocks(2 * space.size, runs, block, generator):
            columns = np.column_stack([(predict(X) - centre).ravel() for X in mixing.of(u)])
            moments[r] += columns.T @ columns / runs
    constant = np.diagonal(moments.mean(axis=0)).mean() <= ROUNDING * (centre**2).sum()
    return np.zeros_like(moments) if constant else moments


def unit_blocks(
    dimensions: int, runs: int, block: int, generator: np.random.Generator
) -> Iterator[Array]:
    """One scrambled Sobol' sequence of `runs` points in (0, 1), `block` points at a time."""
    sequence = qmc.Sobol(dimensions, scramble=True, rng=generator)
    for _ in range(runs // block):
        yield np.clip(sequence.random(block), 1e-12, 1.0 - 1e-12)


def mixed_points(space: Space, mixing: Mixing, runs: int, seed: Seed) -> list[Array]:
    """The k = 2 d + 2 sets of coded points (runs, parameter), for `runs` a power of two."""
    u = next(unit_blocks(2 * space.size, runs, runs, np.random.default_rng(seed)))
    return list(mixing.of(u))


def independent(space: Space, groups: Groups | None = None) -> Mixing:
    """Independent inputs are exchanged, each alone or in groups."""
    d = space.size
    moved = [[i] for i in range(d)] if groups is None else groups

    def of(u: Array) -> Iterator[Array]:
        return _mixtures(space.quantile(u[:, :d]), space.quantile(u[:, d:]), moved)

    return Mixing(len(moved), of)


def block_size(width: int, runs: int) -> int:
    """Points at once, a power of two, when each gives `width` numbers; at most `runs`."""
    return int(np.clip(2 ** int(np.log2(max(BLOCK // width, 1))), 1, runs))


def pilot(predict: Predict, space: Space) -> tuple[Array, int]:
    """Rough mean of f, and the number of its components."""
    values = np.asarray(predict(space.sample(64, seed=0)))
    return values.mean(axis=0), values[0].size


def _mixtures(A: Array, B: Array, groups: Groups) -> Iterator[Array]:
    """A, B, then A with one group of columns from B, then B with one group from A."""
    yield A
    yield B
    for base, other in ((A, B), (B, A)):
        for group in groups:
            mixed = base.copy()
            mixed[:, group] = other[:, group]
            yield mixed


def ratios(M: Array) -> tuple[Array, Array, Array]:
    """First-order, total and second-order indices from product moments (k, k).

    All zero where nothing varies.
    """
    d = len(M) // 2 - 1
    a, b, ai, bi = 0, 1, np.arange(2, 2 + d), np.arange(2 + d, 2 + 2 * d)
    square = np.diag(M)
    distance = square[:, None] + square[None, :] - 2.0 * M
    four_variances = distance[a, b] + distance[ai, bi]
    if not four_variances.mean() > 0.0:
        four_variances = np.ones_like(four_variances)
    first = 2.0 * (M[a, bi] - M[a, b] - M[ai, bi] + M[ai, b]) / four_variances
    total = (distance[a, ai] + distance[b, bi]) / four_variances
    pair = M[np.ix_(bi, ai)] - M[a, bi][:, None] - M[b, ai][None, :] + M[a, b]
    second = 2.0 * (pair + pair.T) / four_variances.mean()
    np.fill_diagonal(second, np.nan)
    return first, total, second


def jackknife(
    statistic: Callable[[Array], tuple[Array, ...]], replicates: Array
) -> tuple[tuple[Array, ...], tuple[Array, ...]]:
    """Statistic of the mean of independent replicates (R, ...), and its standard errors.

    `statistic` maps an array to a tuple of arrays; standard errors by leaving out one
    replicate at a time (Efron and Stein 1981): (R - 1) / R sum (t_r - mean t)^2.
    """
    R = len(replicates)
    mean = replicates.mean(axis=0)
    left_out = [statistic((R * mean - replicate) / (R - 1)) for replicate in replicates]
    errors = tuple(
        np.sqrt((R - 1.0) * np.var(np.stack(parts), axis=0))
        for parts in zip(*left_out, strict=True)
    )
    return statistic(mean), errors
