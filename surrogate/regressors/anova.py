"""Exact Sobol' indices of sums of products.

For f(x) = sum_t c_t prod_j g_tj(x_j) with independent inputs every conditional
expectation factors into one-dimensional ones:

    E[f | x_S] = sum_t c_t prod_{j in S} g_tj(x_j) prod_{j not in S} E[g_tj]

(Sobol' 1993; Oakley and O'Hagan 2004, equations 10 to 12). With g_tj given at the
nodes of a quadrature of each input's law, the indices are exact to that quadrature.
Polynomials, polynomial chaos and the mean of a product-kernel Gaussian process have
this form. A group of inputs counts as one input: its factors are products too.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from surrogate.errors import FitError
from surrogate.estimator import Groups
from surrogate.space.space import Space

Array = NDArray[np.float64]
#: Nodes (m,) and weights (m,) of a quadrature.
Rule = tuple[Array, Array]


@dataclass(frozen=True, eq=False)
class SobolIndices:
    """Shares of the variance: first_order (d,), total (d,), second_order (d, d) symmetric.

    For groups of inputs, those of the groups: first_order (g,) is what a group explains
    without the other inputs, total (g,) what is gone when it rests. All zero for a constant
    function, whose variance is 0.
    """

    first_order: Array
    total: Array
    second_order: Array
    variance: float
    mean: float


def quadratures(space: Space | None, size: int, order: int) -> list[Rule]:
    """Nodes (m,) and weights (m,) of each input's law, for independent inputs.

    Without a space, uniform on [-1, 1]. Raises `FitError` when inputs are correlated.
    """
    if space is not None and not space.independent:
        raise FitError(
            "closed-form Sobol' indices need independent parameters, but these are "
            "correlated or joined by constraints; use Shapley effects"
        )
    return marginals(space, size, order)


def marginals(space: Space | None, size: int, order: int) -> list[Rule]:
    """Nodes (m,) and weights (m,) of each input's law, whatever joins the inputs."""
    if space is None:
        nodes, weights = np.polynomial.legendre.leggauss(order)
        return [(nodes, weights / 2.0)] * size
    return [parameter.quadrature(order) for parameter in space.parameters]


def sobol_indices(
    coefficients: ArrayLike,
    factors: Sequence[Array],
    weights: Sequence[Array],
    groups: Groups | None = None,
) -> SobolIndices:
    """Indices of f = sum_t c_t prod_j g_tj(x_j), of each input or of groups of inputs.

    coefficients  (T,)
    factors       d arrays (T, m_j): g_tj at the nodes of input j
    weights       d arrays (m_j,): quadrature weights of input j, each summing to 1
    """
    return sobol_indices_of_many(np.asarray(coefficients)[:, None], factors, weights, groups)[0]


def sobol_indices_of_many(
    coefficients: ArrayLike,
    factors: Sequence[Array],
    weights: Sequence[Array],
    groups: Groups | None = None,
) -> list[SobolIndices]:
    """Indices of functions with the same factors: coefficients (T, functions).

    Terms may be complex as long as each function is real.
    """
    c = np.asarray(coefficients)
    means = np.array([g @ w for g, w in zip(factors, weights, strict=True)])
    centred = [g - m[:, None] for g, m in zip(factors, means, strict=True)]
    if groups is None:
        variance, unexplained = _total_variances(c, means, centred, weights)
        alone, pairs = _low_order(c, means, centred, weights)
    else:
        variance, alone, unexplained, pairs = _of_groups(c, means, centred, weights, groups)
    base = means.prod(axis=0)
    # A variance within rounding of the terms' own size is that of a constant.
    floor = 1e-28 * (np.abs(c).T @ np.abs(base)) ** 2
    known = variance > floor
    share = np.where(known, 1.0 / np.where(known, variance, 1.0), 0.0)
    mean = (base @ c).real
    return [
        SobolIndices(
            alone[:, k] * share[k],
            unexplained[:, k] * share[k],
            pairs[:, :, k] * share[k],
            float(variance[k] * known[k]),
            float(mean[k]),
        )
        for k in range(c.shape[1])
    ]


def shifted(indices: SobolIndices, constant: float) -> SobolIndices:
    """Indices of the same function plus a constant."""
    return replace(indices, mean=indices.mean + constant)


