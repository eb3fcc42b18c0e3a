"""Inputs that reach a goal: where the candidates lie in the range of each free input."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from surrogate.report import digits
from surrogate.report.drawing import WIDTH, Scale, group, label_room, line, mark, shortened, text
from surrogate.report.figures.rows import Rows, band_within
from surrogate.report.plot import Plot, column, plot
from surrogate.solving.solution import Candidate, chance
from surrogate.space.space import Space

#: Least and largest height of a row.
ROW, HIGHEST_ROW = 30.0, 85.0
#: Room of the best candidate's value at the right.
VALUE = 84.0


def candidates_plot(
    space: Space, candidates: Sequence[Candidate], title: str, *, height: float = 0.0
) -> Plot:
    """A row a free input from its smallest to its largest value: the best candidate is filled."""
    names = list(candidates[0].inputs)
    row = band_within(height, len(names), ROW, HIGHEST_ROW)
    rows = Rows(Scale(-1.0, 1.0, label_room(names, 104.0) + 4, WIDTH - VALUE), row, len(names))
    marks = []
    for place, name in enumerate(names):
        y = rows.middle(place)
        marks += [line(rows.x.start, y, rows.x.end, y, "grid"), rows.name(place, name)]
        coded = _coded(space, name, [one.inputs[name] for one in candidates])
        for k in reversed(range(len(candidates))):
            tip = f"candidate {k + 1}: {name} {_printed(space, name, candidates[k])}\n"
            tip += f"probability {chance(candidates[k].probability)}"
            kind, size = ("filled", 4.6) if k == 0 else ("hollow", 3.2)
            marks.append(mark(kind, rows.x(float(coded[k])), y, size, data_tip=tip))
        best = shortened(_printed(space, name, candidates[0]), VALUE - 10)
        marks.append(text(rows.x.end + 10, y + 4, best, "strong"))
    for end, words, at in (("start", "smallest", -1.0), ("end", "largest", 1.0)):
        marks.append(text(rows.x(at), rows.floor + 14, words, "tick", end))
    marks.append(rows.label("value of the input"))
    told = [f"{name} {_printed(space, name, candidates[0])}" for name in names]
    return plot(
        WIDTH,
        rows.height,
        group(*marks),
        title=title,
        says=(
            f"{digits.quantity(len(candidates), 'candidate')}. The best meets the goal with "
            f"{chance(candidates[0].probability)}: {', '.join(told)}."
        ),
        numbers=(
            column("candidate", np.arange(1, len(candidates) + 1)),
            *(
                column(
                    digits.labelled(name, space[name].unit),
                    [one.inputs[name] for one in candidates],
                )
                for name in names
            ),
            column("probability", [one.probability for one in candidates]),
        ),
    )


def _coded(space: Space, name: str, values: Sequence[float | str]) -> np.ndarray:
    return np.ravel(np.asarray(space[name].encode(np.array(values)), dtype=float))


def _printed(space: Space, name: str, candidate: Candidate) -> str:
    return digits.setting(candidate.inputs[name], space[name].unit)
