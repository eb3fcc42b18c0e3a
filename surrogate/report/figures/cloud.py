"""A cloud that is not a box: pairs of correlated inputs, and the corners without runs."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product

import numpy as np
from markupsafe import Markup
from numpy.typing import NDArray

from surrogate.report.drawing import Scale, group, mark, shortened, tag, text
from surrogate.report.plot import Plot, column, plot
from surrogate.space.space import Space

#: Size of a panel, and of the room for names below it and beside it.
SIZE, ROOM = 200.0, 22.0
#: A corner reaches from this coded value to the end of both ranges.
CORNER = 0.5


def cloud_plot(
    space: Space,
    coded: NDArray[np.float64],
    numbers: NDArray[np.int_],
    pair: tuple[str, str],
) -> Plot:
    """Coded points (run, parameter) of two inputs; corners that no run reaches are shaded."""
    j, i = (space.names.index(name) for name in pair)
    x = Scale(-1.05, 1.05, ROOM, ROOM + SIZE)
    y = Scale(-1.05, 1.05, SIZE, 0.0)
    box = tag("rect", x=x.start, y=y.end, width=SIZE, height=SIZE, class_="box")
    points = coded[:, [j, i]]
    marks = [
        mark("filled", x(point[0]), y(point[1]), 2.6, data_run=number)
        for point, number in zip(points, numbers, strict=True)
    ]
    middle = ROOM + SIZE / 2
    upright = f"translate(14 {SIZE / 2:.0f}) rotate(-90)"
    empty = len(empty_corners(points))
    return plot(
        ROOM + SIZE + 4,
        SIZE + ROOM,
        group(*(_shaded(x, y, *signs) for signs in empty_corners(points)), box, *marks),
        text(middle, SIZE + 16, shortened(pair[0], SIZE), "name", "middle"),
        tag(
            "text", shortened(pair[1], SIZE), class_="name", text_anchor="middle", transform=upright
        ),
        title=f"Runs by {pair[0]} and {pair[1]}",
        says=(
            f"{len(points)} runs by {pair[0]} and {pair[1]}, from smallest to largest. "
            f"{empty or 'None'} of the four corners {'has' if empty == 1 else 'have'} no run."
        ),
        numbers=(
            column("run", numbers),
            column(f"{pair[0]} (coded)", points[:, 0]),
            column(f"{pair[1]} (coded)", points[:, 1]),
        ),
    )


def empty_corners(points: NDArray[np.float64]) -> Sequence[tuple[int, int]]:
    """Signs of the corners of the square that none of the points (run, 2) lies in."""
    return [
        signs
        for signs in product((-1, 1), (-1, 1))
        if not (points * signs > CORNER).all(axis=1).any()
    ]


def _shaded(x: Scale, y: Scale, right: int, up: int) -> Markup:
    ends_x = sorted((x(right * CORNER), x(right)))
    ends_y = sorted((y(up * CORNER), y(up)))
    return tag(
        "rect",
        x=ends_x[0],
        y=ends_y[0],
        width=ends_x[1] - ends_x[0],
        height=ends_y[1] - ends_y[0],
        class_="band",
    )
