"""Surrogates side by side: accuracy on common folds and on held-out runs, and cost.

The best surrogate of an output has the largest cross-validated Q2; the test design
judges it and takes no part in the choice, unless the training designs differ: their
cross-validated errors do not compare, so the test design decides, and without one only those
with the most runs compete.
"""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import permutations, product
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy import stats

from surrogate.estimator import approximation
from surrogate.fitting.best import BEST
from surrogate.fitting.fit import Fit, q2, rmse
from surrogate.regressors.field import Field
from surrogate.regressors.polynomial import Polynomial
from surrogate.regressors.regression import Nested, nested

Array = NDArray[np.float64]
Fits = Mapping[str, Mapping[str, Fit]]
Runs = tuple[Array, Array]

#: Confidence levels at which intervals are checked on the test design.
LEVELS = (0.5, 0.8, 0.9, 0.95, 0.99)
#: Predictions are timed on this many points.
TIMED = 1000
#: A margin counts as clear when the paired test's p is below this.
SIGNIFICANT = 0.05

COLUMNS = {
    "q2_cv": "Q2 of left-out predictions",
    "rmse_cv": "RMSE of left-out predictions",
    "q2_test": "Q2 on the test design",
    "rmse_test": "RMSE on the test design",
    "max_error_test": "largest absolute error on the test design",
    "coverage_95": "share of test values inside their 95 % intervals",
    "fit_seconds": "time of the fit in s",
    "predict_seconds": f"time of predicting {TIMED} points in s",
    "modes": "modes of a field",
    "truncation_error": "what the modes leave out, a share of the fluctuations' RMS",
}


def compare(fits: Fits, test: Mapping[str, Runs] | None = None) -> xr.Dataset:
    """The table that sets surrogates side by side.

    fits  surrogate -> output -> Fit; a missing one is a row of NaN
    test  output -> (coded (m, d), values (m, ...)) of runs that no fit has seen, or None

    Returns a dataset over (`surrogate`, `output`) with the variables of `COLUMNS`,
    `coverage` over `level` besides (calibration), and for each output `best`,
    `runner_up`, `margin` (difference of their q2_cv), `margin_p` (see `paired_test`),
    `margin_clear` and `sentence`. The attribute `best` names the surrogate with the
    largest q2_cv, counted from 0, on average over the outputs.
    """
    surrogates = list(fits)
    outputs = list(dict.fromkeys(output for each in fits.values() for output in each))
    shape = (len(surrogates), len(outputs))
    columns = {name: np.full(shape, np.nan) for name in COLUMNS}
    coverage = np.full((*shape, len(LEVELS)), np.nan)
    for (i, name), (j, output) in product(enumerate(surrogates), enumerate(outputs)):
        if (fit := fits[name].get(output)) is None:
            continue
        row, coverage[i, j] = _row(fit, (test or {}).get(output))
        for key, value in row.items():
            columns[key][i, j] = value
    verdicts = [
        _verdict(fits, output, columns["q2_cv"][:, j], columns["q2_test"][:, j])
        for j, output in enumerate(outputs)
    ]
    return _dataset(surrogates, outputs, columns, coverage, verdicts)


def best(table: xr.Dataset) -> dict[str, str]:
    """The best surrogate of each output."""
    return {
        str(output): str(name)
        for output, name in zip(table["output"].values, table["best"].values, strict=True)
    }


def chosen(surrogate: str, best: Mapping[str, str], fits: Fits) -> dict[str, Fit]:
    """The fit of each output, as far as there is one.

    surrogate: a name, or `best` for the surrogate that `best` names for the output
    """
    names = best if surrogate == BEST else dict.fromkeys(fits.get(surrogate, {}), surrogate)
    return {
        output: fits[name][output] for output, name in names.items() if output in fits.get(name, {})
    }


def _row(fit: Fit, test: Runs | None) -> tuple[dict[str, float], Array]:
    """Columns of one surrogate and output, and coverage at each level."""
    row = {
        "q2_cv": fit.q2,
        "rmse_cv": fit.rmse,
        "fit_seconds": fit.seconds,
        "predict_seconds": _predict_seconds(fit),
    }
    if isinstance(fit.estimator, Field):
        row |= {
            "modes": len(fit.estimator.modes_),
            "truncation_error": fit.estimator.truncation_error_,
        }
    if test is None or not len(test[1]):
        return row, np.full(len(LEVELS), np.nan)
    coded, values = test
    predicted = fit.predict(coded)
    covered = np.array([_coverage(*ends, values) for ends in fit.intervals(coded, LEVELS)])
    row |= {
        "q2_test": q2(values, predicted),
        "rmse_test": rmse(values, predicted),
        "max_error_test": np.abs(values - predicted).max(),
        "coverage_95": covered[LEVELS.index(0.95)],
    }
    return row, covered


