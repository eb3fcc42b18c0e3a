"""Second-order Sobol' indices as a triangle of grey squares with their numbers."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from markupsafe import Markup

from surrogate.report import digits
from surrogate.report.drawing import WIDTH, group, label_room, shortened, tag, text
from surrogate.report.plot import Plot, column, plot

#: Up to this many parameters the squares have room for their numbers.
WRITTEN = 9
#: A largest index below this does not become black: small interactions look small.
PALEST_PEAK = 0.05


def interaction_map(
    names: Sequence[str], value: np.ndarray, low: np.ndarray, high: np.ndarray, output: str
) -> Plot:
    """Lower triangle of the pairs; value, low, high (parameter, parameter)."""
    count = len(names)
    left = label_room(names, 100.0)
    size = (WIDTH - left - 6) / max(count - 1, 1)
    height = min(size, 44.0)
    peak = float(np.nanmax(np.nan_to_num(value), initial=PALEST_PEAK))
    top, marks = 8.0, []
    for i in range(1, count):
        y = top + height * (i - 1)
        marks.append(
            text(left - 7, y + height / 2 + 4, shortened(names[i], left - 7), "name", "end")
        )
        for j in range(i):
            marks.append(
                _square(
                    left + size * j,
                    y,
                    size,
                    height,
                    count <= WRITTEN,
                    peak,
                    f"{names[j]} × {names[i]}",
                    (value[i, j], low[i, j], high[i, j]),
                )
            )
    floor = top + height * (count - 1)
    for j in range(count - 1):
        x = left + size * (j + 0.5)
        marks.append(
            tag(
                "text",
                shortened(names[j], 90.0),
                class_="name",
                text_anchor="end",
                transform=f"translate({x + 4:.1f} {floor + 10:.1f}) rotate(-55)",
            )
        )
    below = min(90.0, label_room(names[:-1], 100.0)) * 0.82 + 12
    pairs = [(i, j) for i in range(1, count) for j in range(i)]
    i, j = max(pairs, key=lambda pair: np.nan_to_num(value[pair], nan=-np.inf))
    return plot(
        WIDTH,
        floor + below,
        *marks,
        title=f"Second-order Sobol' indices of {output}",
        says=(
            f"{digits.quantity(len(pairs), 'pair')}. Largest: {names[j]} × {names[i]}, "
            f"{digits.with_interval(value[i, j], low[i, j], high[i, j])}."
        ),
        numbers=(
            column("parameter", [names[b] for _, b in pairs]),
            column("with", [names[a] for a, _ in pairs]),
            *(
                column(title, [part[pair] for pair in pairs])
                for title, part in (
                    ("second order", value),
                    ("lower end", low),
                    ("upper end", high),
                )
            ),
        ),
    )


def _square(
    x: float,
    y: float,
    width: float,
    height: float,
    written: bool,
    peak: float,
    pair: str,
    numbers: tuple[float, float, float],
) -> Markup:
    value, low, high = map(float, numbers)
    known = np.isfinite(value)
    # Darker by the share of the largest pair: paper shows it as well as a screen does.
    shade = max(0.0, value) / peak if known else 0.0
    parts = [
        tag(
            "rect",
            x=x + 1,
            y=y + 1,
            width=width - 2,
            height=height - 2,
            class_="cell",
            fill_opacity=f"{shade:.2f}",
        )
    ]
    if written:
        words = digits.fixed(value, 3) if known else digits.NOTHING
        parts.append(
            text(
                x + width / 2,
                y + height / 2 + 4,
                words,
                "tick over" if shade > 0.55 else "tick",
                "middle",
            )
        )
    return group(
        *parts, class_="hover", data_tip=f"{pair}\n{digits.with_interval(value, low, high)}"
    )
