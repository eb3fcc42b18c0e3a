"""The product Matern 5/2 correlation.

    k(x, x') = prod_j m(|x_j - x'_j| / l_j),   m(r) = (1 + s + s^2 / 3) exp(-s),  s = sqrt(5) r

one length l_j for each column (Rasmussen and Williams 2006, equation 4.17; products of
it as in Roustant, Ginsbourger, Deville 2012, DiceKriging). A product, and not the
radial form, has exact Sobol' indices.

It is evaluated as exp(-sum_j s_j) prod_j (s_j (s_j + 3) + 3) / 3^c: one exponential for all
c columns and seven passes over the numbers a column, each rounded once where s_j is small.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

ROOT5 = np.sqrt(5.0)
#: Correlations evaluated at once: small enough to stay in the cache.
BLOCK = 24_000


def correlation(a: Array, b: Array, lengths: Array) -> Array:
    """Correlations (m, n) of points a (m, c) and b (n, c); lengths (c,)."""
    result = np.empty((len(a), len(b)))
    for part, block in blocks(a, b, lengths):
        np.divide(block, 3.0 ** len(lengths), out=result[part])
    return result


def paired(a: Array, b: Array, lengths: Array) -> Array:
    """Correlations of points (..., c) that broadcast against each other."""
    product: Array = np.ones(np.broadcast_shapes(a.shape[:-1], b.shape[:-1]))
    distance = np.zeros_like(product)
    for j, length in enumerate(lengths):
        s = np.abs(a[..., j] - b[..., j]) * (ROOT5 / length)
        distance += s
        product *= (s + 3.0) * s + 3.0
    product *= np.exp(-distance)
    return product / 3.0 ** len(lengths)


def weighted_sum(points: Array, centres: Array, lengths: Array, weights: Array) -> Array:
    """sum_i weights[i] k(point, centre_i) at points (m, c), in blocks that fit the cache.

    weights (n,) or (n, draws); returns (m,) or (m, draws).
    """
    result = np.empty((len(points), *weights.shape[1:]))
    for part, block in blocks(points, centres, lengths):
        result[part] = block @ weights
    result /= 3.0 ** len(lengths)
    return result


def blocks(a: Array, b: Array, lengths: Array) -> Iterator[tuple[slice, Array]]:
    """Correlations times 3^c of points a (m, c) and b (n, c), some rows (k, n) at a time.

    The memory of a block is used again for the next one.
    """
    a, b = (np.ascontiguousarray((points * (ROOT5 / lengths)).T) for points in (a, b))
    step = max(min(BLOCK // max(b.shape[1], 1), a.shape[1]), 1)
    memory = np.empty((4, step, b.shape[1]))
    for start in range(0, a.shape[1], step):
        part = slice(start, start + step)
        rows = a[:, part]
        yield part, _block(rows, b, *memory[:, : rows.shape[1]])


def _block(a: Array, b: Array, result: Array, s: Array, factor: Array, total: Array) -> Array:
    """3^c times the correlations (k, n) of scaled points (c, k) and (c, n), in `result`."""
    result.fill(1.0)
    total.fill(0.0)
    for x, centre in zip(a, b, strict=True):
        np.subtract.outer(x, centre, out=s)
        np.abs(s, out=s)
        total += s
        np.add(s, 3.0, out=factor)
        factor *= s
        factor += 3.0
        result *= factor
    np.negative(total, out=total)
    np.exp(total, out=total)
    result *= total
    return result
