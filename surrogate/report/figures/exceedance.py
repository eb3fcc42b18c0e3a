"""How probable it is that an output passes each of its values, down to a rare limit."""

from __future__ import annotations

import math

import numpy as np

from surrogate.reliability.solution import Reliability
from surrogate.report import digits
from surrogate.report.drawing import WIDTH, Panel, Ticks, line, mark, path, span
from surrogate.report.plot import Plot, column, plot

HEIGHT = 280.0
#: Tick words of the axis of probabilities at most.
MOST_TICKS = 6


def exceedance_plot(found: Reliability, label: str) -> Plot:
    """Probability over value, on a logarithmic scale; the limit, and the answer with its interval.

    label: the output with its unit
    """
    problem = found.problem
    order = np.argsort(found.levels)
    values, shares = found.levels[order], found.exceedance[order]
    ends = [one for one in (found.low, found.high, found.probability) if one > 0.0]
    panel = Panel.within(
        span(values, include=[problem.limit]),
        span(np.log10(shares), include=[math.log10(one) for one in ends]),
        height=HEIGHT,
    )
    x = panel.x(problem.limit)
    side = "above" if problem.sign > 0 else "below"
    marks: list[object] = [
        panel.frame(label, f"probability of a value {side}", y_ticks=_ticks(panel)),
        line(x, panel.y.start, x, panel.y.end, "threshold"),
        path(zip(panel.x(values), panel.y(np.log10(shares)), strict=True), "curve"),
    ]
    if found.probability > 0.0:
        low = math.log10(found.low) if found.low > 0.0 else panel.y.low
        marks.append(line(x, panel.y(low), x, panel.y(math.log10(found.high)), "whisker"))
        tip = digits.with_interval(found.probability, found.low, found.high)
        marks.append(mark("filled", x, panel.y(math.log10(found.probability)), data_tip=tip))
    return plot(
        WIDTH,
        HEIGHT,
        *marks,
        title=f"{problem.name}: probability of {problem.output} {side} a value",
        says=f"{digits.capital(str(found))}.",
        numbers=(
            column(label, values),
            column(f"probability {side}", [digits.figure(one) for one in shares]),
        ),
    )


def _ticks(panel: Panel) -> Ticks:
    """Powers of ten, as many as there is room for."""
    powers = range(math.ceil(panel.y.low), math.floor(panel.y.high) + 1)
    step = max(1, math.ceil(len(powers) / MOST_TICKS))
    return [(float(power), digits.figure(10.0**power, 1)) for power in powers[::-1][::step]]
