"""Polynomials orthonormal for the law of one parameter, and sets of their products.

Three-term recurrence by the discretised Stieltjes procedure (Gautschi 2004, section
2.2.3): beta[k+1] P_{k+1} = (x - alpha[k]) P_k - beta[k] P_{k-1}, P_0 = 1. Levels have
orthonormal contrasts instead, all of which count as degree 1.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from surrogate.space.space import Parameter

#: A product of polynomials: ((input, number), ...), numbers above 0; () is the constant.
Index = tuple[tuple[int, int], ...]


@dataclass(frozen=True, eq=False)
class Basis:
    """Functions P_0 = 1, P_1, ... of one coded input, orthonormal under its law.

    alpha (m,), beta (m + 1,) of the recurrence; or `contrasts` (k, k), row q the values
    of P_q at the k levels.
    """

    alpha: np.ndarray
    beta: np.ndarray
    contrasts: np.ndarray | None = None

    def __len__(self) -> int:
        return len(self.alpha) + 1 if self.contrasts is None else len(self.contrasts)

    def values(self, coded: np.ndarray) -> np.ndarray:
        """All functions at coded values (n,), shape (len(self), n)."""
        if self.contrasts is not None:
            last = len(self.contrasts) - 1
            index = np.clip(np.rint((coded + 1.0) / 2.0 * last), 0, last).astype(int)
            return self.contrasts[:, index]
        result = np.ones((len(self), len(coded)))
        before = np.zeros(len(coded))
        for k, alpha in enumerate(self.alpha):
            after = (coded - alpha) * result[k] - self.beta[k] * before
            before = result[k]
            result[k + 1] = after / self.beta[k + 1]
        return result

    def degree(self, number: int) -> int:
        """Polynomial degree that the function P_number counts as."""
        return min(number, 1) if self.contrasts is not None else number


def basis(parameter: Parameter | None, degree: int) -> Basis:
    """Functions up to `degree` for a parameter; for None, Legendre's on [-1, 1]."""
    if parameter is not None and parameter.categorical:
        return Basis(np.empty(0), np.empty(0), _contrasts(len(parameter.levels)))
    if parameter is None:
        x, w = np.polynomial.legendre.leggauss(degree + 1)
        return _stieltjes(x, w / 2.0, degree)
    nodes, weights = parameter.quadrature(degree + 1)
    if not parameter.continuous:  # k values carry polynomials up to degree k - 1
        degree = min(degree, len(nodes) - 1)
    return _stieltjes(nodes, weights, degree)


def _stieltjes(x: np.ndarray, w: np.ndarray, degree: int) -> Basis:
    alpha, beta = np.zeros(degree), np.zeros(degree + 1)
    before, now = np.zeros_like(x), np.ones_like(x)
    for k in range(degree):
        alpha[k] = w @ (x * now**2)
        after = (x - alpha[k]) * now - beta[k] * before
        beta[k + 1] = np.sqrt(w @ after**2)
        before, now = now, after / beta[k + 1]
    return Basis(alpha, beta)


def _contrasts(levels: int) -> np.ndarray:
    """Helmert contrasts with the constant first, rows orthonormal in the mean, (k, k)."""
    rows = [np.ones(levels)]
    for q in range(1, levels):
        row = np.zeros(levels)
        row[:q], row[q] = -1.0, q
        rows.append(row * np.sqrt(levels / (q * (q + 1.0))))
    return np.array(rows)


@lru_cache(maxsize=64)
def hyperbolic(sizes: tuple[tuple[int, ...], ...], degree: int, q: float) -> tuple[Index, ...]:
    """Products with (sum_i degree_i^q)^(1/q) <= degree (Blatman and Sudret 2011, equation 10).

    sizes[i] holds the degree of each function of input i but the constant. q = 1 is the
    total degree; smaller q leaves out interactions of high order. In order of total degree.
    """
    budget = degree**q + 1e-9
    found: list[Index] = []

    def extend(index: Index, start: int, left: float) -> None:
        found.append(index)
        for i in range(start, len(sizes)):
            for number, size in enumerate(sizes[i], start=1):
                if size**q <= left:
                    extend((*index, (i, number)), i + 1, left - size**q)

    extend((), 0, budget)
    return tuple(sorted(found, key=lambda index: sum(sizes[i][n - 1] for i, n in index)))


def products(indices: tuple[Index, ...], values: list[np.ndarray]) -> np.ndarray:
    """Products (n, p) from the functions' values, one (m_i, n) array for each input."""
    result = np.ones((values[0].shape[1], len(indices)), order="F")
    for t, index in enumerate(indices):
        for i, number in index:
            result[:, t] *= values[i][number]
    return result


@dataclass(frozen=True, eq=False)
class Rows:
    """The model matrix (m, p) of products at coded points (m, d), as a function."""

    bases: tuple[Basis, ...]
    indices: tuple[Index, ...]

    def __call__(self, X: np.ndarray) -> np.ndarray:
        return products(self.indices, [one.values(X[:, i]) for i, one in enumerate(self.bases)])

    def __len__(self) -> int:
        return len(self.indices)
