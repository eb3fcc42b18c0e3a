"""The surrogate's part of the error of an index.

A surrogate is wrong in two ways. Learnt from few runs, it is uncertain: each draw is
another surrogate that those runs allow, and r is the size that |index of a draw - index
of the fitted one| does not exceed at the confidence asked. And it is not the solver: of
the solver's variance it misses the share m = 1 - Q2, which may belong to any parameter.
Were what it misses orthogonal to it in each Sobol' component, an index I would lie in
[I (1 - m), I (1 - m) + m]; the interval is therefore

    [I - sqrt(r^2 + (m I)^2),  I + sqrt(r^2 + (m (1 - I))^2)].

A draw that chooses terms anew may miss some that the surrogate has, and predict what the
surrogate predicts well much worse; it is then no surrogate that the runs allow. So r is no
larger than what the missed variance allows (`surrogate.sensitivity.missed`, with e doubled,
since Q2 is an estimate): where left-out runs are met to 1e-7, so are the indices.

Neither part alone is honest. On 12 random designs of 60 to 75 runs of the borehole and piston
functions, 95 % intervals from draws alone cover 45 to 95 % of the true indices and from the
missed variance alone 36 to 67 %; together 93 to 99 % for polynomials and forests, 98 %
(piston) and 90 % (borehole) for Gaussian processes, whose lengths are drawn as well
(`benchmarks/sensitivity.py surrogate`). Kinds of draws:

posterior draws  estimators with `posterior_draws(size, seed)`, or scikit-learn's `sample_y`
                 (Le Gratiet, Cannamela and Iooss 2014, doi 10.1137/130926869)
least squares    refits to prediction + s* e, e standard normal and s*^2 = SSE / chi^2(nu):
                 coefficients then follow their Student t distribution exactly (Gelman et
                 al., Bayesian Data Analysis, section 14.2)
pairs bootstrap  refits to runs drawn with replacement (Storlie, Swiler, Helton and
                 Sallaberry 2009, doi 10.1016/j.ress.2009.05.007); a selection of terms is
                 repeated as well
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import chain
from typing import Protocol

import numpy as np
from sklearn.base import clone

from surrogate.counting import counted
from surrogate.errors import FitError
from surrogate.estimator import (
    Array,
    Groups,
    Paths,
    Predictor,
    Regressor,
    has_draws,
    has_indices,
    has_samples,
    has_table,
    is_path,
)
from surrogate.sensitivity.missed import largest, smallest
from surrogate.sensitivity.model import Learnt, Model, Seed, require_at_least
from surrogate.sensitivity.pick_freeze import (
    Mixing,
    independent,
    mixed_points,
    product_moments,
    ratios,
)
from surrogate.space.space import Space

#: What a measure gives of one function, one array for each kind of index.
Values = tuple[Array, ...]
#: Several functions of coded points: values (run, count).
Functions = Callable[[Array], Array]

#: Pairs of points on which indices of drawn surrogates are set side by side.
SAMPLES = 512
#: The same where the draws' covariance at all points must be factored.
JOINT_SAMPLES = 64

#: Times the missed variance that draws may spread by: Q2 is an estimate.
CAUTION = 4.0

#: Draws that fail (a resample that supports no fit) are tried again so often.
PATIENCE = 5


@dataclass(frozen=True)
class Spread:
    """Distances from an index to the ends of its interval for the surrogate's error.

    below, above  shapes of the index, not negative; NaN when they cannot be estimated
    how           the kind of draws, in words
    """

    below: Array
    above: Array
    how: str


class Measured(Protocol):
    """Indices of any surrogate, on points that are the same for all."""

    @property
    def closed(self) -> bool:
        """True when the estimator's own `sobol_indices()` are used."""

    def of(self, estimator: Predictor, /) -> Values:
        """Indices of one estimator."""

    def of_functions(self, functions: Functions, pairs: int, /) -> Sequence[Values]:
        """The same for each column of functions(coded) (run, count), on `pairs` points."""


