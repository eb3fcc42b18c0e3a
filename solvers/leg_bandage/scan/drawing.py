"""Line drawings as SVG text: curves with axes, and outlines of sections."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape

import numpy as np

from solvers.leg_bandage.scan.fitting import FittedScan
from solvers.leg_bandage.scan.sections import THETA

DASHES = ("", "7 4", "2 3")
COLOURS = ("#1b1b1b", "#c2410c", "#1d4ed8")
"""A line of its own colour has its own dashes too: for black and white."""

WIDTH, HEIGHT = 560, 300
LEFT, RIGHT, TOP, BOTTOM = 56, 14, 34, 46


def curves(x: np.ndarray, lines: Mapping[str, np.ndarray], x_label: str, y_label: str,
           marks: Mapping[str, float] | None = None, dots: bool = False,
           from_zero: bool = False) -> str:
    """Curves over x (n,) with axes and a legend; marks: name -> x of a vertical line."""
    every = np.concatenate(list(lines.values()))
    low, high = (0.0 if from_zero else every.min()), every.max()
    y_ticks, x_ticks = ticks(low, high), ticks(x.min(), x.max())
    if dots:
        x_ticks = x_ticks[x_ticks == np.round(x_ticks)]
    low, high = min(low, y_ticks[0]), max(high, y_ticks[-1])

    def across(value):
        return LEFT + (value - x.min()) / np.ptp(x) * (WIDTH - LEFT - RIGHT)

    def up(value):
        return HEIGHT - BOTTOM - (value - low) / (high - low) * (HEIGHT - TOP - BOTTOM)

    parts = [f'<line x1="{LEFT}" x2="{WIDTH - RIGHT}" y1="{up(t):.1f}" y2="{up(t):.1f}" '
             f'class="grid"/>{_text(LEFT - 6, up(t) + 4, f"{t:g}", "end")}' for t in y_ticks]
    parts += [_text(across(t), HEIGHT - BOTTOM + 18, f"{t:g}") for t in x_ticks]
    for name, place in (marks or {}).items():
        parts.append(f'<line x1="{across(place):.1f}" x2="{across(place):.1f}" y1="{TOP}" '
                     f'y2="{HEIGHT - BOTTOM}" class="mark"/>'
                     + _text(across(place) + 3, HEIGHT - BOTTOM - 6, name, "start"))
    for k, (name, values) in enumerate(lines.items()):
        style = f'stroke="{COLOURS[k]}" stroke-dasharray="{DASHES[k]}"'
        path = " ".join(f"{across(a):.1f},{up(b):.1f}" for a, b in zip(x, values, strict=True))
        parts.append(f'<polyline points="{path}" fill="none" stroke-width="2" {style}/>')
        if dots:
            parts += [f'<circle cx="{across(a):.1f}" cy="{up(b):.1f}" r="3.5" '
                      f'fill="{COLOURS[k]}"/>' for a, b in zip(x, values, strict=True)]
        place = LEFT + k * (WIDTH - LEFT) / len(lines)
        parts.append(f'<line x1="{place:.0f}" x2="{place + 26:.0f}" y1="14" y2="14" '
                     f'stroke-width="2" {style}/>{_text(place + 31, 18, name, "start")}')
    parts += [_text((LEFT + WIDTH - RIGHT) / 2, HEIGHT - 8, x_label),
              f'<text transform="translate(14 {(TOP + HEIGHT - BOTTOM) / 2:.0f}) rotate(-90)" '
              f'text-anchor="middle">{escape(y_label)}</text>']
    return _svg(WIDTH, HEIGHT, parts, f"{y_label} against {x_label}")


def ticks(low: float, high: float) -> np.ndarray:
    """Round numbers that cover low..high, about five."""
    raw = (high - low or 1.0) / 5
    unit = 10.0 ** np.floor(np.log10(raw))
    step = unit * min((m for m in (1, 2, 5, 10) if m * unit >= raw), default=10)
    inner = np.arange(np.ceil(low / step - 1e-9), np.floor(high / step + 1e-9) + 1)
    return inner * step + 0.0  # no minus zero


def outlines(name: str, height: float, scan: FittedScan, size: int = 250) -> str:
    """One section from above: the scan (full line) and the fitted leg (dashed)."""
    rings = [leg.surface(np.append(THETA, 0.0), height)[:, :2]
             for leg in (scan.scanned, scan.leg)]
    middle = rings[0].mean(axis=0)
    reach = 1.3 * max(np.abs(ring - middle).max() for ring in rings)
    half = size / 2
    parts = []
    for k, ring in enumerate(rings):
        place = half + (ring - middle) * [1, -1] * half / reach
        path = " ".join(f"{a:.1f},{b:.1f}" for a, b in place)
        parts.append(f'<polyline points="{path}" fill="none" stroke-width="2" '
                     f'stroke="{COLOURS[k]}" stroke-dasharray="{DASHES[k]}"/>')
    bar = 20 * half / reach
    parts += [_text(half, 13, "front"), _text(half, size - 4, "back"),
              _text(4, half, "inside", "start"), _text(size - 4, half, "outside", "end"),
              _text(half, half - 6, f"{name}, {height:.0f} mm"),
              f'<line x1="{half - bar / 2:.1f}" x2="{half + bar / 2:.1f}" y1="{half + 12:.1f}" '
              f'y2="{half + 12:.1f}" stroke="currentColor" stroke-width="2"/>',
              _text(half, half + 28, "20 mm")]
    return _svg(size, size, parts, f"section at {name}")


def _text(x: float, y: float, words: str, anchor: str = "middle") -> str:
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}">{escape(words)}</text>'


def _svg(width: int, height: int, parts: list[str], title: str) -> str:
    return (f'<svg viewBox="0 0 {width} {height}" role="img" aria-label="{escape(title)}">'
            f'{"".join(parts)}</svg>')
