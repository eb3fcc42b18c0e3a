"""What a learning curve says of more runs: the gain of doubling them, and how many a goal needs."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from surrogate.fitting.learning import Curve
from surrogate.fitting.power_law import PowerLaw, power_law
from surrogate.space.units import dimensionless

Array = NDArray[np.float64]
#: Value, lower and upper end of the 90 % interval.
Ends = tuple[float, float, float]
UNKNOWN: Ends = (math.nan, math.nan, math.nan)

#: No forecast goes beyond so many times the runs that there are.
REACH = 8.0
#: Numbers of runs of the drawn curve, as multiples of those there are.
AHEAD = (1.0, 1.25, 1.5, 1.75, 2.0)
#: Errors below this share of the output's spread are rounding.
ROUNDING = 1e-9
Q2, RMSE, WIDTH = "q2", "rmse", "index_width"
NAMES = {Q2: "Q2", RMSE: "RMSE", WIDTH: "index width"}


@dataclass(frozen=True)
class Goal:
    """What is to be reached: `q2`, `rmse` (in the output's unit) or `index_width`, how much."""

    kind: str
    value: float

    def __str__(self) -> str:
        return f"{NAMES[self.kind]} {self.value:g}"


@dataclass(frozen=True, eq=False)
class Forecast:
    """What more runs would bring, of one surrogate of one output.

    exponent, bend, floor  of the law of the RMSE, see `power_law`; NaN where there is none
    rmse, q2         with twice the runs
    ahead            RMSE with the `AHEAD` multiples of the runs; empty where there is no forecast
    runs             that the goal needs; infinite beyond `REACH` times those there are, NaN
                     without a goal or where the curve tells nothing
    reached          True when the median of the subsets has reached the goal
    sentences        the same in words
    rmse_goal        the goal as an RMSE; NaN without one, or for a width
    """

    exponent: float
    bend: float
    floor: float
    rmse: Ends
    q2: Ends
    runs: Ends
    reached: bool
    sentences: tuple[str, ...]
    ahead: tuple[Ends, ...] = ()
    rmse_goal: float = math.nan


def forecast(curve: Curve, variance: float, unit: str, goal: Goal | None) -> Forecast:
    """The forecast of a curve; variance: of the values that it is judged on."""
    known = curve.rmse[np.isfinite(curve.rmse)]
    if len(known) and known.max() <= ROUNDING * math.sqrt(variance):
        return _none(f"{curve.surrogate} is exact to rounding from {curve.runs[0]} runs on")
    try:
        law = power_law(curve.runs, curve.rmse, curve.whole, terms=curve.terms)
    except ValueError as error:
        return _none(f"no forecast: {error}")
    twice = law.at(2.0 * curve.whole) if law.falls else UNKNOWN
    q2 = _q2(twice, variance)
    runs, reached, told = UNKNOWN, False, ""
    if goal is not None:
        runs, reached, told = _towards(curve, law, variance, unit, goal)
    doubled = _doubled(curve, law, twice, q2, unit)
    return Forecast(
        law.exponent,
        law.bend,
        law.floor,
        twice,
        q2,
        runs,
        reached,
        tuple(one for one in (doubled, told) if one),
        tuple(law.at(factor * curve.whole) for factor in AHEAD) if law.falls else (),
        _as_rmse(goal, variance),
    )


def _as_rmse(goal: Goal | None, variance: float) -> float:
    """Q2 = 1 - RMSE^2 / variance, the other way round."""
    if goal is None or goal.kind == WIDTH:
        return math.nan
    return math.sqrt((1.0 - goal.value) * variance) if goal.kind == Q2 else goal.value


def _none(sentence: str) -> Forecast:
    return Forecast(math.nan, math.nan, math.nan, UNKNOWN, UNKNOWN, UNKNOWN, False, (sentence,))


def _q2(rmse: Ends, variance: float) -> Ends:
    """Q2 = 1 - RMSE^2 / variance, whose ends change places."""
    if not variance > 0.0:
        return UNKNOWN
    value, high, low = (1.0 - one**2 / variance for one in rmse)
    return value, low, high


def _doubled(curve: Curve, law: PowerLaw, twice: Ends, q2: Ends, unit: str) -> str:
    if not law.falls:
        return (
            f"the error of {curve.surrogate} does not surely fall with the number of runs, so no "
            "forecast is made; more runs of this kind may not help"
        )
    now = law.at(curve.whole)[0]
    value, low, high = twice
    return (
        f"twice the {curve.whole} runs would bring the RMSE of {curve.surrogate} from "
        f"{_figure(now)} to {_figure(value)} ({_figure(low)} to {_figure(high)}){_named(unit)}, "
        f"Q2 {'above 0.9999' if q2[0] > 0.9999 else f'to {q2[0]:.4f}'}"
    )


def _figure(value: float) -> str:
    return f"{value:.0f}" if abs(value) >= 1000.0 else f"{value:.3g}"


def _named(unit: str) -> str:
    return "" if dimensionless(unit) else f" {unit}"


def _towards(
    curve: Curve, law: PowerLaw, variance: float, unit: str, goal: Goal
) -> tuple[Ends, bool, str]:
    """Runs that a goal needs, whether it is reached, and a sentence."""
    limit, columns = _as_rmse(goal, variance), curve.rmse
    if goal.kind == WIDTH:
        limit, columns = goal.value, curve.width
        try:
            law = power_law(curve.runs, columns, curve.whole)
        except ValueError as error:
            return UNKNOWN, False, f"{goal}: no forecast: {error}"
    name = f"{goal}{_named(unit) if goal.kind == RMSE else ''} of {curve.surrogate}"
    known = np.isfinite(columns).any(axis=0)
    medians = np.nanmedian(columns[:, known], axis=0)
    crossed = crossing(curve.runs[known], medians, limit)
    if math.isfinite(crossed):
        number = (crossed, crossed, crossed)
        return number, True, f"{name} is reached, with about {crossed:.0f} runs"
    if not law.falls:
        return UNKNOWN, False, f"{name} is not reached, and the curve does not fall towards it"
    return _ahead(curve, law.needed(limit), name)


def _ahead(curve: Curve, needed: Ends, name: str) -> tuple[Ends, bool, str]:
    """A goal that the runs there are do not reach."""
    most = REACH * curve.whole
    value, low, high = (max(one, float(curve.whole)) if one <= most else math.inf for one in needed)
    if math.isinf(value):
        told = (
            f"{name} needs more than {most:.0f} runs, {REACH:.0f} times those there are, "
            "if it can be reached at all; the curve does not tell how many"
        )
    elif math.isinf(high):
        told = f"{name} needs about {value:.0f} runs ({low:.0f} at least)"
    else:
        told = f"{name} needs about {value:.0f} runs ({low:.0f} to {high:.0f})"
    return (value, low, high), False, told


def crossing(runs: NDArray[np.intp], values: Array, limit: float) -> float:
    """Where a curve (k,) comes below the limit for good, on lines in logarithms; NaN: nowhere."""
    above = np.flatnonzero(values > limit)
    if not len(above):
        return float(runs[0])
    last = above[-1]
    if last == len(values) - 1:
        return math.nan
    ends = np.log(values[last : last + 2])
    share = (ends[0] - math.log(limit)) / (ends[0] - ends[1]) if limit > 0.0 else 1.0
    return float(runs[last] * (runs[last + 1] / runs[last]) ** share)
