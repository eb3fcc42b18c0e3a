"""Response curves: the surrogate along one parameter, the others in the middle."""

from __future__ import annotations

import numpy as np

from surrogate.fitting.fit import Fit
from surrogate.report import digits
from surrogate.report.drawing import (
    Panel,
    Scale,
    group,
    line,
    mark,
    path,
    shortened,
    span,
    text,
)
from surrogate.report.parity import mean_over_points, predictions
from surrogate.report.plot import Plot, column, plot
from surrogate.space.space import Parameter, Space

WIDTH, HEIGHT, POINTS = 250.0, 190.0, 41


def centre(space: Space) -> np.ndarray:
    """Coded middle of the space (parameter,); the level nearest to it when categorical."""
    return np.array([float(np.ravel(p.encode(p.decode([0.0])))[0]) for p in space.parameters])


def sweep(parameter: Parameter) -> np.ndarray:
    """Coded places along one parameter; the middle 98 % of an unbounded one."""
    if parameter.categorical:
        return parameter.coded_levels
    if parameter.allowed is not None and len(parameter.allowed) <= POINTS:
        return parameter.allowed
    reach = 1.0 if parameter.bounded else 0.98
    return np.linspace(-reach, reach, POINTS)


def slice_plots(fit: Fit, space: Space, unit: str, output: str) -> list[tuple[str, Plot]]:
    """(parameter, drawing) for each parameter, all with the same y scale.

    A field output is shown by its mean over its points.
    """
    curves = {p.name: _curve(fit, space, j) for j, p in enumerate(space.parameters)}
    y_span = span(
        *(
            mean + sign * np.nan_to_num(half)
            for mean, half in curves.values()
            for sign in (-1.0, 1.0)
        )
    )
    return [(p.name, _draw(p, *curves[p.name], y_span, unit, output)) for p in space.parameters]


def _curve(fit: Fit, space: Space, column: int) -> tuple[np.ndarray, np.ndarray]:
    places = sweep(space.parameters[column])
    coded = np.tile(centre(space), (len(places), 1))
    coded[:, column] = places
    mean, half = predictions(fit, coded)
    if mean.ndim > 1:
        return mean_over_points(mean), np.full(len(mean), np.nan)
    return mean, half


def _draw(
    parameter: Parameter,
    mean: np.ndarray,
    half: np.ndarray,
    y_span: tuple[float, float],
    unit: str,
    output: str,
) -> Plot:
    if parameter.categorical:
        return _draw_levels(parameter, mean, half, y_span, unit, output)
    physical = np.asarray(parameter.decode(sweep(parameter)), dtype=float)
    panel = Panel.within(span(physical, pad=0.0), y_span, width=WIDTH, height=HEIGHT)
    marks = []
    if np.isfinite(half).all():
        upper = list(zip(panel.x(physical), panel.y(mean + half), strict=True))
        lower = list(zip(panel.x(physical), panel.y(mean - half), strict=True))
        marks.append(path(upper + lower[::-1], "band", closed=True))
    marks.append(path(zip(panel.x(physical), panel.y(mean), strict=True), "curve"))
    frame = panel.frame(
        digits.labelled(parameter.name, parameter.unit),
        digits.labelled(shortened(output, 130), unit),
        x_count=4,
        y_count=4,
    )
    return plot(
        WIDTH,
        HEIGHT,
        frame,
        *marks,
        title=f"{output} along {parameter.name}",
        says=_ends(parameter, [digits.figure(v) for v in physical[[0, -1]]], mean[[0, -1]], unit),
        numbers=(
            column(digits.labelled(parameter.name, parameter.unit), physical),
            column(digits.labelled("predicted", unit), mean),
            column(digits.labelled("half-width of the 95 % interval", unit), half),
        ),
    )


def _ends(parameter: Parameter, places: list[str], values: np.ndarray, unit: str) -> str:
    """From where to where the curve goes."""
    start, end = (digits.with_unit(digits.figure(value), unit) for value in values)
    first, last = (digits.with_unit(place, parameter.unit) for place in places)
    return f"From {start} at {first} to {end} at {last}, the other parameters in the middle."


def _draw_levels(
    parameter: Parameter,
    mean: np.ndarray,
    half: np.ndarray,
    y_span: tuple[float, float],
    unit: str,
    output: str,
) -> Plot:
    panel = Panel.within((-0.5, len(mean) - 0.5), y_span, width=WIDTH, height=HEIGHT)
    marks, bottom = [], panel.y.start
    room = (panel.x.end - panel.x.start) / len(mean)
    for k, level in enumerate(parameter.levels):
        x, y = panel.x(k), panel.y(mean[k])
        if np.isfinite(half[k]):
            marks.append(line(x, panel.y(mean[k] - half[k]), x, panel.y(mean[k] + half[k]), "bar"))
        marks.append(
            mark(
                "filled",
                x,
                y,
                data_tip=(f"{level}\n{digits.with_unit(digits.with_half(mean[k], half[k]), unit)}"),
            )
        )
        marks.append(text(x, bottom + 14, shortened(level, room), "tick", "middle"))
    ticks = zip(panel.y.ticks(4), panel.y.tick_words(4), strict=True)
    frame = [
        group(
            line(panel.x.start, panel.y(v), panel.x.end, panel.y(v), "grid"),
            text(panel.x.start - 5, panel.y(v) + 4, words, "tick", "end"),
        )
        for v, words in ticks
    ]
    middle = Scale(0, 1, panel.x.start, panel.x.end)(0.5)
    return plot(
        WIDTH,
        HEIGHT,
        *frame,
        panel.baseline(),
        *marks,
        text(2, panel.y.end - 11, digits.labelled(shortened(output, 130), unit), "label"),
        text(middle, bottom + 31, digits.labelled(parameter.name, ""), "label", "middle"),
        title=f"{output} for each {parameter.name}",
        says="; ".join(
            f"{level}: {digits.with_unit(digits.figure(value), unit)}"
            for level, value in zip(parameter.levels, mean, strict=True)
        )
        + ".",
        numbers=(
            column(parameter.name, parameter.levels),
            column(digits.labelled("predicted", unit), mean),
            column(digits.labelled("half-width of the 95 % interval", unit), half),
        ),
    )
