"""Q2 of the surrogates beside one another."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from markupsafe import Markup

from surrogate.report import digits
from surrogate.report.drawing import WIDTH, Scale, label_room, mark, text
from surrogate.report.figures.rows import Rows
from surrogate.report.plot import Plot, column, plot

ROW = 24.0
TITLES = {"hollow": "cross-validated", "filled": "held-out"}
#: The scale begins at 0 at the lowest and at this at the highest.
HIGHEST_START = 0.9
#: Room of the sign and the number of a Q2 off the scale, and of a disc on it.
OFF_SCALE, DISC = 54.0, 10.0


def accuracy_plot(
    names: Sequence[str], q2_cv: Sequence[float], q2_test: Sequence[float], output: str
) -> Plot:
    """A row a surrogate: cross-validated Q2 hollow, held-out Q2 filled, each (surrogate,).

    Values below 0 stand as numbers at the left end of the scale, beside a disc of their kind.
    """
    finite = [float(value) for value in (*q2_cv, *q2_test) if np.isfinite(value)]
    lowest = max(0.0, min(HIGHEST_START, min(finite, default=0.0) - 0.02))
    rows = Rows(Scale(lowest, 1.0, label_room(names, 120.0), WIDTH - 16.0), ROW, len(names))
    marks = [rows.frame("Q² (–), 1 is perfect")]
    for place, name in enumerate(names):
        marks.append(rows.name(place, name))
        marks += _scores(
            rows, place, name, {"hollow": float(q2_cv[place]), "filled": float(q2_test[place])}
        )
    return plot(
        WIDTH,
        rows.height,
        *marks,
        title=f"Q² of the surrogates of {output}",
        says=_says(names, q2_cv, q2_test),
        numbers=(
            column("surrogate", names),
            column("Q² (cross-validated)", q2_cv),
            column("Q² (held-out)", q2_test),
        ),
    )


def _says(names: Sequence[str], q2_cv: Sequence[float], q2_test: Sequence[float]) -> str:
    told = [
        f"{name}: {' and '.join(said)}"
        for name, cv, test in zip(names, q2_cv, q2_test, strict=True)
        if (
            said := [
                f"{digits.score(value)} {how}"
                for how, value in (("cross-validated", cv), ("on held-out runs", test))
                if np.isfinite(value)
            ]
        )
    ]
    return f"Q² of {digits.quantity(len(names), 'surrogate')}. {'; '.join(told)}."


def _scores(rows: Rows, place: int, name: str, scores: dict[str, float]) -> list[Markup]:
    """Discs on the scale; what lies below it in a row from its left end, clear of the discs."""
    y, at = rows.middle(place), rows.x.start + 4.0
    on = {kind: value for kind, value in scores.items() if value >= rows.x.low}
    off = {kind: value for kind, value in scores.items() if value < rows.x.low}
    marks = [
        mark(
            kind,
            rows.x(value),
            y,
            4.2,
            data_tip=f"{name}\nQ² {TITLES[kind]}: {digits.score(value)}",
        )
        for kind, value in on.items()
    ]
    for kind, value in off.items():
        for disc in map(rows.x, on.values()):
            if at - DISC < disc < at + OFF_SCALE:
                at = float(disc) + DISC
        tip = f"{name}\nQ² {TITLES[kind]}: {digits.score(value)}"
        marks += [
            text(at, y + 4, "‹", "small"),
            mark(kind, at + 10.0, y, 3.0, data_tip=tip),
            text(at + 16.0, y + 4, digits.figure(value), "small"),
        ]
        at += OFF_SCALE
    return marks
