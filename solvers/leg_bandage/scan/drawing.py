"""Line drawings as SVG text: curves with axes, and outlines of sections."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from html import escape

import numpy as np

from .fitting import FittedScan
from .sections import THETA

DASHES = ("", "7 4", "2 3", "9 3 2 3")
COLOURS = ("#1b1b1b", "#c2410c", "#1d4ed8", "#15803d")
"""A line of its own colour has its own dashes too: for black and white."""

WIDTH, HEIGHT = 560, 300
LEFT, RIGHT, TOP, BOTTOM = 56, 14, 34, 46


def curves(
    x: np.ndarray,
    lines: Mapping[str, np.ndarray],
    x_label: str,
    y_label: str,
    marks: Mapping[str, float] | None = None,
    dots: bool = False,
    from_zero: bool = False,
) -> str:
    """Curves over x (n,) with axes and a legend; marks: name -> x of a vertical line.

    dots: a dot at each x, which is whole. from_zero: the y axis starts at 0.
    """
    every = np.concatenate(list(lines.values()))
    x_ticks, y_ticks = (
        ticks(x.min(), x.max()),
        ticks(0.0 if from_zero else every.min(), every.max()),
    )
    if dots:
        x_ticks = x_ticks[x_ticks == np.round(x_ticks)]
    plot = _Plot(x.min(), x.max(), min(every.min(), y_ticks[0]), max(every.max(), y_ticks[-1]))
    parts = [*plot.axes(x_ticks, y_ticks, x_label, y_label), *plot.marks(marks or {})]
    for k, (name, values) in enumerate(lines.items()):
        place = LEFT + k * (WIDTH - LEFT) / len(lines)
        parts += [
            *plot.line(x, values, k, dots),
            _polyline([(place, 14), (place + 26, 14)], k),
            _text(place + 31, 18, name, "start"),
        ]
    return _svg(WIDTH, HEIGHT, parts, f"{y_label} against {x_label}")


@dataclass(frozen=True)
class _Plot:
    """Where values lie on the drawing."""

    left: float
    right: float
    low: float
    high: float

    def across(self, x: float) -> float:
        return LEFT + (x - self.left) / (self.right - self.left) * (WIDTH - LEFT - RIGHT)

    def up(self, y: float) -> float:
        return HEIGHT - BOTTOM - (y - self.low) / (self.high - self.low) * (HEIGHT - TOP - BOTTOM)

    def axes(self, x_ticks, y_ticks, x_label: str, y_label: str) -> Iterator[str]:
        for tick in y_ticks:
            yield (
                f'<line x1="{LEFT}" x2="{WIDTH - RIGHT}" y1="{self.up(tick):.1f}" '
                f'y2="{self.up(tick):.1f}" class="grid"/>'
            )
            yield _text(LEFT - 6, self.up(tick) + 4, f"{tick:g}", "end")
        for tick in x_ticks:
            yield _text(self.across(tick), HEIGHT - BOTTOM + 18, f"{tick:g}")
        yield _text((LEFT + WIDTH - RIGHT) / 2, HEIGHT - 8, x_label)
        yield (
            f'<text transform="translate(14 {(TOP + HEIGHT - BOTTOM) / 2:.0f}) rotate(-90)" '
            f'text-anchor="middle">{escape(y_label)}</text>'
        )

    def marks(self, places: Mapping[str, float]) -> Iterator[str]:
        for name, place in places.items():
            x = self.across(place)
            yield (
                f'<line x1="{x:.1f}" x2="{x:.1f}" y1="{TOP}" y2="{HEIGHT - BOTTOM}" class="mark"/>'
            )
            yield _text(x + 3, HEIGHT - BOTTOM - 6, name, "start")

    def line(self, x: np.ndarray, y: np.ndarray, k: int, dots: bool) -> Iterator[str]:
        points = [(self.across(a), self.up(b)) for a, b in zip(x, y, strict=True)]
        yield _polyline(points, k)
        if dots:
            yield "".join(
                f'<circle cx="{a:.1f}" cy="{b:.1f}" r="3.5" fill="{COLOURS[k]}"/>'
                for a, b in points
            )


def _polyline(points, k: int) -> str:
    """A line in the k-th style through points (n, 2)."""
    path = " ".join(f"{a:.1f},{b:.1f}" for a, b in points)
    return (
        f'<polyline points="{path}" fill="none" stroke-width="2" stroke="{COLOURS[k]}" '
        f'stroke-dasharray="{DASHES[k]}"/>'
    )


def ticks(low: float, high: float) -> np.ndarray:
    """Round numbers that cover low..high, about five."""
    raw = (high - low or 1.0) / 5
    unit = 10.0 ** np.floor(np.log10(raw))
    step = unit * min((m for m in (1, 2, 5, 10) if m * unit >= raw), default=10)
    inner = np.arange(np.ceil(low / step - 1e-9), np.floor(high / step + 1e-9) + 1)
    return inner * step + 0.0  # no minus zero


def outlines(name: str, height: float, scan: FittedScan, size: int = 250) -> str:
    """One section from above: the scan (full line) and the fitted leg (dashed)."""
    rings = [leg.surface(np.append(THETA, 0.0), height)[:, :2] for leg in (scan.scanned, scan.leg)]
    middle = rings[0].mean(axis=0)
    reach = 1.3 * max(np.abs(ring - middle).max() for ring in rings)
    half = size / 2
    parts = []
    for k, ring in enumerate(rings):
        parts.append(_polyline(half + (ring - middle) * [1, -1] * half / reach, k))
    bar = 20 * half / reach
    parts += [
        _text(half, 13, "front"),
        _text(half, size - 4, "back"),
        _text(4, half, "inside", "start"),
        _text(size - 4, half, "outside", "end"),
        _text(half, half - 6, f"{name}, {height:.0f} mm"),
        f'<line x1="{half - bar / 2:.1f}" x2="{half + bar / 2:.1f}" y1="{half + 12:.1f}" '
        f'y2="{half + 12:.1f}" stroke="currentColor" stroke-width="2"/>',
        _text(half, half + 28, "20 mm"),
    ]
    return _svg(size, size, parts, f"section at {name}")


def _text(x: float, y: float, words: str, anchor: str = "middle") -> str:
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}">{escape(words)}</text>'


def _svg(width: int, height: int, parts: list[str], title: str) -> str:
    return (
        f'<svg viewBox="0 0 {width} {height}" role="img" aria-label="{escape(title)}">'
        f"{''.join(parts)}</svg>"
    )
