"""The surrogate's part of the error of an index.

A surrogate is wrong in two ways. Learnt from few runs, it is uncertain: each draw is
another surrogate that those runs allow, and r is the size that |index of a draw - index
of the fitted one| does not exceed at the confidence asked. And it is not the solver: of
the solver's variance it misses the share m = 1 - Q2, which may belong to any parameter.
Were what it misses orthogonal to it in each Sobol' component, an index I would lie in
[I (1 - m), I (1 - m) + m]; the interval is therefore

    [I - sqrt(r^2 + (m I)^2),  I + sqrt(r^2 + (m (1 - I))^2)].

Neither part alone is honest: on repeated Latin hypercubes of the borehole and piston
functions r alone covers 50 to 97 % and m alone 50 to 90 % of the true indices, both
together 97 to 99 % (`benchmarks/sensitivity.py surrogate`). Kinds of draws:

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

from collections.abc import Callable, Iterator
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
    if not hasattr(one.estimator, "regression_table"):
        return _pairs(one, size, generator), "pairs bootstrap"
    freedom = one.estimator.interval_freedom
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


def spread(one: Model, indices: Callable[..., tuple], *, draws: int, confidence: float,
           seed=None) -> list[Spread]:
    """Surrogate part of the interval of each array in the tuple `indices(estimator)`.

    `indices` must use the same points for every estimator, so that no sampling error
    enters. A plain function has no surrogate part: zeros. Without draws only the missed
    variance counts. Values are shares, in [0, 1].
    """
    if one.estimator is None:
        return [Spread(np.zeros_like(part), np.zeros_like(part), "none: a plain function")
                for part in indices(one)]
    fitted = indices(one.estimator)
    radii, how = _radii(one, fitted, indices, draws, confidence, seed)
    missed = np.nan if one.q2 is None else np.clip(1.0 - one.q2, 0.0, 1.0)
    how = f"{how}; missed variance {missed:.3g}"
    return [Spread(np.hypot(radius, missed * part), np.hypot(radius, missed * (1.0 - part)), how)
            for part, radius in zip(fitted, radii, strict=True)]


def _radii(one: Model, fitted: tuple, indices, draws: int, confidence: float, seed):
    """Quantiles of |index of a draw - index of the fitted one|, and how they were drawn."""
    if draws == 0:
        return [np.zeros_like(part) for part in fitted], "no draws"
    estimators, how = surrogates(one, draws, seed)
    sets = [indices(estimator) for estimator in estimators]
    if len(sets) < max(2, draws // 2):
        how = how if how.startswith("unknown") else f"unknown: {how} failed on these runs"
        return [np.full_like(part, np.nan) for part in fitted], how
    return [np.quantile(np.abs(np.stack(parts) - centre), confidence, axis=0)
            for parts, centre in zip(zip(*sets, strict=True), fitted, strict=True)], how
