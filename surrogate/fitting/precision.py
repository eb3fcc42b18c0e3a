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
from surrogate.regressors.least_squares import LeastSquares, least_squares

Array = NDArray[np.float64]

#: Level of the t-test, and the size of a weight that is rounding.
ALPHA, TINY = 0.05, 1e-6


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
    names = [name for name, _ in terms]
    matrix = model.full(coded)[:, named]
    told = least_squares(matrix, np.zeros(len(coded)), names)
    error = np.sqrt((told.inverse**2).sum(axis=1))
    about_mean = ((matrix[:, told.kept] - matrix[:, told.kept].mean(axis=0)) ** 2).sum(axis=0)
    return Precision(
        len(coded),
        told.freedom,
        tuple(term for term, kept in zip(terms, told.kept, strict=True) if kept),
        error,
        error**2 * about_mean,
        _power(effect / 2.0 / error, told.freedom),
        _confounded(told),
    )


def _confounded(told: LeastSquares) -> tuple[str, ...]:
    """What each term is of which those before it tell everything."""
    names = np.array(told.names)
    parts = zip(names[~told.kept], told.alias.T, strict=True)
    return tuple(f"{name} = {_sum(names[told.kept], weights)}" for name, weights in parts)


def _sum(names: NDArray[np.str_], weights: Array) -> str:
    """`a - 0.5 b:c`."""
    said = ""
    for name, weight in zip(names, weights, strict=True):
        if abs(weight) <= TINY:
            continue
        sign = ("-" if weight < 0 else "") if not said else (" - " if weight < 0 else " + ")
        size = "" if abs(abs(weight) - 1.0) < TINY else f"{abs(weight):.3g} "
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
