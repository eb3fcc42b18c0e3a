"""The figure that an adaptive design is judged by, against the number of its runs."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from surrogate.report import digits
from surrogate.report.drawing import WIDTH, Panel, line, mark, path, span
from surrogate.report.plot import Plot, column, plot

HEIGHT = 260.0


def reviews_plot(
    runs: Sequence[int], values: Sequence[float], goal: float, label: str, design: str
) -> Plot:
    """A line through the reviews; goal: a level line, NaN for none. label: with the unit."""
    level = [goal] if np.isfinite(goal) else []
    panel = Panel.within(
        span(np.asarray(runs, dtype=float), pad=0.05),
        span(np.asarray(values), include=level),
        height=HEIGHT,
    )
    places = [(panel.x(float(n)), panel.y(value)) for n, value in zip(runs, values, strict=True)]
    marks: list[object] = [panel.frame("runs (–)", label)]
    for value in level:
        marks.append(line(panel.x.start, panel.y(value), panel.x.end, panel.y(value), "threshold"))
    marks.append(path(places, "curve"))
    marks += [
        mark("filled", x, y, data_tip=f"{digits.quantity(n, 'run')}\n{label} {digits.figure(v)}")
        for (x, y), n, v in zip(places, runs, values, strict=True)
    ]
    first, last = digits.figure(values[0]), digits.figure(values[-1])
    return plot(
        WIDTH,
        HEIGHT,
        *marks,
        title=f"Reviews of design {design}",
        says=f"{label} from {first} with {runs[0]} runs to {last} with {runs[-1]}.",
        numbers=(column("runs", list(runs)), column(label, list(values))),
    )
