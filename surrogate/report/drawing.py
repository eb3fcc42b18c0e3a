"""Small vector drawings: scales, axes and marks as SVG text inside the page.

The drawings are about 360 units wide, the width of a phone, so that their letters
keep the size of the page's; a wide screen shows several side by side. Colours and
line styles sit in style.css, by class. A mark with `data_tip` or `data_run` shows
more when it is pointed at; nothing is said there that the page does not say elsewhere.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import overload

import numpy as np
from markupsafe import Markup, escape
from numpy.typing import ArrayLike

from surrogate.report.digits import fixed

WIDTH = 360.0
#: Values on a scale with the words that stand there.
Ticks = Sequence[tuple[float, str]]
LETTER, NARROW, WIDE = 6.8, 3.9, 10.0  # widths of letters in the drawings' 11-unit type


def tag(name: str, *children: object, **attributes: object) -> Markup:
    """An element; underscores in attribute names become hyphens, text is escaped."""
    words = "".join(
        f' {key.rstrip("_").replace("_", "-")}="{escape(_short(value))}"'
        for key, value in attributes.items()
        if value is not None
    )
    inner = Markup("").join(escape(child) for child in children)
    return Markup(f"<{name}{words}>{inner}</{name}>") if inner else Markup(f"<{name}{words}/>")


def _short(value: object) -> str:
    """Coordinates to a tenth of a unit: finer cannot be seen and makes the page heavy."""
    if isinstance(value, (float, np.floating)):
        return f"{value:.1f}".removesuffix(".0")
    return str(value)


def group(*children: object, **attributes: object) -> Markup:
    """A `<g>` of other marks."""
    return tag("g", *children, **attributes)


def text(x: float, y: float, words: object, class_: str = "", anchor: str | None = None) -> Markup:
    """Words at a point."""
    return tag("text", words, x=float(x), y=float(y), class_=class_ or None, text_anchor=anchor)


def line(x1: float, y1: float, x2: float, y2: float, class_: str) -> Markup:
    """A straight line."""
    return tag("line", x1=float(x1), y1=float(y1), x2=float(x2), y2=float(y2), class_=class_)


def path(points: Iterable[tuple[float, float]], class_: str, closed: bool = False) -> Markup:
    """A line through points, or the area inside them."""
    words = "L".join(f"{_short(float(x))} {_short(float(y))}" for x, y in points)
    return tag("path", d=f"M{words}{'Z' if closed else ''}", class_=class_)


def mark(kind: str, x: float, y: float, size: float = 3.4, **attributes: object) -> Markup:
    """A symbol: `filled`, `hollow` (discs), `square`, `diamond` or `cross`."""
    x, y = float(x), float(y)
    if kind in ("filled", "hollow"):
        return tag("circle", cx=x, cy=y, r=size, class_=f"mark {kind}", **attributes)
    corners = {
        "square": "M{l} {t}H{r}V{b}H{l}Z",
        "diamond": "M{x} {t}L{r} {y}L{x} {b}L{l} {y}Z",
        "cross": "M{l} {t}L{r} {b}M{l} {b}L{r} {t}",
    }[kind]
    places = {"x": x, "y": y, "l": x - size, "r": x + size, "t": y - size, "b": y + size}
    d = corners.format(**{key: _short(value) for key, value in places.items()})
    return tag("path", d=d, class_=f"mark {kind}", **attributes)


@dataclass(frozen=True)
class Scale:
    """Values from `low` to `high` placed on the drawing from `start` to `end`."""

    low: float
    high: float
    start: float
    end: float

    @overload
    def __call__(self, value: float) -> float: ...

    @overload
    def __call__(self, value: np.ndarray | Sequence[float]) -> np.ndarray: ...

    def __call__(self, value: float | np.ndarray | Sequence[float]) -> float | np.ndarray:
        """Place of a value, or of an array of them."""
        share = (np.asarray(value, dtype=float) - self.low) / (self.high - self.low)
        return self.start + share * (self.end - self.start)

    def ticks(self, count: int = 5) -> np.ndarray:
        """About `count` round values inside the scale."""
        step = _round_step((self.high - self.low) / max(count, 1))
        first = math.ceil(self.low / step - 1e-9)
        last = math.floor(self.high / step + 1e-9)
        return step * np.arange(first, last + 1)

    def tick_words(self, count: int = 5) -> list[str]:
        """The ticks as printed, all with the same decimals."""
        ticks = self.ticks(count)
        step = _round_step((self.high - self.low) / max(count, 1))
        if np.abs(ticks).max(initial=0.0) >= 1e5 or step < 1e-4:
            return [f"{tick:.4g}".replace("-", "\N{MINUS SIGN}") for tick in ticks]
        decimals = max(0, -math.floor(math.log10(step) + 1e-9))
        if not math.isclose(step * 10**decimals, round(step * 10**decimals)):
            decimals += 1
        return [fixed(tick, decimals) for tick in ticks]

    def labelled(self, count: int = 5) -> Ticks:
        """The ticks with what is printed there."""
        return list(zip(self.ticks(count).tolist(), self.tick_words(count), strict=True))


def _round_step(step: float) -> float:
    """The nearest of 1, 2, 2.5, 5 times a power of ten that is not below `step`."""
    power = 10.0 ** math.floor(math.log10(step))
    return next(factor * power for factor in (1, 2, 2.5, 5, 10) if factor * power >= step * 0.999)


def span(
    *values: ArrayLike, pad: float = 0.05, include: Iterable[float] = ()
) -> tuple[float, float]:
    """Lowest and highest finite value with a little room; a unit around a single value."""
    joined = np.concatenate([np.ravel(np.asarray(v, dtype=float)) for v in (*values, [*include])])
    joined = joined[np.isfinite(joined)]
    if joined.size == 0:
        return 0.0, 1.0
    low, high = float(joined.min()), float(joined.max())
    if high - low <= 1e-12 * max(abs(low), abs(high), 1e-300):
        room = 0.1 * abs(low) or 0.5
        return low - room, high + room
    return low - pad * (high - low), high + pad * (high - low)


@dataclass(frozen=True)
class Panel:
    """A rectangle with an x and a y scale."""

    x: Scale
    y: Scale

    @classmethod
    def within(
        cls,
        x_span: tuple[float, float],
        y_span: tuple[float, float],
        *,
        left: float = 46.0,
        right: float = 12.0,
        top: float = 26.0,
        bottom: float = 38.0,
        width: float = WIDTH,
        height: float = 300.0,
    ) -> Panel:
        """The panel of a drawing with these margins."""
        return cls(Scale(*x_span, left, width - right), Scale(*y_span, height - bottom, top))

    def frame(
        self,
        x_label: str,
        y_label: str,
        *,
        x_count: int = 5,
        y_count: int = 5,
        x_ticks: Ticks | None = None,
        y_ticks: Ticks | None = None,
    ) -> Markup:
        """Light grid, tick words and labels; the y label stands above its axis.

        Ticks that are not given are about so many round values.
        """
        left, right, floor, top = self.x.start, self.x.end, self.y.start, self.y.end
        across = self.x.labelled(x_count) if x_ticks is None else x_ticks
        up = self.y.labelled(y_count) if y_ticks is None else y_ticks
        marks = [line(left, self.y(v), right, self.y(v), "grid") for v, _ in up]
        marks += [line(self.x(v), floor, self.x(v), top, "grid") for v, _ in across]
        marks += [text(left - 5, self.y(v) + 4, words, "tick", "end") for v, words in up]
        marks += [text(self.x(v), floor + 14, words, "tick", "middle") for v, words in across]
        return group(
            *marks,
            self.baseline(),
            text((left + right) / 2, floor + 31, x_label, "label", "middle"),
            text(2, top - 11, y_label, "label"),
            class_="frame",
        )

    def baseline(self) -> Markup:
        """The two axis lines."""
        return path(
            [(self.x.start, self.y.end), (self.x.start, self.y.start), (self.x.end, self.y.start)],
            "axis",
        )


def width_of(words: str) -> float:
    """Width of words in the drawings' 11-unit type, in DejaVu Sans: few fonts are wider."""
    return sum(
        NARROW if letter in "fijlrt .,:;'|()[]" else WIDE if letter in "mwMW×%" else LETTER
        for letter in words
    )


def shortened(words: str, width: float) -> str:
    """Words cut to a width of the drawing, with an ellipsis when they do not fit."""
    if width_of(words) <= width:
        return words
    kept = len(words) - 1
    while kept > 3 and width_of(words[:kept] + "…") > width:
        kept -= 1
    return words[:kept] + "…"


def label_room(words: Iterable[str], most: float = 150.0) -> float:
    """Width that the longest of these labels needs, within reason."""
    return min(most, max(map(width_of, words), default=4 * LETTER) + 10)
