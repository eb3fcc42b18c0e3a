"""Variances of conditional expectations of sums of products of orthonormal functions.

For f(x) = sum_m c_m prod_j phi_j,m(x_j) with independent inputs, functions of one input that
are orthonormal under its law, and their means mu,

    E[f | x_S] = sum_m c_m prod_{j in S} phi_j,m(x_j) prod_{j not in S} mu_j,m.

Terms that have the same functions of the inputs in S add up, so E[E[f | x_S]^2] is the sum of
squares of such sums: work in proportion to the number of terms, not to its square as in `anova`.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from surrogate.estimator import Groups
from surrogate.regressors.anova import SobolIndices

Array = NDArray[np.float64]

#: Products of numbers stay below this.
LARGEST = 2**62


@dataclass(frozen=True, eq=False)
class Products:
    """Products of one function of each input.

    numbers (terms, d)  which function of each input a term has
    means (terms, d)    the mean of that function
    """

    numbers: NDArray[np.intp]
    means: Array

    def conditional(self, inputs: Sequence[int], coefficients: Array) -> Array:
        """Coefficients (k, functions) of E[f | inputs] of functions (terms, functions).

        Some may be zero for all functions.
        """
        others = np.delete(self.means, inputs, axis=1).prod(axis=1)
        number, count = _numbered(self.numbers[:, inputs])
        terms = np.arange(len(others) + 1)
        sums = sparse.csc_array((others, number, terms), shape=(count, len(others)))
        return np.asarray(sums @ coefficients)


def _numbered(rows: NDArray[np.intp]) -> tuple[NDArray[np.intp], int]:
    """A number for each row (terms, k) of numbers, the same for equal rows, and their bound."""
    number, count = np.zeros(len(rows), dtype=np.intp), 1
    for column in rows.T:
        number, count = _few(number, count, LARGEST // (int(column.max()) + 1))
        number, count = number * (column.max() + 1) + column, count * (int(column.max()) + 1)
    return _few(number, count, 4 * len(rows))


def _few(number: NDArray[np.intp], count: int, most: int) -> tuple[NDArray[np.intp], int]:
    """The same with numbers below `most`, when there are more."""
    if count <= most:
        return number, count
    different, number = np.unique(number, return_inverse=True)
    return number, len(different)


def moved_indices(
    centre: SobolIndices, products: Products, mean: Array, deviations: Array, groups: Groups | None
) -> list[SobolIndices]:
    """Indices of a function plus deviations from it, of inputs or groups.

    centre                           indices of the function itself, for the same groups
    mean (terms,)                    its coefficients, for what it has in common with a deviation
    deviations (terms, deviations)   their coefficients
    """
    size = products.numbers.shape[1]
    of = [[j] for j in range(size)] if groups is None else [list(group) for group in groups]
    count, both = len(of), np.column_stack([mean, deviations])
    shift = products.conditional([], both)[0]

    def gain(inputs: Iterable[int]) -> Array:
        """What the variance of E[f | inputs] of each function exceeds that of the mean by."""
        parts = products.conditional(sorted(inputs), both)
        own, moved = parts[:, 0], parts[:, 1:]
        squares = 2.0 * (own @ moved) + np.einsum("ij,ij->j", moved, moved)
        return np.asarray(squares - shift[1:] * (2.0 * shift[0] + shift[1:]))

    everything, variance = set(range(size)), centre.variance
    whole = variance + gain(everything)
    alone = np.array([centre.first_order[g] * variance + gain(of[g]) for g in range(count)])
    total = np.array(
        [
            centre.total[g] * variance + whole - variance - gain(everything - set(of[g]))
            for g in range(count)
        ]
    )
    pairs = np.zeros((count, count, len(whole)))
    for g in range(count):
        for h in range(g):
            closed = centre.second_order[g, h] + centre.first_order[g] + centre.first_order[h]
            joint = closed * variance + gain([*of[g], *of[h]]) - alone[g] - alone[h]
            pairs[g, h] = pairs[h, g] = joint
    share = np.where(whole > 0.0, 1.0 / np.where(whole > 0.0, whole, 1.0), 0.0)
    first, rest, second = (np.maximum(part, 0.0) * share for part in (alone, total, pairs))
    return [
        SobolIndices(
            first[:, k], rest[:, k], second[:, :, k], float(whole[k]), centre.mean + shift[k + 1]
        )
        for k in range(len(whole))
    ]
