"""One-dimensional local interpolation weights and their tensor products.

`bspline` cardinal quadratic B-spline: three control points a cell, C1, not interpolating

`cubic_convolution` with a = -1/2 (Keys 1981, eq. 4): four nodes a cell, C1, interpolates its
nodes and reproduces quadratics

Each returns the weights and their first and second derivatives for t in [0, 1]
inside a cell; arrays (3 or 4, n).
"""

from __future__ import annotations

import numpy as np


def bspline(t):
    """Weights (3, n), first and second derivatives of the quadratic B-spline."""
    one = np.ones_like(t)
    N = np.stack([(1 - t) ** 2 / 2, (1 + 2 * t - 2 * t * t) / 2, t * t / 2])
    return N, np.stack([t - 1, 1 - 2 * t, t]), np.stack([one, -2 * one, one])


def cubic_convolution(t):
    """Weights (4, n), first and second derivatives of the Keys cubic (Catmull-Rom)."""
    N = np.stack(
        [
            ((2 - t) * t - 1) * t / 2,
            ((3 * t - 5) * t * t + 2) / 2,
            ((4 - 3 * t) * t + 1) * t / 2,
            (t - 1) * t * t / 2,
        ]
    )
    D = np.stack(
        [
            ((4 - 3 * t) * t - 1) / 2,
            (9 * t - 10) * t / 2,
            ((8 - 9 * t) * t + 1) / 2,
            (3 * t - 2) * t / 2,
        ]
    )
    return N, D, np.stack([2 - 3 * t, 9 * t - 5, 4 - 9 * t, 3 * t - 1])


def tensor(first, second):
    """Product weights of two directions, each ``(N, N', N'')`` of shape (k, n).

    Returns (6, n, k1 * k2): value, d1, d2, d11, d22, d12; the second index runs fastest.
    """
    (A, A1, A2), (B, B1, B2) = first, second
    pairs = ((A, B), (A1, B), (A, B1), (A2, B), (A, B2), (A1, B1))
    n = A.shape[1]
    size = A.shape[0] * B.shape[0]
    return np.stack([np.einsum("an,bn->nab", a, b).reshape(n, size) for a, b in pairs])


def gather(nodes, weights, x):
    """Jet (n, 6, 3) from nodes (n, k), weights (6, n, k) and positions x (nodes, 3)."""
    return np.matmul(weights.transpose(1, 0, 2), x[nodes])
