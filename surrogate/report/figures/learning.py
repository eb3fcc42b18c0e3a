"""A learning curve: the error against the number of runs, with its band and what lies ahead."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from surrogate.report import digits
from surrogate.report.drawing import WIDTH, Panel, line, mark, path, span
from surrogate.report.plot import Plot, column, plot

HEIGHT = 300.0


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

    ahead: empty where there is no forecast. goal: of the RMSE, NaN for none.
    """
    finite = [goal] if np.isfinite(goal) else []
    top = [one.value for one in (seen, ahead)] + [seen.high[-3:], ahead.high]
    panel = Panel.within(
        span(seen.runs, ahead.runs, pad=0.03), span(*top, include=[0.0, *finite]), height=HEIGHT
    )
    ceiling = panel.y.high
    marks: list[object] = []
    for one in (seen, ahead):
        if len(one.runs):
            upper = zip(panel.x(one.runs), panel.y(np.minimum(one.high, ceiling)), strict=True)
            lower = zip(panel.x(one.runs), panel.y(np.minimum(one.low, ceiling)), strict=True)
            marks.append(path([*upper, *[*lower][::-1]], "band", closed=True))
    marks.append(panel.frame("training runs (–)", digits.labelled("RMSE", unit)))
    if np.isfinite(goal):
        left, right = panel.x.start, panel.x.end
        marks.append(line(left, panel.y(goal), right, panel.y(goal), "threshold"))
    marks.append(path(zip(panel.x(seen.runs), panel.y(seen.value), strict=True), "curve"))
    if len(ahead.runs):
        line_ahead = zip(panel.x(ahead.runs), panel.y(ahead.value), strict=True)
        marks.append(path(line_ahead, "curve dashed"))
    marks += [
        mark("filled", panel.x(n), panel.y(y), data_tip=_tip(n, y, low, high, unit))
        for n, y, low, high in zip(seen.runs, seen.value, seen.low, seen.high, strict=True)
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
