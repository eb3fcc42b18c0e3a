"""Coefficients of a polynomial with their intervals, largest first."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from markupsafe import Markup

from surrogate.report import digits
from surrogate.report.drawing import WIDTH, group, line, mark
from surrogate.report.figures.rows import Rows, whisker
from surrogate.report.plot import Plot, column, plot

MOST = 30
ROW = 20.0


def coefficient_plot(
    terms: Sequence[str],
    value: np.ndarray,
    low: np.ndarray,
    high: np.ndarray,
    unit: str,
    surrogate: str,
) -> Plot:
    """A row a term: coefficient and interval, in output units per coded unit.

    terms (k,) without the constant; value, low, high (k,), NaN where there is no
    interval. Shows the 30 largest by magnitude.
    """
    order = np.argsort(-np.abs(value), kind="stable")[:MOST]
    numbers = [
        float(v) for v in np.concatenate([value[order], low[order], high[order]]) if np.isfinite(v)
    ]
    rows = Rows.of([terms[k] for k in order], numbers, ROW, most=150.0)
    marks = [rows.frame(f"{digits.labelled('coefficient', unit)[:-1]} per coded unit)")]
    for place, k in enumerate(order):
        marks.append(rows.name(place, terms[k]))
        marks.append(
            _term(rows, place, terms[k], (float(value[k]), float(low[k]), float(high[k])), unit)
        )
    largest = [
        f"{terms[k]} {digits.with_unit(digits.with_interval(value[k], low[k], high[k]), unit)}"
        for k in order[:3]
    ]
    return plot(
        WIDTH,
        rows.height,
        *marks,
        title=f"Coefficients of {surrogate}",
        says=f"{digits.quantity(len(order), 'term')}, largest first: {'; '.join(largest)}.",
        numbers=(
            column("term", [terms[k] for k in order]),
            column(digits.labelled("coefficient", unit), value[order]),
            column("lower end", low[order]),
            column("upper end", high[order]),
        ),
    )


def _term(
    rows: Rows, place: int, term: str, numbers: tuple[float, float, float], unit: str
) -> Markup:
    """Stem from zero, whisker, and a disc: filled when zero lies outside the interval."""
    value, low, high = numbers
    y, bounded = rows.middle(place), np.isfinite(low) and np.isfinite(high)
    kind = "hollow" if bounded and low <= 0.0 <= high else "filled"
    tip = f"{term}\n{digits.with_unit(digits.with_interval(value, low, high), unit)}"
    return group(
        line(rows.x(0.0), y, rows.x(value), y, "stem"),
        whisker(rows.x, low, high, y) if bounded else "",
        mark(kind, rows.x(value), y, data_tip=tip),
    )
