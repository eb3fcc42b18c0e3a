"""Dependence that data show: a Gaussian copula from rank correlations.

Of a Gaussian copula with correlation c, Spearman's rank correlation is 6 / pi arcsin(c / 2)
(Kruskal 1958, J. Am. Stat. Assoc. 53, 814), so c = 2 sin(pi r / 6). Only pairs count whose
rank correlation is significant when all pairs are tested together (Holm 1979, Scand. J.
Stat. 6, 65). A matrix that is not positive definite has its eigenvalues raised.
"""

from __future__ import annotations

from itertools import combinations

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from surrogate.space.space import Space

Array = NDArray[np.float64]

#: Chance that any pair of independent inputs is taken to be correlated.
CHANCE = 0.01
#: Fewest different points from which dependence is read.
FEWEST = 10
#: Smallest eigenvalue that is left.
SMALLEST = 1e-3

Correlation = tuple[tuple[float, ...], ...]


def dependence(space: Space, coded: Array) -> Correlation | None:
    """The copula's correlation of points (run, parameter); None when no pair depends.

    Named levels have no rank, so they take no part. Replicates count once.
    """
    points = np.unique(coded, axis=0)
    pairs = [
        (i, j)
        for i, j in combinations(range(space.size), 2)
        if not (space.parameters[i].categorical or space.parameters[j].categorical)
    ]
    if len(points) < FEWEST or not pairs:
        return None
    found = [stats.spearmanr(points[:, i], points[:, j]) for i, j in pairs]
    sure = holm(np.array([one.pvalue for one in found]), CHANCE)
    if not sure.any():
        return None
    matrix = np.eye(space.size)
    for (i, j), one, counts in zip(pairs, found, sure, strict=True):
        if counts:
            matrix[i, j] = matrix[j, i] = 2.0 * np.sin(np.pi * one.statistic / 6.0)
    return tuple(tuple(row) for row in positive_definite(matrix).tolist())


def holm(p: Array, chance: float) -> NDArray[np.bool_]:
    """Which hypotheses of probabilities p (m,) are rejected, the chance of any error bounded."""
    order = np.argsort(np.nan_to_num(p, nan=1.0))
    limits = chance / (len(p) - np.arange(len(p)))
    failed = ~(p[order] <= limits)
    first = int(np.argmax(failed)) if failed.any() else len(p)
    rejected = np.zeros(len(p), dtype=bool)
    rejected[order[:first]] = True
    return rejected


def positive_definite(matrix: Array) -> Array:
    """A correlation matrix near `matrix` whose eigenvalues are about `SMALLEST` or more."""
    values, vectors = np.linalg.eigh(matrix)
    if values[0] >= SMALLEST:
        return matrix
    raised = (vectors * np.maximum(values, SMALLEST)) @ vectors.T
    size = np.sqrt(np.diag(raised))
    result = raised / np.outer(size, size)
    np.fill_diagonal(result, 1.0)
    return np.asarray((result + result.T) / 2.0)


def correlated_pairs(space: Space) -> list[tuple[str, str, float]]:
    """Names and correlation of the pairs of a space, the most correlated first."""
    if space.correlation is None:
        return []
    matrix = np.asarray(space.correlation)
    pairs = [(i, j) for i, j in combinations(range(space.size), 2) if abs(matrix[i, j]) > 1e-12]
    pairs.sort(key=lambda pair: -abs(matrix[pair]))
    return [(space.names[i], space.names[j], float(matrix[i, j])) for i, j in pairs]