def _predict_seconds(fit: Fit) -> float:
    points = fit.space.sample(TIMED, seed=0)
    start = time.perf_counter()
    fit.predict(points)
    return time.perf_counter() - start


def _coverage(low: Array, high: Array, values: Array) -> float:
    """Share of values inside their intervals; NaN where there are no intervals."""
    known = np.isfinite(low) & np.isfinite(high)
    # Rounding of a value that is met exactly must not count as a miss.
    slack = 1e-12 * np.abs(values).max()
    inside = (values >= low - slack) & (values <= high + slack)
    return float(inside[known].mean()) if known.any() else np.nan


def paired_test(first: Fit, second: Fit) -> float:
    """Two-sided p of equal squared error, from the two fits' errors on the same folds.

    Corrected resampled t-test (Nadeau and Bengio 2003, equation 15): with d_k the
    difference of mean squared errors on fold k of K, t = mean(d) / sqrt((1 / K + r) var(d)),
    K - 1 degrees of freedom, r = size of a fold / size of the rest. NaN when the fits
    have different training designs or some run cannot be left out.
    """
    if not np.array_equal(first.coded, second.coded) or not np.array_equal(
        first.folds, second.folds
    ):
        return np.nan
    a, b = (_squared_errors(fit) for fit in (first, second))
    numbers, counts = np.unique(first.folds, return_counts=True)
    d = np.array([(a - b)[first.folds == number].mean() for number in numbers])
    ratio = counts.mean() / (len(a) - counts.mean())
    variance = (1.0 / len(d) + ratio) * d.var(ddof=1)
    if not np.isfinite(variance) or variance == 0.0:
        return np.nan
    return float(2.0 * stats.t.sf(abs(d.mean()) / np.sqrt(variance), len(d) - 1))


@dataclass(frozen=True)
class NestedTest:
    """F test of a larger least squares surrogate against a smaller one of the same output."""

    output: str
    smaller: str
    larger: str
    test: Nested

    @property
    def sentence(self) -> str:
        """What the test says, in words."""
        start = (
            f"{self.output}: the {self.test.df_terms} additional terms of {self.larger} "
            f"against {self.smaller}"
        )
        if np.isnan(self.test.p):
            return f"{start} cannot be tested: {self.larger} has no residual degrees of freedom."
        verdict = "are significant" if self.test.p < SIGNIFICANT else "are not significant"
        return (
            f"{start} {verdict} (F = {self.test.f:.3g} on "
            f"{self.test.df_terms} and {self.test.df_residual} degrees of freedom, "
            f"p = {self.test.p:.2g})."
        )


def nested_tests(fits: Fits) -> list[NestedTest]:
    """F tests of all pairs of polynomial surrogates, one within the other, of the same runs."""
    polynomials = [
        (fit, fit.estimator.model_)
        for each in fits.values()
        for fit in each.values()
        if isinstance(fit.estimator, Polynomial)
    ]
    return [
        NestedTest(small.output, small.surrogate, large.surrogate, nested(fewer, more))
        for (small, fewer), (large, more) in permutations(polynomials, 2)
        if small.output == large.output
        and set(fewer.names) < set(more.names)
        and np.array_equal(small.coded, large.coded)
    ]


def _squared_errors(fit: Fit) -> Array:
    """(n,) squared left-out errors, averaged over a field's places."""
    errors = (fit.values - fit.left_out) ** 2
    return np.asarray(errors.reshape(len(errors), -1).mean(axis=1))


