"""Sensitivity indices as bars with their intervals, and what the intervals are made of."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

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
    path,
    shortened,
    tag,
    text,
)

#: Height of one bar and of the room about a parameter's bars.
BAR, ROOM = 14.0, 11.0
TOP = 14.0
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


def index_bars(names: Sequence[str], series: Sequence[Bars], label: str, says: str, *,
               freeze_below: float | None = None, trusted: bool = True) -> Markup:
    """The series' bars side by side for each parameter, sorted by the last series."""
    order = np.argsort(-np.nan_to_num(series[-1].value, nan=-np.inf), kind="stable")
    band = BAR * len(series) + ROOM
    rows = _Rows.of(names, [number for bars in series for number in bars.finite], band, len(names))
    marks = [rows.frame(label)]
    for place, k in enumerate(order):
        marks.append(rows.name(place, names[k]))
        marks += [_bar(rows.x, rows.top(place) + ROOM / 2 + BAR * step, bars, k, names[k])
                  for step, bars in enumerate(series)]
    marks.append(rows.threshold(freeze_below))
    return drawing(WIDTH, rows.floor + 40, group(*marks, class_=None if trusted else "faded"),
                   says=says)


def _bar(x: Scale, y: float, bars: Bars, k: int, name: str) -> Markup:
    value, low, high = float(bars.value[k]), float(bars.low[k]), float(bars.high[k])
    if not np.isfinite(value):
        return group()
    start, end = sorted((float(x(0.0)), float(x(value))))
    parts = [tag("rect", x=start, y=y, width=end - start, height=BAR - 2,
                 class_=f"bar-{bars.kind}")]
    if np.isfinite(low) and np.isfinite(high):
        parts.append(whisker(x, low, high, y + BAR / 2 - 1))
    return group(*parts, class_="hover",
                 data_tip=f"{name}, {bars.title}\n{digits.with_interval(value, low, high)}")


def whisker(x: Scale, low: float, high: float, y: float, cap: float = 3.5) -> Markup:
    """An interval with its two ends."""
    left, right = float(x(max(low, x.low))), float(x(min(high, x.high)))
    return group(path([(left, y - cap), (left, y + cap)], "whisker"),
                 line(left, y, right, y, "whisker"),
                 path([(right, y - cap), (right, y + cap)], "whisker"))


def part_bars(names: Sequence[str], total: Mapping[str, np.ndarray]) -> Markup:
    """Half-widths of the total index's interval: sampling (dark) and surrogate (light)."""
    nothing = np.full(len(names), np.nan)
    order = np.argsort(-np.nan_to_num(total["value"], nan=-np.inf), kind="stable")
    series = [Bars(kind, title, np.asarray(total[part])[order], nothing, nothing)
              for kind, title, part in (("dark", "sampling ±", "sampling"),
                                        ("light", "surrogate ±", "surrogate"))]
    named = [names[k] for k in order]
    rows = _Rows.of(named, [number for bars in series for number in bars.finite],
                    BAR * 2 + ROOM, len(named))
    marks = [rows.frame("half-width of the interval (–)")]
    for place, name in enumerate(named):
        marks.append(rows.name(place, name))
        marks += [_bar(rows.x, rows.top(place) + ROOM / 2 + BAR * step, bars, place, name)
                  for step, bars in enumerate(series)]
    return drawing(WIDTH, rows.floor + 40, *marks,
                   says="Sampling and surrogate parts of the intervals of the total indices")


def share_plot(names: Sequence[str], shares, total: Mapping[str, np.ndarray],
               freeze_below: float | None) -> Markup:
    """One-at-a-time share (square) beside the total index (disc with interval)."""
    shares = np.asarray(shares, dtype=float)
    order = np.argsort(-np.nan_to_num(shares, nan=-np.inf), kind="stable")
    numbers = [float(v) for v in (*shares, *total["value"], *total["high"]) if np.isfinite(v)]
    rows = _Rows.of(names, numbers, 26.0, len(names))
    marks = [rows.frame("share (–)")]
    for place, k in enumerate(order):
        marks.append(rows.name(place, names[k]))
        marks.append(_pair(rows.x, rows.top(place) + 13.0, names[k], shares[k],
                           *(float(total[part][k]) for part in ("value", "low", "high"))))
    marks.append(rows.threshold(freeze_below))
    return drawing(WIDTH, rows.floor + 40, *marks,
                   says="One-at-a-time shares beside total Sobol' indices")


def _pair(x: Scale, y: float, name: str, share: float, value: float, low: float,
          high: float) -> Markup:
    parts = []
    if np.isfinite(share) and np.isfinite(value):
        parts.append(line(x(share), y, x(value), y, "stem"))
    if np.isfinite(low) and np.isfinite(high):
        parts.append(whisker(x, low, high, y))
    if np.isfinite(value):
        parts.append(mark("filled", x(value), y, 4.0, data_tip=(
            f"{name}\ntotal index {digits.with_interval(value, low, high)}")))
    if np.isfinite(share):
        parts.append(mark("square", x(share), y, 4.0, data_tip=(
            f"{name}\none-at-a-time share {digits.percent(share)}")))
    return group(*parts)


@dataclass(frozen=True)
class _Rows:
    """Rows of one height with names at the left and one scale below."""

    x: Scale
    band: float
    count: int

    @classmethod
    def of(cls, names: Sequence[str], numbers: Sequence[float], band: float, count: int) -> _Rows:
        """Rows whose scale holds zero and all the numbers."""
        low, high = min([0.0, *numbers]), max([0.0, *numbers])
        room = 0.04 * (high - low) or 1.0
        return cls(Scale(low - room * (low < 0.0), high + room, label_room(names, 110.0),
                         WIDTH - 14.0), band, count)

    @property
    def floor(self) -> float:
        return TOP + self.band * self.count

    def top(self, place: int) -> float:
        return TOP + self.band * place

    def name(self, place: int, words: str) -> Markup:
        left = self.x.start
        return text(left - 8, self.top(place) + self.band / 2 + 4, shortened(words, left - 8),
                    "name", "end")

    def frame(self, label: str) -> Markup:
        marks = [line(self.x(v), TOP, self.x(v), self.floor, "grid") for v in self.x.ticks()]
        marks += [text(self.x(v), self.floor + 14, words, "tick", "middle")
                  for v, words in zip(self.x.ticks(), self.x.tick_words(), strict=True)]
        zero = line(self.x(0.0), TOP - 4, self.x(0.0), self.floor, "axis")
        return group(*marks, zero, text((self.x.start + self.x.end) / 2, self.floor + 31, label,
                                        "label", "middle"))

    def threshold(self, value: float | None) -> Markup:
        if value is None or not self.x.low <= value <= self.x.high:
            return group()
        return line(self.x(value), TOP - 4, self.x(value), self.floor, "threshold")
