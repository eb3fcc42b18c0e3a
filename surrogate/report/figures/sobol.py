"""Sensitivity indices as bars with their intervals, and what the intervals are made of."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from markupsafe import Markup

from surrogate.report import digits
from surrogate.report.drawing import WIDTH, Scale, group, line, mark, tag
from surrogate.report.figures.rows import Rows, band_within, whisker
from surrogate.report.plot import Column, Plot, column, plot

#: Height of one bar and of the room about a parameter's bars.
BAR, ROOM = 14.0, 11.0
#: Largest height of a bar.
THICK = 30.0
SHARE = "share of the variance (–)"


@dataclass(frozen=True)
class Bars:
    """One bar a parameter: values, and ends of intervals (NaN for none), each (parameter,).

    kind is the bar's class (`dark` or `light`), title what it is called.
    """

    kind: str
    title: str
    value: np.ndarray
    low: np.ndarray
    high: np.ndarray

    @property
    def finite(self) -> list[float]:
        """All its numbers that can be drawn."""
        joined = np.concatenate([self.value, self.low, self.high])
        return [float(number) for number in joined if np.isfinite(number)]


def index_bars(
    names: Sequence[str],
    series: Sequence[Bars],
    label: str,
    title: str,
    *,
    freeze_below: float | None = None,
    trusted: bool = True,
    height: float = 0.0,
) -> Plot:
    """The series' bars side by side for each parameter, sorted by the last series.

    Bars are thicker where that brings few of them nearer to a height of the drawing.
    """
    order = np.argsort(-np.nan_to_num(series[-1].value, nan=-np.inf), kind="stable")
    bars_in_row = len(series) + ROOM / BAR
    band = band_within(height, len(names), BAR * bars_in_row, THICK * bars_in_row)
    bar = band / bars_in_row
    rows = Rows.of(names, [number for bars in series for number in bars.finite], band)
    marks = [rows.frame(label)]
    for place, k in enumerate(order):
        marks.append(rows.name(place, names[k]))
        marks += [
            _bar(rows.x, rows.top(place) + bar * (ROOM / BAR / 2 + step), bars, k, names[k], bar)
            for step, bars in enumerate(series)
        ]
    marks.append(rows.threshold(freeze_below))
    return plot(
        WIDTH,
        rows.height,
        group(*marks, class_=None if trusted else "faded"),
        title=title,
        says=("" if trusted else "Not to be trusted. ") + _largest(names, series[-1], order),
        numbers=_numbers(names, series, order),
    )


def _largest(names: Sequence[str], bars: Bars, order: np.ndarray) -> str:
    """The three largest of a series, with their intervals."""
    told = [
        f"{names[k]} {digits.with_interval(bars.value[k], bars.low[k], bars.high[k])}"
        for k in order[:3]
    ]
    return f"{bars.title}, largest first: {'; '.join(told)}."


def _numbers(names: Sequence[str], series: Sequence[Bars], order: np.ndarray) -> tuple[Column, ...]:
    """Names and the series with the ends of their intervals, where they have some."""
    columns = [column("parameter", [names[k] for k in order])]
    for bars in series:
        columns.append(column(bars.title, bars.value[order]))
        if np.isfinite(bars.low).any():
            columns += [
                column(f"{bars.title}, {end} end", part[order])
                for end, part in (("lower", bars.low), ("upper", bars.high))
            ]
    return tuple(columns)


def _bar(x: Scale, y: float, bars: Bars, k: int, name: str, thick: float = BAR) -> Markup:
    value, low, high = float(bars.value[k]), float(bars.low[k]), float(bars.high[k])
    if not np.isfinite(value):
        return group()
    start, end = sorted((float(x(0.0)), float(x(value))))
    parts = [
        tag("rect", x=start, y=y, width=end - start, height=thick - 2, class_=f"bar-{bars.kind}")
    ]
    if np.isfinite(low) and np.isfinite(high):
        parts.append(whisker(x, low, high, y + thick / 2 - 1))
    return group(
        *parts,
        class_="hover",
        data_tip=f"{name}, {bars.title}\n{digits.with_interval(value, low, high)}",
    )


def part_bars(names: Sequence[str], total: Mapping[str, np.ndarray]) -> Plot:
    """Half-widths of the total index's interval: sampling (filled) and surrogate (outlined)."""
    nothing = np.full(len(names), np.nan)
    order = np.argsort(-np.nan_to_num(total["value"], nan=-np.inf), kind="stable")
    series = [
        Bars(kind, title, np.asarray(total[part])[order], nothing, nothing)
        for kind, title, part in (
            ("dark", "sampling ±", "sampling"),
            ("light", "surrogate ±", "surrogate"),
        )
    ]
    # A closed form has no sampling part: its bars would be room and nothing else.
    series = [bars for bars in series if (np.nan_to_num(bars.value) > 1e-9).any()] or series
    named = [names[k] for k in order]
    rows = Rows.of(
        named, [number for bars in series for number in bars.finite], BAR * len(series) + ROOM
    )
    marks = [rows.frame("half-width of the interval (–)")]
    for place, name in enumerate(named):
        marks.append(rows.name(place, name))
        marks += [
            _bar(rows.x, rows.top(place) + ROOM / 2 + BAR * step, bars, place, name)
            for step, bars in enumerate(series)
        ]
    widest = int(np.argmax(np.nan_to_num(np.max([bars.value for bars in series], axis=0))))
    told = [f"{bars.title} {digits.figure(float(bars.value[widest]), 2)}" for bars in series]
    return plot(
        WIDTH,
        rows.height,
        *marks,
        title="Parts of the intervals of the total indices",
        says=f"Largest for {named[widest]}: {', '.join(told)}.",
        numbers=_numbers(named, series, np.arange(len(named))),
    )