def _scores(fits: Fits, output: str, q2_cv: Array, q2_test: Array) -> tuple[Array, str, str]:
    """Scores that decide on the best surrogate of an output, what they are, and why these."""
    learnt = [fits[name][output].coded if output in fits[name] else None for name in fits]
    runs = [0 if coded is None else len(coded) for coded in learnt]
    most = learnt[int(np.argmax(runs))]
    same = np.array(
        [coded is not None and most is not None and np.array_equal(coded, most) for coded in learnt]
    )
    able = np.isfinite(q2_cv)
    if able.any() and same[able].all():
        return q2_cv, "cross-validated Q2", ""
    if np.isfinite(q2_test).any():
        why = "the training designs differ" if able.any() else "no surrogate can be cross-validated"
        return q2_test, "Q2 on the test design", why
    return (
        np.where(same, q2_cv, np.nan),
        "cross-validated Q2",
        "only those with the most training runs compete",
    )


def _verdict(fits: Fits, output: str, q2_cv: Array, q2_test: Array) -> dict[str, Any]:
    """Best and second best surrogate of one output, the margin and what to make of it."""
    names = [name for name in fits if output in fits[name]]
    order = {name: k for k, name in enumerate(fits)}
    scores, *how = _scores(fits, output, q2_cv, q2_test)
    ranked = (
        sorted(
            (name for name in names if np.isfinite(scores[order[name]])),
            key=lambda name: -scores[order[name]],
        )
        or names
    )
    verdict: dict[str, Any] = {
        "best": ranked[0],
        "runner_up": "",
        "margin": np.nan,
        "margin_p": np.nan,
        "scores": scores,
    }
    if len(ranked) > 1 and np.isfinite(scores[order[ranked[1]]]):
        verdict["runner_up"] = ranked[1]
        verdict["margin"] = float(scores[order[ranked[0]]] - scores[order[ranked[1]]])
        verdict["margin_p"] = paired_test(*(fits[name][output] for name in ranked[:2]))
    verdict["margin_clear"] = bool(verdict["margin_p"] < SIGNIFICANT)
    words = _sentence(output, verdict, float(scores[order[ranked[0]]]), *how)
    told = approximation(fits[ranked[0]][output].estimator)
    verdict["sentence"] = f"{words} {ranked[0]} is approximate: {told}." if told else words
    return verdict


def _sentence(output: str, verdict: dict[str, Any], score: float, how: str, why: str) -> str:
    if not np.isfinite(score):
        return (
            f"{output}: the surrogates cannot be ranked, because no run can be left out of the "
            "training design and there is no test design."
        )
    figure = f"{score:.4g}; {why}" if why else f"{score:.4g}"
    start = f"{output}: best is {verdict['best']} ({how} {figure})."
    second, lower = verdict["runner_up"], f"Q2 {verdict['margin']:.2g} lower"
    if not second:
        return f"{start} No other surrogate can be ranked."
    if np.isnan(verdict["margin_p"]):
        return f"{start} Second is {second} ({lower}; the difference cannot be tested)."
    relation = (
        "is worse by more than the scatter between folds"
        if verdict["margin_clear"]
        else "is as good within the scatter between folds"
    )
    return f"{start} {second} {relation} ({lower}, p = {verdict['margin_p']:.2g})."


def _dataset(
    surrogates: list[str],
    outputs: list[str],
    columns: Mapping[str, Array],
    coverage: Array,
    verdicts: list[dict[str, Any]],
) -> xr.Dataset:
    dims = ("surrogate", "output")
    variables: dict[str, Any] = {
        name: (dims, columns[name], {"long_name": text}) for name, text in COLUMNS.items()
    }
    variables["coverage"] = (
        (*dims, "level"),
        coverage,
        {"long_name": "share of test values inside their intervals"},
    )
    for name in ("best", "runner_up", "sentence"):
        variables[name] = ("output", np.array([v[name] for v in verdicts], dtype=str))
    for name in ("margin", "margin_p"):
        variables[name] = ("output", np.array([v[name] for v in verdicts]))
    variables["margin_clear"] = ("output", np.array([v["margin_clear"] for v in verdicts]))
    coords = {"surrogate": surrogates, "output": outputs, "level": list(LEVELS)}
    return xr.Dataset(variables, coords, {"best": _overall(surrogates, verdicts)})


def _overall(surrogates: list[str], verdicts: list[dict[str, Any]]) -> str:
    """Largest deciding Q2 from 0 up, averaged over outputs; the first output's best without any."""
    scores = np.array([verdict["scores"] for verdict in verdicts])
    if not np.isfinite(scores).any() or len(verdicts) == 1:
        return verdicts[0]["best"] if verdicts else ""
    return surrogates[int(np.nan_to_num(np.clip(scores, 0.0, 1.0)).mean(axis=0).argmax())]
