"""Where the runs lie: a pair plot of few parameters, one strip a parameter of many."""

from __future__ import annotations

import numpy as np
from markupsafe import Markup

from surrogate.report.digits import labelled, number, quantity
from surrogate.report.drawing import (
    WIDTH,
    Scale,
    group,
    label_room,
    line,
    mark,
    shortened,
    tag,
    text,
    width_of,
)
from surrogate.report.plot import Plot, column, plot
from surrogate.space.space import Parameter, Space

#: Up to this many parameters every pair has room for a panel.
PAIRS = 7
#: From this many runs on the marks of small panels are tiny.
MANY = 60
#: Size of the small type over that of the names.
SMALL = 9.0 / 11.0
#: Marks of the designs in their order; later designs use the last.
MARKS = ("filled", "hollow", "square", "diamond")


def mark_of(designs: list[str], design: str) -> str:
    """Mark of a design."""
    return MARKS[min(designs.index(design), len(MARKS) - 1)]


def points_plot(
    space: Space,
    coded: np.ndarray,
    numbers: np.ndarray,
    design: np.ndarray,
    designs: list[str],
    ok: np.ndarray,
) -> Plot:
    """The points of all designs in coded values; failed runs as crosses.

    coded (run, parameter), numbers (run,), design (run,) words, ok (run,).
    """
    kinds = [
        mark_of(designs, name) if fine else "cross" for name, fine in zip(design, ok, strict=True)
    ]
    if space.size == 1 or space.size > PAIRS:
        height, marks = _strips(space, coded, numbers, kinds)
    else:
        height, marks = _sorted_pairs(space, coded, numbers, design, designs, kinds)
    counts = ", ".join(f"{(design == name).sum()} of {name}" for name in designs)
    failed = int((~ok).sum())
    how = "by pairs of parameters" if 1 < space.size <= PAIRS else "a strip a parameter"
    return plot(
        WIDTH,
        height,
        marks,
        title="Design points",
        says=f"{quantity(len(numbers), 'point')} ({counts}; {failed or 'none'} failed), {how}.",
        numbers=(
            column("run", numbers),
            column("design", design),
            *(
                column(f"{name} (coded)", values)
                for name, values in zip(space.names, coded.T, strict=True)
            ),
        ),
    )


#: Height and marks of a drawing.
Drawn = tuple[float, Markup]


def _sorted_pairs(
    space: Space,
    coded: np.ndarray,
    numbers: np.ndarray,
    design: np.ndarray,
    designs: list[str],
    kinds: list[str],
) -> Drawn:
    # The first design on top, for later ones often hold its points too; failed runs above all.
    order = sorted(
        range(len(kinds)), key=lambda k: (kinds[k] == "cross", -designs.index(str(design[k])))
    )
    return _pairs(space, coded[order], numbers[order], [kinds[k] for k in order])


def _pairs(space: Space, coded: np.ndarray, numbers: np.ndarray, kinds: list[str]) -> Drawn:
    """Lower triangle of panels; columns share an x parameter, rows a y parameter."""
    count = space.size
    left = label_room(space.names, 84.0)
    size = (WIDTH - left - 4) / (count - 1)
    marks = []
    for i in range(1, count):
        for j in range(i):
            marks.append(
                _pair(
                    Scale(-1.12, 1.12, left + size * j + 2, left + size * (j + 1) - 2),
                    Scale(-1.12, 1.12, size * i - 2, size * (i - 1) + 2),
                    coded[:, [j, i]],
                    numbers,
                    kinds,
                )
            )
        marks.append(
            text(left - 6, size * (i - 0.5) + 4, shortened(space.names[i], left - 6), "name", "end")
        )
    floor = size * (count - 1)
    steep = any(width_of(name) > size for name in space.names[:-1])
    for j in range(count - 1):
        marks.append(_below(space.names[j], left + size * (j + 0.5), floor, steep))
    below = min(90.0, label_room(space.names[:-1])) * 0.82 + 12 if steep else 22.0
    return floor + below, group(*marks)


def _below(name: str, x: float, floor: float, steep: bool) -> Markup:
    if not steep:
        return text(x, floor + 15, name, "name", "middle")
    return tag(
        "text",
        shortened(name, 90.0),
        class_="name",
        text_anchor="end",
        transform=f"translate({x + 4:.1f} {floor + 10:.1f}) rotate(-55)",
    )


def _pair(x: Scale, y: Scale, coded: np.ndarray, numbers: np.ndarray, kinds: list[str]) -> Markup:
    box = tag(
        "rect", x=x.start, y=y.end, width=x.end - x.start, height=y.start - y.end, class_="box"
    )
    size = 2.6 if x.end - x.start > 70 else 1.9 if len(kinds) < MANY else 1.4
    return group(
        box,
        *(
            _point(x, y, point, number, kind, size)
            for point, number, kind in zip(coded, numbers, kinds, strict=True)
        ),
        class_="tiny" if size < 1.9 else None,
    )


def _point(x: Scale, y: Scale, point: np.ndarray, number: object, kind: str, size: float) -> Markup:
    return mark(kind, x(point[0]), y(point[1]), size, data_run=number)


def _strips(space: Space, coded: np.ndarray, numbers: np.ndarray, kinds: list[str]) -> Drawn:
    """One line a parameter from its lowest to its highest value, a mark a run.

    Runs stand a little above one another by their number, so that a design of two
    levels does not fall on two points.
    """
    ends = max(width_of(_ends(parameter)) for parameter in space.parameters)
    left, row, top = max(label_room(space.names, 110.0), min(120.0, SMALL * ends + 4)), 34.0, 6.0
    marks = []
    lift = np.linspace(-9.0, 9.0, max(len(numbers), 2))
    for j, parameter in enumerate(space.parameters):
        y = top + row * (j + 0.5)
        x = Scale(-1.0, 1.0, left + 8, WIDTH - 12)
        marks.append(line(left + 8, y, WIDTH - 12, y, "grid"))
        marks.append(text(left - 2, y + 1, shortened(parameter.name, left - 4), "name", "end"))
        marks.append(text(left - 2, y + 12, _ends(parameter), "small", "end"))
        marks += [
            mark(kind, x(value), y + lift[k], 1.9, data_run=numbers[k])
            for k, (value, kind) in enumerate(zip(coded[:, j], kinds, strict=True))
        ]
    return top + row * space.size + 4, group(*marks)


def _ends(parameter: Parameter) -> str:
    if parameter.distribution is None:
        return f"{len(parameter.levels)} levels"
    lower, upper = parameter.distribution.support
    return labelled(f"{number(lower, 3)} to {number(upper, 3)}", parameter.unit)
