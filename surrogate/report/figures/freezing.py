"""What may be frozen: the largest each index can be, on a scale that shows small ones."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from surrogate.report import digits
from surrogate.report.drawing import WIDTH, Scale, group, label_room, mark, text
from surrogate.report.figures.rows import Rows, band_within, whisker
from surrogate.report.figures.sobol import SHARE
from surrogate.report.plot import Plot, column, plot

#: Least and largest height of a row.
ROW, HIGHEST_ROW = 25.0, 80.0
#: Powers of ten of the scale's lower end: never more than the first, at least the second.
LOWEST, HIGHEST_START = -4, -2
#: Room of the decision at the right.
DECISION = 52.0


def freezing_plot(
    names: Sequence[str],
    index: Mapping[str, np.ndarray],
    frozen: Sequence[str],
    freeze_below: float,
    title: str,
    *,
    trusted: bool = True,
    height: float = 0.0,
) -> Plot:
    """A row a parameter: its index on a scale of powers of ten, the interval, the decision.

    index: `value`, `low` and `high`, each (parameter,). An index off the left end stands there.
    """
    value, low, high = (np.asarray(index[part], dtype=float) for part in ("value", "low", "high"))
    high = np.where(np.isfinite(high), high, value)
    order = np.argsort(-np.nan_to_num(high, nan=-1.0), kind="stable")
    start = _start(value, freeze_below)
    room = label_room(names, 104.0)
    row = band_within(height, len(names), ROW, HIGHEST_ROW)
    rows = Rows(Scale(start, 0.0, room, WIDTH - DECISION), row, len(names))

    def placed(number: float) -> float:
        return math.log10(min(max(number, 10.0**start), 1.0)) if number > 0.0 else start

    powers = [(float(p), digits.number(10.0**p)) for p in range(start, 1)]
    marks = [rows.scale(SHARE, powers), rows.threshold(placed(freeze_below))]
    for place, k in enumerate(order):
        kept = names[k] not in frozen
        y = rows.middle(place)
        marks.append(rows.name(place, names[k]))
        marks.append(
            text(
                WIDTH - DECISION + 9, y + 4, "keep" if kept else "freeze", "" if kept else "strong"
            )
        )
        if not np.isfinite(value[k]):
            continue
        tip = f"{names[k]}\n{digits.with_interval(value[k], low[k], high[k])}"
        if np.isfinite(low[k]):
            marks.append(whisker(rows.x, placed(low[k]), placed(high[k]), y))
        marks.append(
            mark("filled" if kept else "hollow", rows.x(placed(value[k])), y, data_tip=tip)
        )
    return plot(
        WIDTH,
        rows.height,
        group(*marks, class_=None if trusted else "faded"),
        title=title,
        says=(
            f"Limit {digits.number(freeze_below)}. Freeze: {digits.listing(frozen) or 'nothing'}. "
            f"Keep: {digits.listing(name for name in names if name not in frozen) or 'nothing'}."
        ),
        numbers=(
            column("parameter", [names[k] for k in order]),
            column("decision", ["freeze" if names[k] in frozen else "keep" for k in order]),
            column("index", value[order]),
            column("lower end", low[order]),
            column("upper end", high[order]),
        ),
    )


def _start(value: np.ndarray, freeze_below: float) -> int:
    """Power of ten at which the scale begins: below the limit, and below most of the indices."""
    positive = [float(v) for v in (*value, freeze_below / 2.0) if v > 0.0]
    return int(np.clip(math.floor(math.log10(min(positive))), LOWEST, HIGHEST_START))
