"""A learning curve: the error against the number of runs, with its band and what lies ahead."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from surrogate.report import digits
from surrogate.report.drawing import WIDTH, Panel, Scale, Ticks, line, mark, path, span
from surrogate.report.plot import Plot, column, plot

HEIGHT = 300.0
#: Tick words of an axis at most.
MOST_TICKS = 6


@dataclass(frozen=True, eq=False)
class Band:
    """RMSE with its lower and upper end at numbers of runs, each (k,)."""

    runs: np.ndarray
    value: np.ndarray
    low: np.ndarray
    high: np.ndarray


def learning_plot(
    seen: Band, ahead: Band, goal: float, surrogate: str, output: str, unit: str
) -> Plot:
    """RMSE of subsets with their band; dashed the law beyond, with its interval.

    Both axes are logarithmic: a power law is a straight line. ahead: empty where there is no
    forecast. goal: of the RMSE, NaN for none.
    """
    level = [goal] if np.isfinite(goal) and goal > 0.0 else []
    ends = [getattr(one, end) for one in (seen, ahead) for end in _ENDS]
    panel = Panel.within(
        span(_log(seen.runs), _log(ahead.runs), pad=0.03),
        span(*map(_log, ends), include=[float(_log(np.array(goal)))] if level else []),
        height=HEIGHT,
    )

    def placed(runs: np.ndarray, values: np.ndarray) -> list[tuple[float, float]]:
        return list(zip(panel.x(_log(runs)), panel.y(_log(values)), strict=True))

    marks: list[object] = [
        path([*placed(one.runs, one.high), *placed(one.runs, one.low)[::-1]], "band", closed=True)
        for one in (seen, ahead)
        if len(one.runs)
    ]
    ticks = _ticks(panel.x), _ticks(panel.y)
    label = digits.labelled("RMSE", unit)
    marks.append(panel.frame("training runs (–)", label, x_ticks=ticks[0], y_ticks=ticks[1]))
    for value in level:
        y = panel.y(math.log10(value))
        marks.append(line(panel.x.start, y, panel.x.end, y, "threshold"))
    marks.append(path(placed(seen.runs, seen.value), "curve"))
    if len(ahead.runs):
        marks.append(path(placed(ahead.runs, ahead.value), "curve dashed"))
    marks += [
        mark("filled", x, y, data_tip=_tip(*numbers, unit))
        for (x, y), numbers in zip(
            placed(seen.runs, seen.value),
            zip(seen.runs, seen.value, seen.low, seen.high, strict=True),
            strict=True,
        )
    ]
    both = [np.concatenate([getattr(seen, k), getattr(ahead, k)]) for k in ("runs", *_ENDS)]
    return plot(
        WIDTH,
        HEIGHT,
        *marks,
        title=f"Learning curve of {surrogate} for {output}",
        says=_says(seen, ahead, unit),
        numbers=(
            column("training runs", np.rint(both[0]).astype(int)),
            column("from", ["subsets"] * len(seen.runs) + ["forecast"] * len(ahead.runs)),
            column(digits.labelled("RMSE", unit), both[1]),
            column("lower end (5 %)", both[2]),
            column("upper end (95 %)", both[3]),
        ),
    )


def _log(values: np.ndarray) -> np.ndarray:
    """Logarithm to base ten; NaN of what is not above zero."""
    return np.log10(np.where(np.asarray(values) > 0.0, values, np.nan))


def _ticks(scale: Scale) -> Ticks:
    """Round values on a scale of logarithms, as printed."""
    return [(math.log10(value), digits.number(value)) for value in _round_values(scale)]


def _round_values(scale: Scale) -> list[float]:
    """As many of 1, 2, 5 times powers of ten as fit on a scale of logarithms."""
    powers = range(math.floor(scale.low), math.ceil(scale.high) + 1)
    for digits_of_power in ((1, 2, 3, 4, 5, 6, 7, 8, 9), (1, 2, 5), (1, 3), (1,)):
        found = [
            digit * 10.0**power
            for power in powers
            for digit in digits_of_power
            if scale.low <= math.log10(digit * 10.0**power) <= scale.high
        ]
        if len(found) <= MOST_TICKS:
            return found
    return found[:: math.ceil(len(found) / MOST_TICKS)]


_ENDS = ("value", "low", "high")


def _tip(runs: float, value: float, low: float, high: float, unit: str) -> str:
    words = digits.with_unit(digits.with_interval(value, low, high), unit)
    return f"{digits.quantity(int(runs), 'run')}\nRMSE {words}"


def _says(seen: Band, ahead: Band, unit: str) -> str:
    first, last = (digits.with_unit(digits.figure(v), unit) for v in seen.value[[0, -1]])
    told = f"RMSE from {first} with {seen.runs[0]:.0f} runs to {last} with {seen.runs[-1]:.0f}."
    if not len(ahead.runs):
        return f"{told} No forecast."
    then = digits.with_unit(digits.figure(ahead.value[-1]), unit)
    return f"{told} Forecast with {ahead.runs[-1]:.0f}: {then}."