def share_plot(
    names: Sequence[str],
    shares: Sequence[float],
    total: Mapping[str, np.ndarray],
    freeze_below: float | None,
) -> Plot:
    """One-at-a-time share (square) beside the total index (disc with interval)."""
    order = np.argsort(-np.nan_to_num(np.asarray(shares, dtype=float), nan=-np.inf), kind="stable")
    numbers = [float(v) for v in (*shares, *total["value"], *total["high"]) if np.isfinite(v)]
    rows = Rows.of(names, numbers, 26.0)
    marks = [rows.frame("share (–)")]
    for place, k in enumerate(order):
        marks.append(rows.name(place, names[k]))
        marks.append(
            _pair(
                rows.x,
                rows.middle(place),
                names[k],
                shares[k],
                *(float(total[part][k]) for part in ("value", "low", "high")),
            )
        )
    marks.append(rows.threshold(freeze_below))
    return plot(
        WIDTH,
        rows.height,
        *marks,
        title="One-at-a-time shares and indices",
        says="; ".join(
            f"{names[k]}: share {digits.percent(shares[k])}, index "
            f"{digits.figure(float(total['value'][k]), 2)}"
            for k in order[:3]
        )
        + ".",
        numbers=(
            column("parameter", [names[k] for k in order]),
            column("one-at-a-time share", [shares[k] for k in order]),
            column("index", total["value"][order]),
            column("index, upper end", total["high"][order]),
        ),
    )


def _pair(
    x: Scale, y: float, name: str, share: float, value: float, low: float, high: float
) -> Markup:
    parts = []
    if np.isfinite(share) and np.isfinite(value):
        parts.append(line(x(share), y, x(value), y, "stem"))
    if np.isfinite(low) and np.isfinite(high):
        parts.append(whisker(x, low, high, y))
    if np.isfinite(value):
        parts.append(
            mark(
                "filled",
                x(value),
                y,
                4.0,
                data_tip=(f"{name}\ntotal index {digits.with_interval(value, low, high)}"),
            )
        )
    if np.isfinite(share):
        parts.append(
            mark(
                "square",
                x(share),
                y,
                4.0,
                data_tip=(f"{name}\none-at-a-time share {digits.percent(share)}"),
            )
        )
    return group(*parts)