@dataclass(frozen=True)
class Measure:
    """Indices of any surrogate on points that are the same for all, or in closed form.

    groups  of inputs, as in `pick_freeze`; None for each input alone
    closed  True to use the estimator's own `sobol_indices()`
    mixing  in place of groups, as in `pick_freeze`
    """

    space: Space
    groups: Groups | None = None
    closed: bool = False
    seed: Seed = 0
    mixing: Mixing | None = None

    def of(self, estimator: Predictor) -> Values:
        """first_order, total, second_order of one estimator."""
        if self.closed:
            return closed_form(estimator, self.groups)
        return ratios(
            product_moments(
                estimator.predict,
                self.space,
                self._mixing,
                samples=SAMPLES,
                scramblings=1,
                seed=self.seed,
            )[0]
        )

    def of_functions(self, functions: Functions, pairs: int) -> list[Values]:
        """The same for each column of functions(coded) (run, count)."""
        points = mixed_points(self.space, self._mixing, pairs, self.seed)
        values = functions(np.concatenate(points)).reshape(len(points), pairs, -1)
        values = values - values.mean(axis=(0, 1))
        return [ratios(columns @ columns.T / pairs) for columns in np.moveaxis(values, 2, 0)]

    @property
    def _mixing(self) -> Mixing:
        return self.mixing or independent(self.space, self.groups)


@dataclass(frozen=True)
class JointMeasure:
    """Several measures of the same estimators, one after another."""

    parts: tuple[Measure, ...]

    @property
    def closed(self) -> bool:
        """True when some part takes the estimator's own indices."""
        return any(part.closed for part in self.parts)

    def of(self, estimator: Predictor) -> Values:
        """Indices of all parts."""
        return tuple(chain.from_iterable(part.of(estimator) for part in self.parts))

    def of_functions(self, functions: Functions, pairs: int) -> list[Values]:
        """The same for each column of functions(coded) (run, count)."""
        found = [part.of_functions(functions, pairs) for part in self.parts]
        return [tuple(chain.from_iterable(one)) for one in zip(*found, strict=True)]


def closed_form(estimator: Predictor, groups: Groups | None = None) -> tuple[Array, Array, Array]:
    """first_order, total, second_order (NaN on its diagonal) of an estimator that knows them."""
    if not has_indices(estimator):
        raise FitError(f"{type(estimator).__name__} has no closed form: add sobol_indices()")
    indices = estimator.sobol_indices() if groups is None else estimator.sobol_indices(groups)
    second = np.array(indices.second_order, dtype=float)
    np.fill_diagonal(second, np.nan)
    return np.asarray(indices.first_order), np.asarray(indices.total), second


def _posterior(
    estimator: Predictor, measure: Measured, size: int, seed: Seed
) -> list[Values] | None:
    """Indices of each posterior draw less those of the mean on the same points, or None."""
    functions: Functions
    if has_draws(estimator):
        drawn, pairs = estimator.posterior_draws(size, seed=seed), SAMPLES
        first = drawn[0]
        if measure.closed or not is_path(first):
            fitted = measure.of(estimator)
            return [_moved(measure.of(draw), fitted) for draw in counted("draw", drawn)]
        functions = partial(_all_paths, first.paths)
    elif has_samples(estimator):
        functions = partial(estimator.sample_y, n_samples=size, random_state=integer_seed(seed))
        pairs = JOINT_SAMPLES
    else:
        return None
    mean = measure.of_functions(lambda coded: estimator.predict(coded)[:, None], pairs)[0]
    return [_moved(indices, mean) for indices in measure.of_functions(functions, pairs)]


def _all_paths(paths: Paths, coded: Array) -> Array:
    return paths.predict(coded, slice(None))


def _moved(drawn: Values, centre: Values) -> Values:
    """Indices of a draw less those of the fitted surrogate."""
    return tuple(one - other for one, other in zip(drawn, centre, strict=True))


def integer_seed(seed: Seed) -> int:
    """A seed of 32 bits, for libraries that know no generators."""
    return int(np.random.default_rng(seed).integers(2**31))