def _low_order(
    c: Array, means: Array, centred: list[Array], weights: Sequence[Array]
) -> tuple[Array, Array]:
    """Var E[f | x_i] (d, functions) and the parts of pairs (d, d, functions)."""
    size = len(centred)
    varies = np.array([(g != g[:, :1]).any(axis=1) for g in centred])
    meet = varies.astype(int) @ varies.T
    alone, pairs = np.zeros((size, c.shape[1])), np.zeros((size, size, c.shape[1]))
    lone = _product_of_others(means)
    for i in range(size):
        alone[i] = ((c.T * lone[i]) @ centred[i]).real ** 2 @ weights[i]
        others = means.copy()
        others[i] = 1.0
        others = _product_of_others(others)
        for j in range(i):
            if meet[i, j]:  # else no term varies with both
                pairs[i, j] = pairs[j, i] = [
                    weights[i] @ ((centred[i].T * one) @ centred[j]).real ** 2 @ weights[j]
                    for one in c.T * others[j]
                ]
    return alone, pairs


def _product_of_others(rows: Array) -> Array:
    """For each row the product of all other rows, (d, T); no division, as rows may be zero."""
    before, after = np.ones_like(rows), np.ones_like(rows)
    np.cumprod(rows[:-1], axis=0, out=before[1:])
    np.cumprod(rows[:0:-1], axis=0, out=after[-2::-1])
    return before * after


def _of_groups(
    c: Array, means: Array, centred: Sequence[Array], weights: Sequence[Array], groups: Groups
) -> tuple[Array, Array, Array, Array]:
    """Var f (functions,), Var E[f | x_G], E[Var(f | all but x_G)] (g, functions), pairs.

    The factors of a group are products, so its covariances and second moments follow from
    those of its inputs, and the formulas of single inputs hold for it.
    """
    groups = [list(group) for group in groups]
    size, count = len(centred), len(groups)
    rests = [[j for j in range(size) if j not in group] for group in groups]
    joined = [_joined(group, means, centred, weights)[0] for group in groups]
    alone, unexplained = np.zeros((2, count, c.shape[1]))
    pairs = np.zeros((count, count, c.shape[1]))
    for g, rest in enumerate(rests):
        others, moments = _joined(rest, means, centred, weights)
        lone = means[rest].prod(axis=0)
        alone[g] = _quadratic(joined[g], lone[:, None] * c)
        unexplained[g] = _quadratic(joined[g] * moments, c)
        for h in range(g):
            lone = means[[j for j in rest if j not in groups[h]]].prod(axis=0)
            pairs[g, h] = pairs[h, g] = _quadratic(joined[g] * joined[h], lone[:, None] * c)
    variance = unexplained[-1] + _quadratic(others, means[groups[-1]].prod(axis=0)[:, None] * c)
    return variance, *(np.maximum(part, 0.0) for part in (alone, unexplained, pairs))


def _joined(
    inputs: Iterable[int], means: Array, centred: Sequence[Array], weights: Sequence[Array]
) -> tuple[Array, Array]:
    """Covariances and second moments (T, T) of the products of these inputs' factors."""
    count = means.shape[1]
    covariance, moments = np.zeros((count, count)), np.ones((count, count))
    for j in inputs:
        own, lone = _covariance(j, centred, weights), np.outer(means[j], means[j])
        covariance = covariance * lone + moments * own
        moments = moments * (own + lone)
    return covariance, moments


def _total_variances(
    c: Array, means: Array, centred: Sequence[Array], weights: Sequence[Array]
) -> tuple[Array, Array]:
    """Var f (functions,) and E[Var(f | all but x_i)] (d, functions).

    With C_j the covariances (T, T) of the factors of input j and M_j = C_j + m_j m_j'
    their second moments, E[Var(f | x_~i)] = c' (C_i o prod_{j != i} M_j) c. The covariances
    of the products over all inputs, whose quadratic form is Var f, are built up input by
    input, so that no large numbers are subtracted: see `_joined`.
    """
    size, shape = len(centred), (len(c), len(c))
    below, everything = [np.ones(shape)], np.zeros(shape)
    covariances = [_covariance(j, centred, weights) for j in range(size)]
    for own, mean in zip(covariances, means, strict=True):
        lone = np.outer(mean, mean)
        everything *= lone
        everything += below[-1] * own
        lone += own
        below.append(below[-1] * lone)
    above, unexplained = below.pop(), np.zeros((size, c.shape[1]))
    above.fill(1.0)
    for i in reversed(range(size)):
        own, varying = covariances.pop(), below.pop()
        varying *= own
        varying *= above
        unexplained[i] = np.maximum(_quadratic(varying, c), 0.0)
        own += np.outer(means[i], means[i])
        above *= own
    return _quadratic(everything, c), unexplained


def _covariance(j: int, centred: Sequence[Array], weights: Sequence[Array]) -> Array:
    """C_j (T, T) of one input's factors."""
    return np.asarray((centred[j] * weights[j]) @ centred[j].T)


def _quadratic(matrix: Array, c: Array) -> Array:
    """c_k' matrix c_k for each column of c (T, functions)."""
    return np.asarray((c * (matrix @ c)).sum(axis=0).real)
