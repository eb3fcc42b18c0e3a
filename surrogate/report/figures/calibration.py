"""Calibration: how often intervals hold the truth, beside how often they should."""

from __future__ import annotations

import numpy as np
from scipy import stats

from surrogate.report import digits
from surrogate.report.drawing import Panel, line, mark, path
from surrogate.report.plot import Plot, column, plot


def calibration_plot(level: np.ndarray, observed: np.ndarray, runs: int, what: str) -> Plot:
    """Observed coverage over the intervals' level, both shares, shape (k,).

    The band holds 95 % of the coverages that honest intervals would show on so many
    runs (binomial), so that points inside it are no evidence of anything.
    """
    panel = Panel.within((0.0, 1.0), (0.0, 1.0), height=340.0)
    shares = np.linspace(0.0, 1.0, 51)
    low, high = (stats.binom.ppf(tail, runs, shares) / runs for tail in (0.025, 0.975))
    edges = [*zip(panel.x(shares), panel.y(np.maximum(low, 0.0)), strict=True)]
    edges += [*zip(panel.x(shares), panel.y(np.maximum(high, 0.0)), strict=True)][::-1]
    marks = [
        mark(
            "filled",
            panel.x(x),
            panel.y(y),
            4.0,
            data_tip=(
                f"{digits.percent(float(x))} intervals\n"
                f"contain {digits.percent(float(y))} of the values"
            ),
        )
        for x, y in zip(level, observed, strict=True)
        if np.isfinite(y)
    ]
    diagonal = line(panel.x(0.0), panel.y(0.0), panel.x(1.0), panel.y(1.0), "reference")
    expected = [stats.binom.ppf(tail, runs, level) / runs for tail in (0.025, 0.975)]
    outside = int(((observed < expected[0]) | (observed > expected[1])).sum())
    return plot(
        360,
        340,
        path(edges, "band", closed=True),
        panel.frame("level of the intervals (–)", "held-out values inside (–)"),
        diagonal,
        *marks,
        title=f"Calibration of the intervals of {what}",
        says=(
            f"{digits.quantity(runs, 'held-out run')}. Intervals of the highest level, "
            f"{digits.percent(float(level[-1]))}, contain {digits.percent(float(observed[-1]))} of "
            f"the values. {outside or 'None'} of {len(level)} levels "
            f"{'lies' if outside == 1 else 'lie'} outside the band of chance."
        ),
        numbers=(
            column("level", level),
            column("held-out values inside", observed),
            column("band, lower end", expected[0]),
            column("band, upper end", expected[1]),
        ),
    )
