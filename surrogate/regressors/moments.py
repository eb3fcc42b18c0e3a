"""Least squares on many runs: sums of products in place of the runs themselves.

Of a model matrix A (n, p) only A'A (p, p) and A'y (p,) are needed, to choose terms as well as
to fit them. They are summed over blocks of rows, so that memory does not grow with n. Sums
for each fold give those without it by subtraction. Half of the digits are lost to squaring:
errors below 1e-8 of the outputs' spread are rounding.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import linalg

from surrogate.regressors.least_squares import LEVERAGE_TOLERANCE
from surrogate.regressors.orthogonal import Rows
from surrogate.regressors.pursuit import strongest

Array = NDArray[np.float64]
Folds = NDArray[np.intp]
#: Numbers of the model matrix that are held at once.
BLOCK = 4_000_000


@dataclass(frozen=True, eq=False)
class Moments:
    """Sums over runs.

    products  A'A (p, p); along A'y (p,); squares y'y
    runs      how many
    """

    products: Array
    along: Array
    squares: float
    runs: int

    def without(self, other: Moments) -> Moments:
        """The sums over the runs that are not among those of `other`."""
        return Moments(
            self.products - other.products,
            self.along - other.along,
            self.squares - other.squares,
            self.runs - other.runs,
        )

    def of(self, terms: list[int]) -> Moments:
        """The sums of some of the terms."""
        if terms == list(range(len(self.along))):
            return self
        chosen = np.array(terms)
        return Moments(
            self.products[chosen[:, None], chosen], self.along[terms], self.squares, self.runs
        )


def moments(rows: Rows, X: Array, y: Array, folds: Folds) -> list[Moments]:
    """Sums over the runs X (n, d), y (n,) of each fold 0, 1, ..."""
    return [_of_fold(rows, X[folds == k], y[folds == k]) for k in range(folds.max() + 1)]


def _of_fold(rows: Rows, X: Array, y: Array) -> Moments:
    products, along = np.zeros((len(rows), len(rows))), np.zeros(len(rows))
    for part in blocks(len(y), len(rows)):
        matrix = rows(X[part])
        products += matrix.T @ matrix
        along += matrix.T @ y[part]
    return Moments(products, along, float(y @ y), len(y))


def total(parts: list[Moments]) -> Moments:
    """The sums over the runs of all folds."""
    products = parts[0].products.copy()
    for one in parts[1:]:
        products += one.products
    return Moments(
        products,
        np.sum([one.along for one in parts], axis=0),
        sum(one.squares for one in parts),
        sum(one.runs for one in parts),
    )


def blocks(runs: int, terms: int) -> Iterator[slice]:
    """Slices of the runs, so that `BLOCK` numbers of the matrix are held at once."""
    step = max(BLOCK // terms, 1)
    for start in range(0, runs, step):
        yield slice(start, start + step)


@dataclass(frozen=True, eq=False)
class Path:
    """Terms in the order of orthogonal least squares, with A'A = R'R of these terms.

    order  numbers of the k terms; upper R (k, k); heights R^-T A'y (k,)
    """

    order: list[int]
    upper: Array
    heights: Array

    def errors(self, held_out: Moments) -> Array:
        """Squared errors (k,) on held-out runs of the fits by the first 1, 2, ... k terms."""
        own = held_out.of(self.order)
        turned = linalg.solve_triangular(self.upper, own.products, trans="T")
        turned = linalg.solve_triangular(self.upper, turned.T, trans="T")
        along = linalg.solve_triangular(self.upper, own.along, trans="T")
        weighted = turned * np.outer(self.heights, self.heights)
        fitted = np.cumsum(np.cumsum(weighted, axis=0), axis=1).diagonal()
        found = own.squares - 2.0 * np.cumsum(along * self.heights) + fitted
        return np.asarray(np.maximum(found, 0.0))


def path(given: Moments, steps: int) -> Path:
    """The first `steps` terms by orthogonal least squares (Chen, Billings, Luo 1989).

    The pivoted Cholesky factor of A'A whose pivot is the term that reduces the residual most;
    the first term comes first. O(steps^2 p), whatever the number of runs.
    """
    products, along = given.products, given.along.copy()
    squares = products.diagonal().copy()
    floor = 1e-10 * squares + 1e-300
    order: list[int] = []
    factor, heights = np.empty((steps, len(squares))), np.empty(steps)
    for k in range(steps):
        column = int(strongest(squares, along, floor)) if k else 0
        if column < 0:
            break
        size = np.sqrt(squares[column])
        heights[k] = along[column] / size
        factor[k] = (products[column] - factor[:k, column] @ factor[:k]) / size
        factor[k, order] = 0.0
        squares, along = squares - factor[k] ** 2, along - heights[k] * factor[k]
        squares[column] = 0.0
        order.append(column)
    k = len(order)
    return Path(order, np.triu(factor[:k, order]), heights[:k])


def best_count(parts: list[Moments], most: int) -> tuple[int, float]:
    """Number of terms, at most `most`, with the smallest squared error on folds, and that error.

    For each fold the terms are chosen without it. The error is a share of y'y.
    """
    whole = total(parts)
    steps = max(min(min(whole.runs - one.runs for one in parts) - 1, most), 1)
    steps = min(steps, len(whole.along))
    squares = np.zeros(steps)
    for one in parts:
        found = path(whole.without(one), steps).errors(one)
        squares[: len(found)] += found
        squares[len(found) :] += found[-1]
    count = int(squares.argmin()) + 1
    return count, float(squares[count - 1]) / whole.squares if whole.squares > 0.0 else 1.0


@dataclass(frozen=True, eq=False)
class FitOfMany:
    """A least squares fit that holds the runs' points and not their model matrix.

    rows           gives the model matrix (m, p) at points
    points (n, d), y (n,)
    coefficients (p,); upper (p, p) with A'A = R'R
    """

    rows: Rows
    points: Array
    y: Array
    coefficients: Array
    upper: Array

    def leave_one_out(self) -> Array:
        """Predictions (n,) of each run by the fit without it, y - e / (1 - h), by blocks."""
        found = np.empty(len(self.y))
        for part in blocks(len(self.y), len(self.coefficients)):
            matrix = self.rows(self.points[part])
            leverage = (linalg.solve_triangular(self.upper, matrix.T, trans="T") ** 2).sum(axis=0)
            errors = self.y[part] - matrix @ self.coefficients
            slack = 1.0 - leverage
            slack[slack < LEVERAGE_TOLERANCE] = np.nan
            found[part] = self.y[part] - errors / slack
        return found


def fit_of_many(rows: Rows, X: Array, y: Array) -> FitOfMany:
    """Fit y (n,) at points X (n, d) by independent terms, refined once for its last digits."""
    sums = _of_fold(rows, X, y)
    upper = linalg.cholesky(sums.products)
    coefficients = linalg.cho_solve((upper, False), sums.along)
    left = np.zeros(len(rows))
    for part in blocks(len(y), len(rows)):
        matrix = rows(X[part])
        left += matrix.T @ (y[part] - matrix @ coefficients)
    return FitOfMany(rows, X, y, coefficients + linalg.cho_solve((upper, False), left), upper)


def predicted(rows: Rows, X: Array, coefficients: Array) -> Array:
    """Values (m,) at points X (m, d), by blocks."""
    return np.concatenate([rows(X[part]) @ coefficients for part in blocks(len(X), len(rows))])
