"""Shift and stretch of fields along a dimension, linear in the inputs: the coarse part of a warp.

What stands at place r of a field that nothing moves stands in a run with coded inputs x at

    c + shift . x + (r - c) exp(stretch . x),

c being the middle of the dimension. Fields that are moved back are of lower rank. So shift and
stretch minimise nuclear norm over Frobenius norm of the fields, runs as rows, which is 1 for
rank one (Peng, Ganesh, Wright, Xu, Ma 2012, RASL, doi 10.1109/TPAMI.2011.282, align images by
the nuclear norm); by pattern search (Hooke and Jeeves 1961), because the norm has kinks.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: First and last step of the search, as shares of the dimension's length.
FIRST, LAST = 0.25, 1.0 / 128.0
#: Least improvement that moves a coefficient, as a share of the norm: less may be chance.
WORTH = 1e-3
#: Runs and rows of a field that are looked at.
RUNS, ROWS = 200, 8


@dataclass(frozen=True, eq=False)
class Drift:
    """middle c of the dimension; shift, stretch (d,) for coded inputs."""

    middle: float
    shift: Array
    stretch: Array

    def forth(self, X: Array, r: Array) -> Array:
        """Places (n, k) in runs at X (n, d) of what stands at r (k,), or (n, k)."""
        return self.middle + (X @ self.shift)[:, None] + (r - self.middle) * self._factor(X)

    def back(self, X: Array, places: Array) -> Array:
        """r (n, k) of what stands at places (k,), or (n, k), in runs at X (n, d)."""
        return self.middle + (places - self.middle - (X @ self.shift)[:, None]) / self._factor(X)

    def _factor(self, X: Array) -> Array:
        return np.asarray(np.exp(X @ self.stretch))[:, None]


def drift(X: Array, rows: Array, places: Array) -> tuple[Drift, float]:
    """The drift of fields rows (n, rows, m) at coded X (n, d), over even places (m,).

    Also the norm that it reaches, as a share of that of the fields as they are.
    """
    X, fields = X[:RUNS], rows[:RUNS, :: max(rows.shape[1] // ROWS, 1)]
    length, middle = float(places[-1] - places[0]), float(places[[0, -1]].mean())
    found, inputs = np.zeros((2, X.shape[1])), X.shape[1]

    def drifted(coefficients: Array) -> Drift:
        return Drift(middle, length * coefficients[0], coefficients[1])

    least = start = _rank(fields, places, drifted(found).forth(X, places))
    step = FIRST
    while step >= LAST:
        moved = False
        for kind, number in np.ndindex(2, inputs):
            for sign in (step, -step):
                trial = found.copy()
                trial[kind, number] += sign
                norm = _rank(fields, places, drifted(trial).forth(X, places))
                if norm < least * (1.0 - WORTH):
                    found, least, moved = trial, norm, True
                    break
        if not moved:
            step /= 2.0
    return drifted(found), least / start


def _rank(fields: Array, places: Array, at: Array) -> float:
    """Nuclear over Frobenius norm of fields (n, rows, m) read at places (n, k)."""
    step = places[1] - places[0]
    along = np.clip((at - places[0]) / step, 0.0, len(places) - 1.0)
    number = np.minimum(along.astype(np.intp), len(places) - 2)
    share = (along - number)[:, None, :]
    run, row = np.arange(len(at))[:, None, None], np.arange(fields.shape[1])[:, None]
    number = number[:, None, :]
    read = (1.0 - share) * fields[run, row, number] + share * fields[run, row, number + 1]
    flat = read.reshape(len(read), -1)
    squares = np.maximum(np.linalg.eigvalsh(flat @ flat.T), 0.0)
    total = float(squares.sum())
    return float(np.sqrt(squares).sum()) / np.sqrt(total) if total > 0.0 else 1.0
