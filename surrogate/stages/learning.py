"""Learning curves of the scalar outputs, and what more runs would bring."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from itertools import product
from typing import Any

import numpy as np
import xarray as xr

from surrogate.errors import FitError
from surrogate.estimator import Array, Regressor
from surrogate.fitting import comparison as comparing
from surrogate.fitting import fit as fitting
from surrogate.fitting.best import BEST
from surrogate.fitting.fit import Fit
from surrogate.fitting.forecast import AHEAD, WIDTH, Forecast, Goal, forecast
from surrogate.fitting.learning import SUBSETS, Curve, Runs, has_curve, has_given_terms, learn
from surrogate.fitting.noise import q2_of_mean
from surrogate.runs import dataset as rundata
from surrogate.space.space import Space
from surrogate.stages.comparison import TEST
from surrogate.stages.fits import Fits, Surrogate, lower_runs, with_lower
from surrogate.stages.sensitivity import SensitivityMethod, indices
from surrogate.stages.stage import Job, Result

ALL = "all"
#: Of a curve that nobody asked for: its subsets, and the most runs.
UNASKED, MOST_UNASKED = 10, 300
#: Shares of the subsets between which the band lies, and its middle.
BAND = {"_low": 0.05, "": 0.5, "_high": 0.95}
SCORES = {
    "q2": "Q2 of subsets of the training runs",
    "rmse": "RMSE of subsets of the training runs",
    "width": "widest interval of a total index, of subsets of the training runs",
}
FORECASTS = {
    "rmse_doubled": "RMSE with twice the runs",
    "q2_doubled": "Q2 with twice the runs",
    "runs_needed": "runs that the goal needs; infinite beyond eight times those there are",
}


@dataclass(frozen=True)
class LearningRule:
    """The entry `learning:`: goals by output, and whose curves.

    surrogate  `best` (and polynomials, which cost nothing), `all`, or a name
    """

    until: Mapping[str, Goal] = field(default_factory=dict)
    surrogate: str = BEST
    subsets: int = SUBSETS


@dataclass(frozen=True, eq=False)
class Learnt:
    """A curve with its forecast."""

    curve: Curve
    goal: Goal | None
    forecast: Forecast


def jobs(
    learning_rule: LearningRule | None,
    sensitivity_method: SensitivityMethod | None,
    space: Space,
    surrogates: Mapping[str, Surrogate],
    runs: xr.Dataset,
    fits: Fits,
    comparison: xr.Dataset | None,
    noise: Collection[str] = (),
) -> list[Job]:
    """A curve of each chosen surrogate of each scalar output.

    noise: outputs that are mostly noise. Where no curve is asked for, their best surrogates have
    one all the same, for it tells whether more runs would help.
    """
    if comparison is None:
        return []
    best = comparing.best(comparison)
    if learning_rule is None:
        fits = {
            name: {
                output: fit
                for output, fit in by_output.items()
                if output in noise and best[output] == name and _is_cheap(fit, runs)
            }
            for name, by_output in fits.items()
        }
        learning_rule = LearningRule(subsets=UNASKED)
    found = []
    for name, by_output in fits.items():
        for output, fit in by_output.items():
            test, word = _test(runs, output), learning_rule.surrogate
            if fit.values.ndim > 1 or not _chosen(word, fit, best[output], test is not None):
                continue
            goal = learning_rule.until.get(output)
            wanted = word != BEST or name == best[output]
            asked = goal is not None and goal.kind == WIDTH and wanted
            found.append(
                Job(
                    f"{name} of {output}",
                    learnt,
                    {
                        "fit": fit,
                        "estimator": with_lower(
                            surrogates[name].estimator, lower_runs(surrogates[name], output, runs)
                        ),
                        "test": test,
                        "subsets": learning_rule.subsets,
                        "unit": str(runs[output].attrs.get("units", "")),
                        "goal": goal,
                        "method": sensitivity_method if asked else None,
                    },
                )
            )
    return found


def _is_cheap(fit: Fit, runs: xr.Dataset) -> bool:
    """Whether a curve that nobody asked for costs seconds, and can be had."""
    return len(fit.values) <= MOST_UNASKED and has_curve(fit, _test(runs, fit.output) is not None)


def _chosen(word: str, fit: Fit, best: str, tested: bool) -> bool:
    """Whether a curve is asked for; polynomials beside the best one only where they have one."""
    if word == BEST:
        beside = has_given_terms(fit.estimator) and has_curve(fit, tested)
        return fit.surrogate == best or beside
    return word in (ALL, fit.surrogate)


def _test(runs: xr.Dataset, output: str) -> Runs | None:
    if TEST not in runs["design"].values.astype(str):
        return None
    coded, values = rundata.training(runs, output, (TEST,))
    return (coded, values) if len(values) > 1 else None


def learnt(
    fit: Fit,
    estimator: Regressor,
    test: Runs | None,
    subsets: int,
    unit: str,
    goal: Goal | None,
    method: SensitivityMethod | None,
) -> Learnt:
    """One curve and its forecast; raises `FitError` when there are too few runs."""
    width = partial(index_width, method, fit, estimator) if method is not None else None
    try:
        curve = learn(fit, estimator, test, subsets=subsets, width=width)
    except FitError as error:
        raise FitError(f"learning curve of {fit.output}: {error}") from None
    if goal is not None and goal.kind == WIDTH and width is None:
        goal = None
    judged = fit.values if test is None else test[1]
    return Learnt(curve, goal, forecast(curve, float(np.var(judged)), unit, goal))


def index_width(
    method: SensitivityMethod, fit: Fit, estimator: Regressor, coded: Array, values: Array
) -> float:
    """Width of the widest interval of a total index, from some of the runs."""
    own = fitting.fit(
        fit.space, coded, values, estimator, surrogate=fit.surrogate, output=fit.output
    )
    of_mean = q2_of_mean(own)
    table = indices(method, fit.space, own, own.q2 if of_mean is None else of_mean)
    return float((table["total_high"] - table["total_low"]).max())


def gather(done: Iterable[tuple[Job, Result]]) -> Result:
    """One dataset of all curves, and why others could not be had."""
    results = [result for _, result in done]
    lost = tuple(sentence for result in results for sentence in result.not_done)
    found = [result.value for result in results if result.value is not None]
    return Result(_dataset(found) if found else None, lost)


def _dataset(found: Sequence[Learnt]) -> xr.Dataset:
    """Curves over (surrogate, output, size); sizes that a curve does not have are NaN."""
    surrogates = list(dict.fromkeys(one.curve.surrogate for one in found))
    outputs = list(dict.fromkeys(one.curve.output for one in found))
    sizes = max(len(one.curve.runs) for one in found)
    shape = (len(surrogates), len(outputs))
    numbers = {name: np.full((*shape, sizes), np.nan) for name in ("runs", *_columns(SCORES))}
    single = {
        name: np.full(shape, np.nan)
        for name in ("exponent", "bend", "floor", "rmse_goal", *_columns(FORECASTS))
    }
    ahead = {name: np.full((*shape, len(AHEAD)), np.nan) for name in _columns(("rmse_ahead",))}
    reached, sentences = np.zeros(shape, dtype=bool), np.full(shape, "", dtype=object)
    whole = np.zeros(shape, dtype=int)
    for one in found:
        at = surrogates.index(one.curve.surrogate), outputs.index(one.curve.output)
        for name, column in _curve(one.curve).items():
            numbers[name][at][: len(column)] = column
        if one.forecast.ahead:
            value, low, high = np.array(one.forecast.ahead).T
            for end, column in zip(BAND, (low, value, high), strict=True):
                ahead["rmse_ahead" + end][at] = column
        for name, value in _forecast(one.forecast).items():
            single[name][at] = value
        reached[at], whole[at] = one.forecast.reached, one.curve.whole
        sentences[at] = "\n".join(one.forecast.sentences)
    dims = ("surrogate", "output")
    variables: dict[str, Any] = {
        name: ((*dims, "size"), values) for name, values in numbers.items()
    }
    variables |= {name: ((*dims, "ahead"), values) for name, values in ahead.items()}
    variables |= {name: (dims, values) for name, values in single.items()}
    variables |= {
        "training_runs": (dims, whole),
        "reached": (dims, reached),
        "sentence": (dims, sentences.astype(str)),
        "goal": ("output", np.array([_goal(found, output) for output in outputs], dtype=str)),
    }
    attributes = {"judged": found[0].curve.judged, "band": "5, 50 and 95 % of the subsets"}
    table = xr.Dataset(variables, _coordinates(surrogates, outputs), attributes)
    for name, text in {**SCORES, **FORECASTS}.items():
        table[name].attrs["long_name"] = text
    return table.drop_vars([n for n in table if str(n).startswith("width") and _empty(table[n])])


def _coordinates(surrogates: list[str], outputs: list[str]) -> dict[str, list[str] | list[float]]:
    return {"surrogate": surrogates, "output": outputs, "ahead": list(AHEAD)}


def _empty(column: xr.DataArray) -> bool:
    return bool(np.isnan(column.values).all())


def _columns(names: Iterable[str]) -> list[str]:
    return [name + end for name, end in product(names, BAND)]


def _curve(curve: Curve) -> dict[str, Array]:
    """Columns of a curve: runs, and the band of each score."""
    found: dict[str, Array] = {"runs": curve.runs.astype(float)}
    for name in SCORES:
        scores: Array = getattr(curve, name)
        known = np.isfinite(scores).any(axis=0)
        for end, share in BAND.items():
            found[name + end] = np.full(len(curve.runs), np.nan)
            found[name + end][known] = np.nanquantile(scores[:, known], share, axis=0)
    return found


def _forecast(found: Forecast) -> dict[str, float]:
    values = {
        "exponent": found.exponent,
        "bend": found.bend,
        "floor": found.floor,
        "rmse_goal": found.rmse_goal,
    }
    for name, ends in zip(FORECASTS, (found.rmse, found.q2, found.runs), strict=True):
        value, low, high = ends
        values |= {name: value, f"{name}_low": low, f"{name}_high": high}
    return values


def _goal(found: Sequence[Learnt], output: str) -> str:
    goals = [str(one.goal) for one in found if one.curve.output == output and one.goal is not None]
    return goals[0] if goals else ""
