"""Coefficients of a polynomial with their intervals, largest first."""

from __future__ import annotations

import numpy as np
from markupsafe import Markup

from surrogate.report import digits
from surrogate.report.drawing import (
    WIDTH,
    Scale,
    drawing,
    label_room,
    line,
    mark,
    shortened,
    span,
    text,
)

MOST = 30
ROW = 20.0


def coefficient_plot(terms, value, low, high, unit: str, surrogate: str) -> Markup:
    """A row a term: coefficient and interval, in output units per coded unit.

    terms (k,) without the constant; value, low, high (k,), NaN where there is no
    interval. Shows the 30 largest by magnitude.
    """
    order = np.argsort(-np.abs(value))[:MOST]
    left = label_room([terms[k] for k in order])
    reach = span(value, low, high, include=[0.0])
    x = Scale(*reach, left, WIDTH - 14)
    top, floor = 26.0, 26.0 + ROW * len(order)
    marks = [line(x(v), top, x(v), floor, "grid") for v in x.ticks(4)]
    marks += [text(x(v), floor + 14, words, "tick", "middle")
              for v, words in zip(x.ticks(4), x.tick_words(4), strict=True)]
    marks.append(line(x(0.0), top - 4, x(0.0), floor, "axis"))
    for place, k in enumerate(order):
        y = top + ROW * (place + 0.5)
        marks.append(text(left - 8, y + 4, shortened(terms[k], left - 8), "name", "end"))
        marks.append(line(x(0.0), y, x(value[k]), y, "stem"))
        if np.isfinite(low[k]) and np.isfinite(high[k]):
            marks.append(line(x(low[k]), y, x(high[k]), y, "whisker"))
        sure = not np.isfinite(low[k]) or low[k] > 0.0 or high[k] < 0.0
        marks.append(mark("filled" if sure else "hollow", x(value[k]), y, data_tip=(
            f"{terms[k]}\n{digits.with_unit(digits.with_interval(value[k], low[k], high[k]), unit)}"
        )))
    label = f"{digits.labelled('coefficient', unit)[:-1]} per coded unit)"
    marks.append(text((left + WIDTH) / 2, floor + 31, label, "label", "middle"))
    return drawing(WIDTH, floor + 40, *marks,
                   says=f"Coefficients of {surrogate} with intervals, largest first")
