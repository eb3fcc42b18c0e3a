"""Candidates of a goal: what is expected of an output at each, the goal, the solver's answers."""

from __future__ import annotations

import numpy as np

from surrogate.report import digits
from surrogate.report.drawing import WIDTH, Panel, group, mark, path, span, tag
from surrogate.report.figures.rows import TOP, Rows, whisker
from surrogate.report.plot import Plot, column, plot
from surrogate.solving.solution import Solution

#: Height of a row.
ROW = 26.0


def promises_plot(solution: Solution, output: str, label: str) -> Plot:
    """A row a candidate: expectation and 95 % interval, the band of the goal, verifying runs.

    label: the output with its unit.
    """
    at = [one.predicted[output] for one in solution.candidates]
    checked = [one.verified.values[output] if one.verified else () for one in solution.candidates]
    goal = solution.ends.get(output)
    numbers = [number for one in at for number in (one.low, one.high)]
    numbers += [value for values in checked for value in values]
    numbers += list(goal or ())
    names = [f"candidate {k + 1}" for k in range(len(at))]
    rows = Rows.of(names, numbers, ROW, zero=False)
    marks = [_band(rows, *goal)] if goal else []
    marks.append(rows.frame(label))
    for k, one in enumerate(at):
        y = rows.middle(k)
        marks += [rows.name(k, names[k]), whisker(rows.x, one.low, one.high, y)]
        marks.append(mark("filled", rows.x(one.value), y))
        marks += [mark("cross", rows.x(value), y) for value in checked[k]]
    words = f"The goal is {digits.interval(*goal)}. " if goal else ""
    means = [float(np.mean(values)) if values else np.nan for values in checked]
    return plot(
        WIDTH,
        rows.height,
        *marks,
        title=f"{solution.problem.name}: {output} at the candidates",
        says=f"{words}Expected at the best candidate: {digits.number(at[0].value, 4)}, 95 % "
        f"interval {digits.interval(at[0].low, at[0].high)}.",
        numbers=(
            column("candidate", np.arange(1, len(at) + 1)),
            column(f"{label} expected", [one.value for one in at]),
            column("lower end", [one.low for one in at]),
            column("upper end", [one.high for one in at]),
            column("solver (mean)", means),
        ),
    )


def _band(rows: Rows, low: float, high: float) -> object:
    """The goal as a band behind all rows."""
    left, right = rows.x(low), rows.x(high)
    return tag("rect", x=left, y=TOP, width=right - left, height=rows.floor - TOP, class_="band")


def front_plot(solution: Solution, labels: tuple[str, str]) -> Plot:
    """The Pareto front of the first two objectives; labels: these outputs with their units."""
    first, second = (one.output for one in solution.problem.objectives[:2])
    x = np.array([one.predicted[first].value for one in solution.candidates])
    y = np.array([one.predicted[second].value for one in solution.candidates])
    panel = Panel.within(span(x), span(y))
    marks = [panel.frame(*labels)]
    if len(solution.problem.objectives) == 2:
        marks.append(path(zip(panel.x(x), panel.y(y), strict=True), "curve"))
    marks += [
        mark("filled", panel.x(a), panel.y(b), data_tip=f"candidate {k + 1}")
        for k, (a, b) in enumerate(zip(x, y, strict=True))
    ]
    return plot(
        WIDTH,
        300.0,
        group(*marks),
        title=f"{solution.problem.name}: front of {first} and {second}",
        says=f"{digits.quantity(len(x), 'candidate')}: {first} from {digits.number(x.min(), 4)} to "
        f"{digits.number(x.max(), 4)}, {second} from {digits.number(y.min(), 4)} to "
        f"{digits.number(y.max(), 4)}.",
        numbers=(
            column("candidate", np.arange(1, len(x) + 1)),
            column(labels[0], x),
            column(labels[1], y),
        ),
    )
