"""What a design will tell about a polynomial, before anything is run.

With the model matrix F and V = (F'F)^-1, coefficient j has the standard error
sigma sqrt(V_jj); its variance inflation factor is V_jj times the sum of squares of its
column about the mean, 1 when the column is orthogonal to the others; and the t-test of level
alpha finds a coefficient beta with the probability that a non-central t with n - p degrees of
freedom and the parameter beta / (sigma sqrt(V_jj)) lies beyond the t quantile (Montgomery,
Design and Analysis of Experiments, 8th ed., sections 10.4 and 10.5).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import special, stats

from surrogate.designs.model import Model

Array = NDArray[np.float64]

#: Level of the t-test, and the share of a column that counts as told apart.
ALPHA, RANK = 0.05, 1e-8


@dataclass(frozen=True)
class Precision:
    """A polynomial on the runs of a design; a row a term that the runs tell apart.

    runs, freedom   number of runs, and degrees of freedom that are left for the error
    terms           (name, order): order 0 the constant, 1 a main effect, 2 and more the rest
    error           standard errors (term,) in units of the error's standard deviation
    inflation       variance inflation factors (term,)
    power           probability (term,) to find the effect; nan without degrees of freedom
    confounded      sentences `a:b = c:d`: what the runs cannot tell apart; the left-hand side
                    is left out of the terms
    """

    runs: int
    freedom: int
    terms: tuple[tuple[str, int], ...]
    error: Array
    inflation: Array
    power: Array
    confounded: tuple[str, ...]


def precision(model: Model, coded: Array, effect: float = 2.0) -> Precision:
    """What the runs `coded` (run, parameter) tell about the terms of a model.

    effect: change of the output from the low to the high end of a parameter that is to be
    found, in units of the error's standard deviation; a coefficient is half of it.
    Terms of parameters that follow from others by an equality are left aside.
    """
    named = np.flatnonzero(model.independent)
    terms = [model.named[j] for j in named]
    matrix = model.full(coded)[:, named]
    kept, confounded = _told_apart(matrix, [name for name, _ in terms])
    told = matrix[:, kept]
    inverse = np.linalg.inv(told.T @ told)
    error = np.sqrt(np.diag(inverse))
    spread = ((told - told.mean(axis=0)) ** 2).sum(axis=0)
    freedom = len(coded) - len(kept)
    return Precision(
        len(coded),
        freedom,
        tuple(terms[j] for j in kept),
        error,
        error**2 * spread,
        _power(effect / 2.0 / error, freedom),
        confounded,
    )


def _told_apart(matrix: Array, names: list[str]) -> tuple[list[int], tuple[str, ...]]:
    """Columns that do not follow from those before them, and what the others are."""
    kept: list[int] = []
    sentences = []
    for j, column in enumerate(matrix.T):
        weights = np.linalg.lstsq(matrix[:, kept], column, rcond=None)[0]
        left = column - matrix[:, kept] @ weights
        if np.linalg.norm(left) > RANK * max(float(np.linalg.norm(column)), 1.0):
            kept.append(j)
            continue
        parts = [(names[k], w) for k, w in zip(kept, weights, strict=True) if abs(w) > 1e-6]
        sentences.append(f"{names[j]} = {_sum(parts)}")
    return kept, tuple(sentences)


def _sum(parts: list[tuple[str, float]]) -> str:
    """`a - 0.5 b:c`."""
    said = ""
    for name, weight in parts:
        sign = ("-" if weight < 0 else "") if not said else (" - " if weight < 0 else " + ")
        size = "" if abs(abs(weight) - 1.0) < 1e-6 else f"{abs(weight):.3g} "
        said += f"{sign}{size}{name}"
    return said or "0"


def _power(distance: Array, freedom: int) -> Array:
    """Of the two-sided t-test, for coefficients `distance` standard errors from zero."""
    if freedom < 1:
        return np.full(len(distance), np.nan)
    beyond = stats.t.isf(ALPHA / 2.0, freedom)
    return np.asarray(
        1.0 - special.nctdtr(freedom, distance, beyond) + special.nctdtr(freedom, distance, -beyond)
    )
