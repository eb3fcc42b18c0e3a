"""Q2 of the surrogates beside one another."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from markupsafe import Markup

from surrogate.report import digits
from surrogate.report.drawing import WIDTH, Scale, drawing, group, label_room, mark, text
from surrogate.report.figures.rows import Rows

ROW = 24.0
#: The scale begins at 0 at the lowest and at this at the highest.
HIGHEST_START = 0.9
#: Where the words for a cross-validated and a held-out Q2 off the scale begin.
OFF_SCALE = {"hollow": 4.0, "filled": 112.0}


def accuracy_plot(names: Sequence[str], q2_cv, q2_test, output: str) -> Markup:
    """A row a surrogate: cross-validated Q2 hollow, held-out Q2 filled, each (surrogate,).

    Values below 0 stand as words at the left end of the scale.
    """
    finite = [float(value) for value in (*q2_cv, *q2_test) if np.isfinite(value)]
    lowest = max(0.0, min(HIGHEST_START, min(finite, default=0.0) - 0.02))
    rows = Rows(Scale(lowest, 1.0, label_room(names, 120.0), WIDTH - 16.0), ROW, len(names))
    marks = [rows.frame("Q² (–), 1 is perfect")]
    for place, name in enumerate(names):
        marks.append(rows.name(place, name))
        marks.append(_score(rows, place, name, "hollow", "cross-validated", float(q2_cv[place])))
        marks.append(_score(rows, place, name, "filled", "held out", float(q2_test[place])))
    return drawing(WIDTH, rows.height, *marks, says=f"Q2 of {len(names)} surrogates for {output}")


def _score(rows: Rows, place: int, name: str, kind: str, how: str, value: float) -> Markup:
    if not np.isfinite(value):
        return group()
    if value < rows.x.low:
        return text(rows.x.start + OFF_SCALE[kind], rows.middle(place) + 4,
                    f"‹ {digits.figure(value)} ({how})", "small")
    return mark(kind, rows.x(value), rows.middle(place), 4.2,
                data_tip=f"{name}\nQ² {how}: {digits.score(value)}")
