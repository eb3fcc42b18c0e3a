"""Closest points on a smooth surface: Newton on (x - y) . y_a = 0 in its two parameters.

The derivative is a - d . y_ab with d = x - y and the metric a (Wriggers 2006, ch. 4).
Surfaces and their jets: the first lines of this chapter.
"""

from __future__ import annotations

import numpy as np


def project(surface, points, x, xi, tolerance=1e-11, iterations=30):
    """Closest-point parameters (n, 2) of points (n, 3), by Newton from xi.

    A step is limited to one cell; `residual` of the caller tells when it did not close.
    """
    xi = xi.copy()
    for _ in range(iterations):
        jet = surface.at(xi, x)
        d = points - jet[:, 0]
        step = solve2(metric(jet, d), np.einsum("pc,pac->pa", d, jet[:, 1:3]))
        step = np.clip(step, -1.0, 1.0)
        xi += step
        if np.abs(step).max(initial=0.0) < tolerance:
            break
    return xi


def metric(jet, d):
    """a - d . y_ab, (n, 2, 2), for d (n, 3) from the point of the jet (n, 6, 3)."""
    matrix = np.einsum("pac,pbc->pab", jet[:, 1:3], jet[:, 1:3])
    bend = np.einsum("pc,pkc->pk", d, jet[:, 3:])
    matrix[:, 0, 0] -= bend[:, 0]
    matrix[:, 1, 1] -= bend[:, 1]
    matrix[:, 0, 1] -= bend[:, 2]
    matrix[:, 1, 0] -= bend[:, 2]
    return matrix


def solve2(matrix, rhs):
    """Solutions (n, 2[, m]) of 2 x 2 systems (n, 2, 2), by Cramer's rule."""
    (a, b), (c, d) = matrix.transpose(1, 2, 0)
    det = a * d - b * c
    inverse = np.stack([d, -b, -c, a]).reshape(2, 2, -1) / det
    return np.einsum("abp,pb...->pa...", inverse, rhs)
