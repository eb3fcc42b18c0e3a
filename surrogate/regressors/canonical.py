"""Canonical analysis of a quadratic: its stationary point, its kind, and the way to it.

With y = b0 + b'x + x'Bx in coded values, the stationary point is xs = -B^-1 b / 2, and

    y = ys + sum lambda_i w_i^2

along the eigenvectors of B: a maximum where all eigenvalues are negative, a minimum where all
are positive, else a saddle (Box and Wilson 1951; Montgomery 2012, section 11.3). The standard
error of lambda_i is that of v_i'Bv_i at fixed v_i (Bisgaard and Ankenman 1996,
doi 10.1080/00401706.1996.10484500). Ridge analysis gives the best points at each distance from
the centre: (B - mu I) x = -b / 2 (Draper 1963).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import optimize, stats

from surrogate.regressors.columns import Column, Term
from surrogate.regressors.least_squares import LeastSquares

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Canonical:
    """A second-order polynomial about its stationary point, in coded values.

    parameters  numbers of the parameters (d,) of its coordinates
    linear      b (d,)
    squares     B (d, d), symmetric
    stationary  xs (d,)
    values      eigenvalues (d,), the smallest first; errors: their half-widths, NaN when unknown
    axes        eigenvectors in columns (d, d)
    """

    parameters: tuple[int, ...]
    linear: Array
    squares: Array
    stationary: Array
    values: Array
    errors: Array
    axes: Array

    @property
    def kind(self) -> str:
        """maximum, minimum, saddle; `ridge` when an eigenvalue cannot be told from zero."""
        errors = np.nan_to_num(self.errors)
        if (np.abs(self.values) <= errors).any():
            return "ridge"
        if (self.values < 0.0).all():
            return "maximum"
        return "minimum" if (self.values > 0.0).all() else "saddle"

    @property
    def inside(self) -> bool:
        """Whether the stationary point lies in the ranges."""
        return bool((np.abs(self.stationary) <= 1.0).all())

    def ridge(self, radius: float, *, largest: bool) -> Array:
        """The point (d,) at this distance from the centre where the polynomial is largest.

        largest: False for smallest. With mu above all eigenvalues the distance falls as mu
        grows, from the stationary pole to zero.
        """
        sign = 1.0 if largest else -1.0
        values = sign * self.values
        pull = np.asarray(sign * self.axes.T @ self.linear / 2.0)
        top = values.max()
        span = float(np.linalg.norm(pull)) / radius

        def excess(mu: float) -> float:
            return float(np.linalg.norm(pull / (mu - values))) - radius

        low = top + 1e-9 * max(span, abs(top), 1e-300)
        if excess(low) <= 0.0:  # no pull along the steepest axis: what is missing goes there
            rest = pull / np.where(values < top, low - values, np.inf)
            rest[int(values.argmax())] = np.sqrt(max(radius**2 - float(rest @ rest), 0.0))
            return np.asarray(self.axes @ rest)
        mu = optimize.brentq(excess, low, top + span + 1e-9 * abs(top), xtol=1e-13, rtol=1e-13)
        return np.asarray(self.axes @ (pull / (mu - values)))

    def at(self, x: Array) -> float:
        """Value at x (d,) less the constant."""
        return float(self.linear @ x + x @ self.squares @ x)


def canonical(
    terms: Sequence[Term], columns: Sequence[Column], model: LeastSquares, confidence: float = 0.95
) -> Canonical | None:
    """Of a fit; None unless it has the square of every numeric parameter and no levels.

    None, too, where the runs cannot tell its terms apart, or a square is missing.
    """
    count = len(columns)
    if any(column.levels for column in columns) or not model.estimable.all():
        return None
    places = {term: k for k, term in enumerate(terms)}
    highest = max((sum(power for _, power in term) for term in terms), default=0)
    if highest != 2 or not all(((j, 2),) in places and ((j, 1),) in places for j in range(count)):
        return None
    linear = np.array([model.coefficients[places[((j, 1),)]] for j in range(count)])
    weights = _weights(terms, count)
    squares = np.einsum("t,tij->ij", model.coefficients, weights)
    values, axes = np.linalg.eigh(squares)
    if np.abs(values).min() <= 1e-12 * max(
        float(np.abs(values).max()), float(np.abs(linear).max())
    ):
        return None  # flat along an axis: no stationary point
    along = np.einsum("tij,ik,jk->kt", weights, axes, axes)[:, model.kept]
    errors = np.full(count, np.nan)
    if model.freedom:
        quantile = stats.t.ppf(0.5 + confidence / 2.0, model.freedom)
        errors = quantile * model.residual_sd * np.linalg.norm(along @ model.inverse, axis=1)
    return Canonical(
        tuple(column.parameter for column in columns),
        linear,
        squares,
        np.linalg.solve(squares, -linear / 2.0),
        values,
        errors,
        axes,
    )


def _weights(terms: Sequence[Term], count: int) -> Array:
    """What each term's coefficient adds to B, (term, d, d)."""
    found = np.zeros((len(terms), count, count))
    for k, term in enumerate(terms):
        numbers = [j for j, power in term for _ in range(power)]
        if len(numbers) == 2:
            i, j = numbers
            found[k, i, j] += 0.5
            found[k, j, i] += 0.5
    return found
