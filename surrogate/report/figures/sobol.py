"""Sobol' indices as bars: first order and total side by side, with their intervals."""

from __future__ import annotations

import numpy as np
from markupsafe import Markup

from surrogate.report import digits
from surrogate.report.drawing import (
    WIDTH,
    Scale,
    drawing,
    group,
    label_room,
    line,
    mark,
    shortened,
    tag,
    text,
)

BAND = 40.0


def sobol_bars(names, first: dict, total: dict, *, freeze_below: float | None = None,
               trusted: bool = True, output: str = "") -> Markup:
    """Two bars a parameter, largest total on top.

    first and total hold `value`, `low`, `high`, `sampling` and `surrogate`, each
    (parameter,): the thin whisker is the whole interval, the upper thick stroke the
    sampling half-width, the lower one the surrogate's.
    """
    order = np.argsort(-np.nan_to_num(total["value"], nan=-1.0))
    left = label_room(names, 110.0)
    highest = np.nanmax([1.0, *_finite(total["high"]), *_finite(total["value"])])
    lowest = min(0.0, *_finite(first["low"]), *_finite(total["low"]), 0.0)
    x = Scale(float(lowest), float(highest), left, WIDTH - 14)
    top, floor = 14.0, 14.0 + BAND * len(names)
    marks = [line(x(v), top, x(v), floor, "grid") for v in x.ticks(5)]
    marks += [text(x(v), floor + 14, words, "tick", "middle")
              for v, words in zip(x.ticks(5), x.tick_words(5), strict=True)]
    for place, k in enumerate(order):
        y = top + BAND * place
        marks.append(text(left - 8, y + BAND / 2 + 4, shortened(names[k], left - 8), "name", "end"))
        marks.append(_bar(x, y + 6, "first", names[k], "first order", first, k))
        marks.append(_bar(x, y + 21, "total", names[k], "total", total, k))
    marks.append(line(x(0.0), top - 4, x(0.0), floor, "axis"))
    if freeze_below is not None:
        marks.append(line(x(freeze_below), top - 4, x(freeze_below), floor, "threshold"))
    marks.append(text((left + WIDTH) / 2, floor + 31, "share of the variance (–)", "label",
                      "middle"))
    return drawing(WIDTH, floor + 40, group(*marks, class_=None if trusted else "faded"),
                   says=f"First-order and total Sobol' indices for {output}")


def _finite(values) -> list[float]:
    return [float(v) for v in np.ravel(values) if np.isfinite(v)]


def _bar(x: Scale, y: float, kind: str, name: str, title: str, values: dict, k: int) -> Markup:
    value, low, high = (float(values[key][k]) for key in ("value", "low", "high"))
    if not np.isfinite(value):
        return group()
    start, end = sorted((float(x(0.0)), float(x(value))))
    parts = [tag("rect", x=start, y=y, width=end - start, height=13.0, class_=f"bar-{kind}")]
    if np.isfinite(low) and np.isfinite(high):
        parts.append(line(x(low), y + 6.5, x(high), y + 6.5, "whisker"))
    for key, shift in (("sampling", 3.0), ("surrogate", 10.0)):
        half = float(values[key][k])
        if np.isfinite(half) and half > 0.0:
            parts.append(line(x(max(x.low, value - half)), y + shift, x(min(x.high, value + half)),
                              y + shift, f"part-{key}"))
    tip = (f"{name}, {title}\n{digits.with_interval(value, low, high)}\n"
           f"sampling ± {digits.figure(values['sampling'][k], 2)}, "
           f"surrogate ± {digits.figure(values['surrogate'][k], 2)}")
    return group(*parts, data_tip=tip, class_="hover")


def share_plot(names, one_at_a_time, total: dict, freeze_below: float | None) -> Markup:
    """One-at-a-time share (square) beside the total index (disc with interval)."""
    order = np.argsort(-np.nan_to_num(np.asarray(one_at_a_time, dtype=float), nan=-1.0))
    left = label_room(names, 110.0)
    highest = max([1.0, *_finite(total["high"])])
    x = Scale(0.0, highest, left, WIDTH - 14)
    row, top = 26.0, 14.0
    floor = top + row * len(names)
    marks = [line(x(v), top, x(v), floor, "grid") for v in x.ticks(5)]
    marks += [text(x(v), floor + 14, words, "tick", "middle")
              for v, words in zip(x.ticks(5), x.tick_words(5), strict=True)]
    for place, k in enumerate(order):
        y = top + row * (place + 0.5)
        marks.append(text(left - 8, y + 4, shortened(names[k], left - 8), "name", "end"))
        if np.isfinite(one_at_a_time[k]) and np.isfinite(total["value"][k]):
            marks.append(line(x(one_at_a_time[k]), y, x(total["value"][k]), y, "stem"))
        if np.isfinite(total["low"][k]):
            marks.append(line(x(max(0.0, total["low"][k])), y, x(total["high"][k]), y, "whisker"))
        if np.isfinite(total["value"][k]):
            marks.append(mark("filled", x(total["value"][k]), y, 4.0, data_tip=(
                f"{names[k]}\ntotal index " + digits.with_interval(
                    total["value"][k], total["low"][k], total["high"][k]))))
        if np.isfinite(one_at_a_time[k]):
            marks.append(mark("square", x(one_at_a_time[k]), y, 4.0, data_tip=(
                f"{names[k]}\none-at-a-time share {digits.percent(one_at_a_time[k])}")))
    if freeze_below is not None:
        marks.append(line(x(freeze_below), top - 4, x(freeze_below), floor, "threshold"))
    marks.append(text((left + WIDTH) / 2, floor + 31, "share (–)", "label", "middle"))
    return drawing(WIDTH, floor + 40, *marks,
                   says="One-at-a-time shares beside total Sobol' indices")
