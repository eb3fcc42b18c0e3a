"""Exact Sobol' indices of sums of products.

For f(x) = sum_t c_t prod_j g_tj(x_j) with independent inputs every conditional
expectation factors into one-dimensional ones:

    E[f | x_S] = sum_t c_t prod_{j in S} g_tj(x_j) prod_{j not in S} E[g_tj]

(Sobol' 1993; Oakley and O'Hagan 2004, equations 10 to 12). With g_tj given at the
nodes of a quadrature of each input's law, the indices are exact to that quadrature.
Polynomials, polynomial chaos and the mean of a product-kernel Gaussian process have
this form.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from surrogate.errors import FitError
from surrogate.space import Space


@dataclass(frozen=True)
class SobolIndices:
    """Shares of the variance: first_order (d,), total (d,), second_order (d, d) symmetric.

    All zero for a constant function, whose variance is 0.
    """

    first_order: np.ndarray
    total: np.ndarray
    second_order: np.ndarray
    variance: float
    mean: float


def quadratures(space: Space | None, size: int, order: int) -> list[tuple]:
    """Nodes (m,) and weights (m,) for each input; without a space, uniform on [-1, 1]."""
    if space is None:
        nodes, weights = np.polynomial.legendre.leggauss(order)
        return [(nodes, weights / 2.0)] * size
    if not space.independent:
        raise FitError("closed-form Sobol' indices need independent parameters, but these are "
                       "correlated; use Shapley effects")
    return [parameter.quadrature(order) for parameter in space.parameters]


def sobol_indices(coefficients, factors, weights) -> SobolIndices:
    """Indices of f = sum_t c_t prod_j g_tj(x_j).

    coefficients  (T,)
    factors       d arrays (T, m_j): g_tj at the nodes of input j
    weights       d arrays (m_j,): quadrature weights of input j, each summing to 1
    """
    c = np.asarray(coefficients, dtype=float)
    means = np.array([g @ w for g, w in zip(factors, weights, strict=True)])
    centred = [g - m[:, None] for g, m in zip(factors, means, strict=True)]
    variance, unexplained = _total_variances(c, means, centred, weights)
    size = len(factors)
    mean = float(c @ means.prod(axis=0))
    # A variance within rounding of the terms' own size is that of a constant.
    if not variance > 1e-28 * float((np.abs(c) @ np.abs(means).prod(axis=0)) ** 2):
        return SobolIndices(np.zeros(size), np.zeros(size), np.zeros((size, size)), 0.0, mean)
    alone, pairs = np.zeros(size), np.zeros((size, size))
    for i in range(size):
        scaled = c * np.delete(means, i, axis=0).prod(axis=0)
        alone[i] = weights[i] @ (scaled @ centred[i]) ** 2
        for j in range(i):
            scaled = c * np.delete(means, [i, j], axis=0).prod(axis=0)
            surface = (centred[i].T * scaled) @ centred[j]
            pairs[i, j] = pairs[j, i] = weights[i] @ surface**2 @ weights[j]
    return SobolIndices(alone / variance, unexplained / variance, pairs / variance,
                        variance, mean)


def _total_variances(c, means, centred, weights) -> tuple[float, np.ndarray]:
    """Var f and E[Var(f | all but x_i)] (d,).

    With C_j the covariances (T, T) of the factors of input j and M_j = C_j + m_j m_j'
    their second moments, E[Var(f | x_~i)] = c' (C_i o prod_{j != i} M_j) c, and Var f
    telescopes over the inputs: sum_i c' (C_i o prod_{j < i} M_j o prod_{j > i} m_j m_j') c,
    so that no large numbers are subtracted.
    """
    size, variance = len(centred), 0.0
    below = [np.ones((len(c), len(c)))]
    for j in range(size - 1):
        below.append(below[-1] * _moments(centred[j], weights[j], means[j]))
    above, unexplained = np.outer(c, c), np.zeros(size)
    for i in reversed(range(size)):
        varying = ((centred[i] * weights[i]) @ centred[i].T) * below[i]
        unexplained[i] = max((varying * above).sum(), 0.0)
        fixed = c * means[i + 1:].prod(axis=0)
        variance += float(fixed @ varying @ fixed)
        above *= _moments(centred[i], weights[i], means[i])
    return variance, unexplained


def _moments(centred, weights, mean) -> np.ndarray:
    """E[g_t g_s] of one input's factors, shape (T, T)."""
    return (centred * weights) @ centred.T + np.outer(mean, mean)
