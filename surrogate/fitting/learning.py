"""Learning curve: the error of a surrogate against the number of its training runs.

Nested random subsets of the training runs are fitted, each larger one holds the smaller ones,
and judged on runs that none of them has: the test design, else those left out of the subset.
The scatter over the subsets is that of a design of that size. Of a subset that takes most
of the runs it is too small, because such subsets are nearly the same.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeGuard

import numpy as np
from numpy.typing import NDArray
from sklearn.base import clone

from surrogate.counting import counted
from surrogate.errors import FitError
from surrogate.estimator import Array, Regressor, refits_many
from surrogate.fitting.fit import Fit, minimum_runs, prepare, q2, rmse
from surrogate.fitting.replicates import runs_by_point
from surrogate.regressors.polynomial import Polynomial

Numbers = NDArray[np.intp]
#: Coded points (m, d) and values (m,).
Runs = tuple[Array, Array]

#: Random orders of the runs, each of which gives a subset of every size.
SUBSETS = 20
#: Sizes from one to the next, and the smallest as a share of all runs.
RATIO, SMALLEST = 2.0**0.5, 1.0 / 8.0
#: Share of the runs that the largest subset takes where the others judge it.
LARGEST = 0.8
#: Runs beyond the fewest that a surrogate can be fitted to, as a factor: there its error explodes.
ROOM = 1.25


@dataclass(frozen=True, eq=False)
class Curve:
    """Errors of one surrogate of one output, by the number of training runs.

    runs    (k,) training runs of a subset, rising
    q2      (subset, k), rmse (subset, k) in the output's unit; NaN where nothing could be fitted
    width   (subset, k) of the widest interval of a total index; NaN where it was not asked for
    judged  "the test design" or "the runs left out"
    whole   all training runs
    terms   of least squares on given terms; 0 for surrogates of any form
    """

    surrogate: str
    output: str
    runs: Numbers
    q2: Array
    rmse: Array
    width: Array
    judged: str
    whole: int
    terms: int = 0


def learn(
    fit: Fit,
    estimator: Regressor,
    test: Runs | None = None,
    *,
    subsets: int = SUBSETS,
    seed: int = 0,
    width: Callable[[Array, Array], float] | None = None,
) -> Curve:
    """The curve of a scalar output.

    fit        to all training runs
    estimator  as the study has it, unfitted
    test       coded points (m, d) and values (m,) that no fit has, or None
    width      of coded points and values: width of the widest interval of a total index

    A surrogate that can be refitted from nearby (a Gaussian process, from its lengths) is.
    Raises `FitError` when there are too few runs for three sizes.
    """
    points = runs_by_point(fit.coded)  # replicates stay together
    whole = len(points)
    sizes = _sizes(whole, minimum_runs(estimator, fit.space), test is not None)
    prepared = prepare(estimator, fit.space, seed=seed)
    shape = (subsets, len(sizes))
    scores, errors, widths = (np.full(shape, np.nan) for _ in range(3))
    rng = np.random.default_rng(seed)
    for k in counted("subset", range(subsets)):
        order = rng.permutation(whole)
        for j, size in enumerate(sizes):
            if k and size == whole:
                continue  # all runs: one subset
            inside = np.concatenate([points[number] for number in order[:size]])
            scores[k, j], errors[k, j] = _judged(fit, prepared, inside, test)
            if width is not None:
                widths[k, j] = _width(width, fit, inside)
    runs = np.rint(sizes * len(fit.coded) / whole).astype(np.intp)
    judged = "the test design" if test is not None else "the runs left out"
    terms = len(fit.estimator.terms_) if has_given_terms(fit.estimator) else 0
    named = fit.surrogate, fit.output
    return Curve(*named, runs, scores, errors, widths, judged, len(fit.coded), terms)


def has_curve(fit: Fit, tested: bool) -> bool:
    """True when the runs are enough for the curve of a fit on given terms."""
    try:
        _sizes(len(runs_by_point(fit.coded)), minimum_runs(fit.estimator, fit.space), tested)
    except FitError:
        return False
    return True


def has_given_terms(estimator: Regressor) -> TypeGuard[Polynomial]:
    """True for least squares on terms that the runs do not choose."""
    return isinstance(estimator, Polynomial)


def _sizes(whole: int, fewest: int, tested: bool) -> Numbers:
    """Numbers of points (k,): a factor `RATIO` apart, down from all or from `LARGEST` of them.

    Raises `FitError` when there are less than three.
    """
    largest = whole if tested else int(LARGEST * whole)
    least = max(int(np.ceil(ROOM * fewest)), int(np.ceil(SMALLEST * whole)), 3)
    steps = int(np.floor(np.log(max(largest / least, 1.0)) / np.log(RATIO) + 1e-9))
    sizes = np.unique(np.rint(largest / RATIO ** np.arange(steps + 1)).astype(np.intp))
    if len(sizes) < 3:
        least = max(int(np.ceil(ROOM * fewest)), 3)
        sizes = np.unique(np.rint(np.geomspace(least, max(largest, least), 4)).astype(np.intp))
    if len(sizes) < 3 or sizes[-1] > largest:
        raise FitError(
            f"{whole} training points are too few for a learning curve of a surrogate that needs "
            f"{fewest}; add runs or choose a surrogate with fewer terms"
        )
    return sizes


def _judged(
    fit: Fit, prepared: Regressor, inside: Numbers, test: Runs | None
) -> tuple[float, float]:
    """Q2 and RMSE of a fit to these runs; NaN when there is none."""
    coded, values = fit.coded[inside], fit.values[inside]
    try:
        ready: Regressor = clone(prepared)
        own = (
            ready.refit_many([fit.estimator], coded, values[:, None])[0]
            if refits_many(ready)
            else ready.fit(coded, values)
        )
    except (ValueError, np.linalg.LinAlgError, FitError):
        return np.nan, np.nan
    if test is None:
        outside = np.setdiff1d(np.arange(len(fit.values)), inside)
        test = fit.coded[outside], fit.values[outside]
    predicted = own.predict(test[0])
    return q2(test[1], predicted), rmse(test[1], predicted)


def _width(width: Callable[[Array, Array], float], fit: Fit, inside: Numbers) -> float:
    try:
        return width(fit.coded[inside], fit.values[inside])
    except (ValueError, np.linalg.LinAlgError, FitError):
        return np.nan
