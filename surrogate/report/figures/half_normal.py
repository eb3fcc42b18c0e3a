"""Half-normal plot of effects: those that are noise lie on a line through zero (Daniel 1959)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy import stats

from surrogate.report import digits
from surrogate.report.drawing import WIDTH, Panel, group, line, mark, span, text
from surrogate.report.plot import Plot, column, plot

HEIGHT = 340.0
#: Names that are written beside their points.
NAMED = 8


def half_normal_plot(
    terms: Sequence[str], value: np.ndarray, pse: float, margin: float, unit: str, surrogate: str
) -> Plot:
    """Sizes of coefficients over half-normal quantiles, with the line of noise and the margin.

    terms (m,) without the constant; value (m,). Noise of standard deviation `pse` lies about
    the line; beyond `margin` (dashed) a coefficient is active.
    """
    order = np.argsort(np.abs(value), kind="stable")
    sizes = np.abs(value)[order]
    quantiles = stats.halfnorm.ppf((np.arange(len(order)) + 0.5) / len(order))
    panel = Panel.within(
        span(quantiles, include=[0.0]), span(sizes, include=[0.0, margin], pad=0.08), height=HEIGHT
    )
    top = min(panel.x.high, panel.y.high / pse if pse > 0.0 else np.inf)
    active = [k for k in range(len(order)) if sizes[k] > margin]
    words = [
        text(panel.x(quantiles[k]) - 7, panel.y(sizes[k]) + 4, terms[order[k]], "name", "end")
        for k in active[-NAMED:]
    ]

    def said_of(number: float) -> str:
        return digits.with_unit(digits.figure(number), unit)

    said = digits.listing([terms[order[k]] for k in reversed(active)], NAMED) or "none"
    return plot(
        WIDTH,
        HEIGHT,
        panel.frame("half-normal quantile", f"size of the {digits.labelled('coefficient', unit)}"),
        line(panel.x(0.0), panel.y(0.0), panel.x(top), panel.y(pse * top), "reference"),
        line(panel.x.start, panel.y(margin), panel.x.end, panel.y(margin), "threshold"),
        group(
            *(
                mark(
                    "filled" if k in active else "hollow",
                    panel.x(quantiles[k]),
                    panel.y(sizes[k]),
                    data_tip=f"{terms[order[k]]}\n{said_of(value[order[k]])}",
                )
                for k in range(len(order))
            )
        ),
        *words,
        title=f"Half-normal plot of the coefficients of {surrogate}",
        says=f"Beyond the margin of {said_of(margin)}: {said}.",
        numbers=(
            column("term", [terms[k] for k in order]),
            column("half-normal quantile", quantiles),
            column(digits.labelled("size", unit), sizes),
        ),
    )
