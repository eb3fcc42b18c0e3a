"""Rows with names at the left and one scale below: the frame of bars, dots and intervals."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from markupsafe import Markup

from surrogate.report.drawing import (
    WIDTH,
    Scale,
    Ticks,
    group,
    label_room,
    line,
    shortened,
    tag,
    text,
)

#: Room above the rows, and of the scale with its label below them.
TOP, BELOW = 14.0, 40.0


@dataclass(frozen=True)
class Rows:
    """`count` rows of height `band`; x places values."""

    x: Scale
    band: float
    count: int

    @classmethod
    def of(
        cls,
        names: Sequence[str],
        numbers: Sequence[float],
        band: float,
        *,
        zero: bool = True,
        most: float = 120.0,
    ) -> Rows:
        """Rows for these names whose scale holds all the numbers, and zero if wanted.

        most is the room that names can take.
        """
        held = [*numbers, *([0.0] if zero or not numbers else [])]
        low, high = min(held), max(held)
        room = 0.04 * (high - low) or 0.05 * abs(high) or 1.0
        low = low if zero and low == 0.0 else low - room
        return cls(Scale(low, high + room, label_room(names, most), WIDTH - 14.0), band, len(names))

    @property
    def floor(self) -> float:
        """Lower end of the rows."""
        return TOP + self.band * self.count

    @property
    def height(self) -> float:
        """Height of the drawing, scale and label included."""
        return self.floor + BELOW

    def top(self, place: int) -> float:
        """Upper end of a row."""
        return TOP + self.band * place

    def middle(self, place: int) -> float:
        """Middle of a row."""
        return self.top(place) + self.band / 2.0

    def name(self, place: int, words: str) -> Markup:
        """A row's name."""
        left = self.x.start
        return text(left - 8, self.middle(place) + 4, shortened(words, left - 8), "name", "end")

    def frame(self, label: str) -> Markup:
        """Grid, scale, label, and the line of zero where the scale has one."""
        marks = [self.scale(label, self.x.labelled())]
        if self.x.low <= 0.0 <= self.x.high:
            marks.append(line(self.x(0.0), TOP - 4, self.x(0.0), self.floor, "axis"))
        return group(*marks)

    def scale(self, label: str, ticks: Ticks) -> Markup:
        """Grid and words at these ticks, and the label."""
        marks = [line(self.x(v), TOP, self.x(v), self.floor, "grid") for v, _ in ticks]
        marks += [text(self.x(v), self.floor + 14, words, "tick", "middle") for v, words in ticks]
        return group(*marks, self.label(label))

    def label(self, words: str) -> Markup:
        """What the scale is of, below it."""
        return text((self.x.start + self.x.end) / 2, self.floor + 31, words, "label", "middle")

    def threshold(self, value: float | None) -> Markup:
        """A dashed line through all rows; nothing when it lies off the scale."""
        if value is None or not self.x.low <= value <= self.x.high:
            return group()
        return line(self.x(value), TOP - 4, self.x(value), self.floor, "threshold")


def band_within(height: float, count: int, least: float, most: float) -> float:
    """Height of each of `count` rows that fill a drawing of this height, where limits allow it."""
    return float(np.clip((height - TOP - BELOW) / count, least, most))


def whisker(x: Scale, low: float, high: float, y: float, cap: float = 3.5) -> Markup:
    """An interval with its two ends."""
    left, right = (f"{float(x(end)):.1f}" for end in (max(low, x.low), min(high, x.high)))
    caps = "".join(f"M{end} {y - cap:.1f}V{y + cap:.1f}" for end in (left, right))
    return tag("path", d=f"{caps}M{left} {y:.1f}H{right}", class_="whisker")
