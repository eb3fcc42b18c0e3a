"""Calibration: how often intervals hold the truth, beside how often they should."""

from __future__ import annotations

import numpy as np
from markupsafe import Markup
from scipy import stats

from surrogate.report import digits
from surrogate.report.drawing import Panel, drawing, line, mark, path


def calibration_plot(level: np.ndarray, observed: np.ndarray, runs: int, what: str) -> Markup:
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
    return drawing(
        360,
        340,
        path(edges, "band", closed=True),
        panel.frame("level of the intervals (–)", "held-out values inside (–)"),
        diagonal,
        *marks,
        says=f"Calibration of the intervals of {what}",
    )
