"""Displacements that align fields with templates along one of their dimensions.

A field f (rows, m) over places r is aligned with a template t by a displacement u,

    minimise  sum (f(r + u(r)) - t(r))^2 + weight * |differences of u's coefficients|^2,

u being a tensor product of cubic B-splines with few coefficients: landmark-free registration with a
smooth warp (Ramsay and Silverman, Functional Data Analysis, 2nd ed. 2005, chapter 7), by the
method of Gauss and Newton, for all runs at once. Rows are the other dimensions, flattened.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import BSpline, CubicSpline

Array = NDArray[np.float64]

#: Coefficients of a displacement along the moving dimension, and along each other one.
ALONG, ACROSS = 12, 10
#: Weight of smoothness, as a multiple of the mean curvature of the sum of squares.
STIFFNESS = 1.0
#: Part of that weight that draws the displacement itself to zero.
RIDGE = 0.02
#: Steps of Gauss and Newton, and the longest one as a share of the dimension's length.
STEPS, LONGEST = 6, 0.03
#: Steps that invert r + u(r): they converge while u's slope is below 1.
INVERSION = 12


@dataclass(frozen=True, eq=False)
class Rows:
    """Fields (n, rows, m) on an even grid, as cubic splines along it; constant beyond its ends."""

    grid: Array
    coefficients: Array

    @classmethod
    def through(cls, grid: Array, fields: Array) -> Rows:
        """Splines through fields (n, rows, m) at the grid (m,)."""
        return cls(grid, CubicSpline(grid, fields, axis=-1).c)

    def at(self, places: Array) -> tuple[Array, Array]:
        """Values and slopes (n, rows, k) at places (n, rows, k)."""
        low, high = self.grid[0], self.grid[-1]
        inside = np.clip(places, low, high)
        step = self.grid[1] - low
        number = np.minimum(((inside - low) / step).astype(np.intp), len(self.grid) - 2)
        along = inside - (low + step * number)
        run = np.arange(places.shape[0])[:, None, None]
        row = np.arange(places.shape[1])[None, :, None]
        a, b, c, d = (part[number, run, row] for part in self.coefficients)
        slopes = (3.0 * a * along + 2.0 * b) * along + c
        return ((a * along + b) * along + c) * along + d, np.where(inside == places, slopes, 0.0)


@dataclass(frozen=True, eq=False)
class Basis:
    """Displacements = across @ coefficients @ along'; across (rows, p), along (m, q)."""

    across: Array
    along: Array
    penalty: Array

    @classmethod
    def of(cls, others: tuple[int, ...], size: int) -> Basis:
        """For fields over other dimensions of these sizes and a moving one of `size` places."""
        parts = [_splines(one, ACROSS) for one in others]
        across: Array = np.ones((1, 1))
        for part in parts:
            across = np.asarray(np.kron(across, part), dtype=np.float64)
        along = _splines(size, ALONG)
        rough = [_roughness(part.shape[1]) for part in [*parts, along]]
        sizes = [len(one) for one in rough]
        penalty = RIDGE * np.eye(int(np.prod(sizes)))
        for k, one in enumerate(rough):
            before, after = int(np.prod(sizes[:k])), int(np.prod(sizes[k + 1 :]))
            penalty += np.kron(np.kron(np.eye(before), one), np.eye(after))
        return cls(across, along, penalty)

    def displacements(self, coefficients: Array) -> Array:
        """u (n, rows, m) of coefficients (n, p, q)."""
        return np.asarray(self.across @ coefficients @ self.along.T)

    def products(self, weights: Array) -> Array:
        """J' diag(weights) J (n, pq, pq) of weights (n, rows, m), J the displacements' basis."""
        n, (rows, p), (m, q) = len(weights), self.across.shape, self.along.shape
        along = (self.along[:, :, None] * self.along[:, None, :]).reshape(m, q * q)
        across = (self.across[:, :, None] * self.across[:, None, :]).reshape(rows, p * p)
        found = across.T @ (weights @ along)
        return np.ascontiguousarray(
            found.reshape(n, p, p, q, q).transpose(0, 1, 3, 2, 4).reshape(n, p * q, p * q)
        )

    def along_residuals(self, residuals: Array) -> Array:
        """J' residuals (n, pq) of residuals (n, rows, m)."""
        return np.asarray(self.across.T @ residuals @ self.along).reshape(len(residuals), -1)


def register(fields: Rows, templates: Array, basis: Basis, start: Array) -> Array:
    """Coefficients (n, p, q) that align fields with templates (n, rows, m), from `start`."""
    found = start.reshape(len(start), -1).copy()
    longest = LONGEST * (fields.grid[-1] - fields.grid[0])
    for _ in range(STEPS):
        values, slopes = fields.at(fields.grid + basis.displacements(found.reshape(start.shape)))
        matrix = basis.products(slopes**2)
        curvature = float(np.einsum("kii->k", matrix).mean()) / matrix.shape[1]
        if curvature <= 0.0:  # fields without slopes: nothing moves
            break
        stiff = STIFFNESS * curvature * basis.penalty
        pull = basis.along_residuals(slopes * (templates - values)) - found @ stiff
        step = np.linalg.solve(matrix + stiff, pull[:, :, None])[:, :, 0]
        found += np.clip(step, -longest, longest)
    return found.reshape(start.shape)


def origins(grid: Array, displacements: Array, places: Array) -> Array:
    """r (n, rows, k) with r + u(r) = places (n, 1 or rows, k); u (n, rows, m) on the even grid."""
    lines = Rows(grid, _straight(grid, displacements))
    places = np.broadcast_to(places, (*displacements.shape[:2], places.shape[-1]))
    found = places
    for _ in range(INVERSION):
        found = places - lines.at(found)[0]
    return found


def _straight(grid: Array, values: Array) -> Array:
    """Coefficients of straight lines between values (n, rows, m), as those of cubic splines."""
    turned = np.moveaxis(values, -1, 0)
    slopes = np.diff(turned, axis=0) / (grid[1] - grid[0])
    return np.stack([np.zeros_like(slopes), np.zeros_like(slopes), slopes, turned[:-1]])


def _splines(size: int, most: int) -> Array:
    """Cubic B-splines (size, k) at evenly spaced places, of lower degree for few places."""
    count = min(most, size)
    degree = min(3, count - 1)
    inner = np.linspace(0.0, 1.0, count - degree + 1)
    knots = np.concatenate([np.zeros(degree), inner, np.ones(degree)])
    matrix = BSpline.design_matrix(np.linspace(0.0, 1.0, size), knots, degree)
    return np.asarray(matrix.toarray(), dtype=np.float64)


def _roughness(size: int) -> Array:
    """D'D (size, size) of differences D between neighbouring coefficients."""
    differences = np.diff(np.eye(size), axis=0)
    return np.asarray(differences.T @ differences)
