"""Equally plausible surrogates, and how far their indices scatter.

A surrogate learnt from few runs is itself uncertain. Each draw is another surrogate that
those runs allow; the spread of its indices is the surrogate's part of their error:

posterior draws  estimators that offer `posterior_draws(size, seed)`, such as Gaussian
                 processes (Le Gratiet, Cannamela and Iooss 2014, doi 10.1137/130926869)
least squares    refits to prediction + s* e, e standard normal and s*^2 = SSE / chi^2(nu):
                 coefficients then follow their Student t distribution exactly (Gelman et
                 al., Bayesian Data Analysis, section 14.2), and a selection of terms is
                 repeated as well
pairs bootstrap  refits to runs drawn with replacement (Storlie, Swiler, Helton and
                 Sallaberry 2009, doi 10.1016/j.ress.2009.05.007)
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from sklearn.base import clone

from surrogate.errors import FitError
from surrogate.sensitivity.model import Model

#: Draws that fail (a resample that supports no fit) are tried again so often.
PATIENCE = 5


@dataclass(frozen=True)
class Spread:
    """Distances from an index to the ends of its interval for the surrogate's error.

    below, above  shapes of the index, not negative; NaN when they cannot be estimated
    how           the kind of draws, in words
    """

    below: np.ndarray
    above: np.ndarray
    how: str


def surrogates(one: Model, size: int, seed) -> tuple[Iterator, str]:
    """`size` equally plausible estimators, and in words how they were drawn."""
    generator = np.random.default_rng(seed)
    if hasattr(one.estimator, "posterior_draws"):
        return iter(one.estimator.posterior_draws(size, seed=generator)), "posterior draws"
    freedom = getattr(one.estimator, "interval_freedom", None)
    if freedom is None:
        return _pairs(one, size, generator), "pairs bootstrap"
    if freedom == 0:
        return iter(()), "unknown: as many coefficients as runs"
    return _student(one, freedom, size, generator), "Student t draws of the coefficients"


def _student(one: Model, freedom: int, size: int, generator) -> Iterator:
    """Least squares refits whose coefficients are t distributed about the fitted ones."""
    prediction = one.estimator.predict(one.coded)
    squares = float(((one.values - prediction) ** 2).sum())
    for _ in range(size):
        deviation = np.sqrt(squares / generator.chisquare(freedom))
        noise = deviation * generator.standard_normal(len(prediction))
        yield clone(one.estimator).fit(one.coded, prediction + noise)


def _pairs(one: Model, size: int, generator) -> Iterator:
    """Refits to runs drawn with replacement; resamples that support no fit are drawn again."""
    for _ in range(size):
        for _ in range(PATIENCE):
            chosen = generator.integers(len(one.coded), size=len(one.coded))
            try:
                yield clone(one.estimator).fit(one.coded[chosen], one.values[chosen])
                break
            except (ValueError, np.linalg.LinAlgError, FitError):
                continue


def spread(one: Model, indices, *, draws: int, confidence: float, seed=None) -> list[Spread]:
    """Spread of the tuple of arrays that `indices(estimator)` gives, over plausible estimators.

    The interval is that of the quantiles of (draw - fitted one); `indices` must use the
    same points for every estimator, so that no sampling error enters. A plain function has
    no surrogate part: zeros.
    """
    if one.estimator is None or draws == 0:
        shapes = [np.shape(part) for part in indices(one.estimator or one)]
        how = "none: a plain function" if one.estimator is None else "none: not asked for"
        return [Spread(np.zeros(shape), np.zeros(shape), how) for shape in shapes]
    fitted = indices(one.estimator)
    drawn, how = surrogates(one, draws, seed)
    sets = [indices(estimator) for estimator in drawn]
    if len(sets) < max(2, draws // 2):
        unknown = how if how.startswith("unknown") else f"unknown: {how} failed on these runs"
        return [Spread(*2 * (np.full(np.shape(part), np.nan),), unknown) for part in fitted]
    return [_ends(np.stack(parts) - centre, confidence, how)
            for parts, centre in zip(zip(*sets, strict=True), fitted, strict=True)]


def _ends(differences: np.ndarray, confidence: float, how: str) -> Spread:
    tail = 0.5 - 0.5 * confidence
    low, high = np.quantile(differences, [tail, 1.0 - tail], axis=0)
    return Spread(np.maximum(-low, 0.0), np.maximum(high, 0.0), how)
