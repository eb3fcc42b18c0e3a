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

from dataclasses import dataclass, replace

import numpy as np

from surrogate.errors import FitError
from surrogate.space import Space


@dataclass(frozen=True, eq=False)
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
    """Nodes (m,) and weights (m,) of each input's law, for independent inputs.

    Without a space, uniform on [-1, 1]. Raises `FitError` when inputs are correlated.
    """
    if space is not None and not space.independent:
        raise FitError("closed-form Sobol' indices need independent parameters, but these are "
                       "correlated; use Shapley effects")
    return marginals(space, size, order)


def marginals(space: Space | None, size: int, order: int) -> list[tuple]:
    """Nodes (m,) and weights (m,) of each input's law, whatever joins the inputs."""
    if space is None:
        nodes, weights = np.polynomial.legendre.leggauss(order)
        return [(nodes, weights / 2.0)] * size
    return [parameter.quadrature(order) for parameter in space.parameters]


def sobol_indices(coefficients, factors, weights) -> SobolIndices:
    """Indices of f = sum_t c_t prod_j g_tj(x_j).

    coefficients  (T,)
    factors       d arrays (T, m_j): g_tj at the nodes of input j
    weights       d arrays (m_j,): quadrature weights of input j, each summing to 1
    """
    return sobol_indices_of_many(np.asarray(coefficients)[:, None], factors, weights)[0]


def sobol_indices_of_many(coefficients, factors, weights) -> list[SobolIndices]:
    """Indices of functions with the same factors: coefficients (T, functions).

    Terms may be complex as long as each function is real.
    """
    c, size = np.asarray(coefficients), len(factors)
    means = np.array([g @ w for g, w in zip(factors, weights, strict=True)])
    centred = [g - m[:, None] for g, m in zip(factors, means, strict=True)]
    variance, unexplained = _total_variances(c, means, centred, weights)
    alone, pairs = np.zeros((size, c.shape[1])), np.zeros((size, size, c.shape[1]))
    for i in range(size):
        scaled = c.T * np.delete(means, i, axis=0).prod(axis=0)
        alone[i] = (scaled @ centred[i]).real ** 2 @ weights[i]
        for j in range(i):
            scaled = c.T * np.delete(means, [i, j], axis=0).prod(axis=0)
            pairs[i, j] = pairs[j, i] = [
                weights[i] @ ((centred[i].T * one) @ centred[j]).real ** 2 @ weights[j]
                for one in scaled]
    base = means.prod(axis=0)
    # A variance within rounding of the terms' own size is that of a constant.
    floor = 1e-28 * (np.abs(c).T @ np.abs(base)) ** 2
    known = variance > floor
    share = np.where(known, 1.0 / np.where(known, variance, 1.0), 0.0)
    mean = (base @ c).real
    return [SobolIndices(alone[:, k] * share[k], unexplained[:, k] * share[k],
                         pairs[:, :, k] * share[k], float(variance[k] * known[k]),
                         float(mean[k])) for k in range(c.shape[1])]


def shifted(indices: SobolIndices, constant: float) -> SobolIndices:
    """Indices of the same function plus a constant."""
    return replace(indices, mean=indices.mean + constant)


def _total_variances(c, means, centred, weights) -> tuple[np.ndarray, np.ndarray]:
    """Var f (functions,) and E[Var(f | all but x_i)] (d, functions).

    With C_j the covariances (T, T) of the factors of input j and M_j = C_j + m_j m_j'
    their second moments, E[Var(f | x_~i)] = c' (C_i o prod_{j != i} M_j) c, and Var f
    telescopes over the inputs: sum_i c' (C_i o prod_{j < i} M_j o prod_{j > i} m_j m_j') c,
    so that no large numbers are subtracted.
    """
    size, variance = len(centred), np.zeros(c.shape[1])
    below = [np.ones((len(c), len(c)))]
    for j in range(size - 1):
        below.append(below[-1] * _moments(centred[j], weights[j], means[j]))
    above, unexplained = np.ones((len(c), len(c))), np.zeros((size, c.shape[1]))
    for i in reversed(range(size)):
        varying = ((centred[i] * weights[i]) @ centred[i].T) * below[i]
        unexplained[i] = np.maximum(_quadratic(varying * above, c), 0.0)
        variance += _quadratic(varying, means[i + 1:].prod(axis=0)[:, None] * c)
        above = above * _moments(centred[i], weights[i], means[i])
    return variance, unexplained


def _quadratic(matrix, c) -> np.ndarray:
    """c_k' matrix c_k for each column of c (T, functions)."""
    return (c * (matrix @ c)).sum(axis=0).real


def _moments(centred, weights, mean) -> np.ndarray:
    """E[g_t g_s] of one input's factors, shape (T, T)."""
    return (centred * weights) @ centred.T + np.outer(mean, mean)