def refits(learnt: Learnt, size: int, seed: Seed) -> tuple[Iterator[Regressor], str]:
    """Refitted estimators, and in words how they were drawn."""
    generator = np.random.default_rng(seed)
    freedom = getattr(learnt.estimator, "interval_freedom", None)
    if not has_table(learnt.estimator) or freedom is None:
        return _pairs(learnt, size, generator), "pairs bootstrap"
    if freedom == 0:
        return iter(()), "unknown: as many coefficients as runs"
    return _student(learnt, freedom, size, generator), "Student t draws of the coefficients"


def _student(
    learnt: Learnt, freedom: int, size: int, generator: np.random.Generator
) -> Iterator[Regressor]:
    """Least squares refits whose coefficients are t distributed about the fitted ones."""
    prediction = learnt.estimator.predict(learnt.coded)
    squares = float(((learnt.values - prediction) ** 2).sum())
    for _ in counted("refit", range(size)):
        deviation = np.sqrt(squares / generator.chisquare(freedom))
        noise = deviation * generator.standard_normal(len(prediction))
        yield clone(learnt.estimator).fit(learnt.coded, prediction + noise)


def _pairs(learnt: Learnt, size: int, generator: np.random.Generator) -> Iterator[Regressor]:
    """Refits to runs drawn with replacement; resamples that support no fit are drawn again."""
    for _ in counted("refit", range(size)):
        for _ in range(PATIENCE):
            chosen = generator.integers(len(learnt.coded), size=len(learnt.coded))
            try:
                yield clone(learnt.estimator).fit(learnt.coded[chosen], learnt.values[chosen])
                break
            except (ValueError, np.linalg.LinAlgError, FitError):
                continue


def spread(
    one: Model,
    measure: Measured,
    *,
    draws: int,
    confidence: float,
    seed: Seed = 0,
    shares: bool = True,
) -> tuple[Spread, ...]:
    """Surrogate part of the interval of each index that `measure.of(estimator)` gives.

    shares   whether the indices are shares of the variance, so that the missed variance counts

    Draws are measured on the same points, so that no sampling error enters. A plain
    function has no surrogate part: zeros. Without draws only the missed variance counts.
    """
    require_at_least(0, draws=draws)
    fitted = measure.of(one.predictor)
    if one.learnt is None:
        return tuple(
            Spread(np.zeros_like(part), np.zeros_like(part), "none: a plain function")
            for part in fitted
        )
    radii, how = _radii(one.learnt, measure, fitted, draws, confidence, seed)
    if not shares:
        return tuple(Spread(radius, radius, how) for radius in radii)
    missed = np.nan if one.q2 is None else float(np.clip(1.0 - one.q2, 0.0, 1.0))
    how = f"{how}; missed variance {missed:.3g}"
    return tuple(
        _joined(part, radius, missed, how) for part, radius in zip(fitted, radii, strict=True)
    )


def _joined(index: Array, radius: Array, missed: float, how: str) -> Spread:
    """The spread of draws, as far as the missed variance allows it, and that variance itself."""
    if not np.isnan(missed):
        below, above = index - smallest(index, CAUTION * missed), largest(index, CAUTION * missed)
        radius = np.minimum(radius, np.maximum(below, above - index))
    return Spread(np.hypot(radius, missed * index), np.hypot(radius, missed * (1.0 - index)), how)


def _radii(
    learnt: Learnt, measure: Measured, fitted: Values, draws: int, confidence: float, seed: Seed
) -> tuple[list[Array], str]:
    """Quantiles of |index of a draw - index of the fitted one|, and how they were drawn."""
    if draws == 0:
        return [np.zeros_like(part) for part in fitted], "no draws"
    moves, how = _posterior(learnt.estimator, measure, draws, seed), "posterior draws"
    if moves is None:
        estimators, how = refits(learnt, draws, seed)
        moves = [_moved(measure.of(estimator), fitted) for estimator in estimators]
    if len(moves) < max(2, draws // 2):
        how = how if how.startswith("unknown") else f"unknown: {how} failed on these runs"
        return [np.full_like(part, np.nan) for part in fitted], how
    return [
        np.quantile(np.abs(np.stack(parts)), confidence, axis=0)
        for parts in zip(*moves, strict=True)
    ], how
