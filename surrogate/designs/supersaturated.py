"""Supersaturated design: two levels, fewer runs than parameters, columns as different as can be.

The criterion is E(s^2), the mean square of the products x_i' x_j over all pairs of columns (Booth
and Cox 1962, doi 10.1080/00401706.1962.10490034). For m balanced columns of n runs it is at least

    n^2 (m - n + 1) / ((m - 1) (n - 1))       (Nguyen 1996, Technometrics 38, 69)

for m > n - 1. The search begins with the rows of a Hadamard matrix of order 2 n where one column is
+1 (Lin 1993, Technometrics 35, 28), whose 2 n - 2 columns reach the bound, or with
random columns, and exchanges a high and a low level within a column as long as that helps
(columnwise-pairwise exchange, Li and Wu 1997, Technometrics 39, 171).
"""

from __future__ import annotations

from math import comb

import numpy as np
from numpy.typing import NDArray

from surrogate.designs.design import searching
from surrogate.designs.plackett_burman import constructible, hadamard
from surrogate.designs.requirements import affordable, two_level, uncut, whole
from surrogate.errors import DesignError
from surrogate.space.space import Space

Array = NDArray[np.float64]

#: Passes over all columns at most.
PASSES = 100


def checked(space: Space, *, runs: int, starts: int = 200, **_: object) -> int:
    """Number of runs that these options give; raises `DesignError`."""
    two_level(space, "supersaturated")
    runs, columns = whole("runs", runs, 4), space.size
    whole("starts", starts, 1)
    affordable(runs * columns, "supersaturated", "lower runs")
    if runs % 2:
        raise DesignError(
            f"runs: {runs} must be even, so that both levels of a parameter are run equally often"
        )
    if columns < runs:
        raise DesignError(
            f"runs: {runs} are enough to estimate all {columns} main effects; use plackett_burman"
        )
    if columns > comb(runs, runs // 2) // 2:
        raise DesignError(
            f"runs: {runs} have only {comb(runs, runs // 2) // 2} different columns for {columns} "
            "parameters; give more runs"
        )
    return runs


@searching(checked)
def supersaturated(
    space: Space, *, runs: int, starts: int = 200, seed: int | None = None
) -> NDArray[np.float64]:
    """`runs` rows of -1 and 1, coded (run, parameter), fewer than parameters.

    runs    an even number, not above the number of parameters
    starts  searches, of which the best counts

    For many parameters of which few matter: analyse it with `stepwise` or `lasso`. Raises
    `DesignError` where a design with as many runs as coefficients exists.
    """
    checked(space, runs=runs, starts=starts)
    rng = np.random.default_rng(seed)
    found = [_improved(_start(runs, space.size, k % 2 == 0, rng), rng) for k in range(starts)]
    return uncut(space, min(found, key=_worth), "supersaturated")


def _worth(columns: Array) -> tuple[int, float]:
    """Pairs of columns that are equal or opposite, then E(s^2)."""
    products = np.abs(columns.T @ columns)
    twins = int((products > len(columns) - 0.5).sum()) - columns.shape[1]
    return twins, mean_square(columns)


def mean_square(columns: Array) -> float:
    """E(s^2) of columns (n, m)."""
    products = columns.T @ columns
    m = len(products)
    return float(((products**2).sum() - (products.diagonal() ** 2).sum()) / (m * (m - 1)))


def _start(runs: int, size: int, half: bool, rng: np.random.Generator) -> Array:
    """Balanced columns (runs, size): of half a Hadamard matrix if asked, the others random."""
    columns = np.empty((runs, 0))
    if half and constructible(2 * runs):
        matrix = hadamard(2 * runs)
        matrix = matrix * matrix[:, :1]  # the first column is +1
        there = matrix[matrix[:, 1] > 0.0, 2:]
        columns = there[:, rng.permutation(there.shape[1])[:size]]
    more = size - columns.shape[1]
    usual = np.repeat([1.0, -1.0], runs // 2)
    random = [rng.permutation(usual) for _ in range(more)]
    return np.column_stack([columns, *random])


def _improved(columns: Array, rng: np.random.Generator) -> Array:
    """Exchanges within columns until no single one lowers E(s^2)."""
    for _ in range(PASSES):
        before = mean_square(columns)
        for j in rng.permutation(columns.shape[1]):
            while _exchange(columns, j):
                pass
        if mean_square(columns) >= before - 1e-9:
            break
    return columns


def _exchange(columns: Array, j: int) -> bool:
    """The best exchange of two levels within column j, done; False when none helps.

    With s = X' x_j over the other columns X and G = X X', exchanging the runs p (high) and q
    (low) changes s' s by 4 (X s)_q - 4 (X s)_p + 4 (G_pp + G_qq - 2 G_pq).
    """
    others, own = np.delete(columns, j, axis=1), columns[:, j]
    along, gram = others @ (others.T @ own), others @ others.T
    high, low = np.flatnonzero(own > 0.0), np.flatnonzero(own < 0.0)
    size = gram.diagonal()
    change = along[low][None, :] - along[high][:, None]
    change += size[high][:, None] + size[low][None, :] - 2.0 * gram[np.ix_(high, low)]
    p, q = np.unravel_index(int(change.argmin()), change.shape)
    if change[p, q] >= -1e-9:
        return False
    columns[high[p], j], columns[low[q], j] = -1.0, 1.0
    return True
