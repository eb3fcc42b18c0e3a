"""Pictures of the coloured leg as SVG text: four sides, the colour bar, the answers in a row."""

from __future__ import annotations

from html import escape

import numpy as np

from ..scan.drawing import curves, ticks
from .coloured_leg import RAYS, SIDES, STOPS, Surface, colours
from .pressure import Prediction

EVERY = 2
"""Of the levels and rays, in pictures: their facets are still some 6 mm."""


def four_sides(surface: Surface, size: int = 190) -> list[tuple[str, str]]:
    """Name and picture of the leg from its inside, front, outside and back, to one scale."""
    middle = surface.points.mean(axis=(0, 1))
    half = 1.06 * np.abs(surface.points - middle)[..., :2].max()
    tall = 1.03 * np.ptp(surface.points[..., 2]) / (2 * half) * size
    return [
        (side, _view(surface, side, middle, size / (2 * half), size, tall))
        for side in ("inside", "front", "outside", "back")
    ]


def _view(
    surface: Surface, side: str, middle: np.ndarray, scale: float, size: float, tall: float
) -> str:
    towards = _towards(side, surface.mirrored)
    right = np.array([-towards[1], towards[0], 0.0])

    def place(points):
        away = points - middle
        return np.stack([size / 2 + scale * (away @ right), tall / 2 - scale * away[..., 2]], -1)

    levels = np.unique(np.append(np.arange(0, len(surface.points), EVERY), len(surface.points) - 1))
    rays = np.arange(0, RAYS + 1, EVERY) % RAYS
    skin, pressure = surface.points[np.ix_(levels, rays)], surface.pressure[np.ix_(levels, rays)]
    corners = [skin[:-1, :-1], skin[:-1, 1:], skin[1:, 1:], skin[1:, :-1]]
    normal = np.cross(corners[2] - corners[0], corners[3] - corners[1])
    facing = normal @ towards / np.linalg.norm(normal, axis=-1) * (-1 if surface.mirrored else 1)
    mean = (pressure[:-1, :-1] + pressure[:-1, 1:] + pressure[1:, 1:] + pressure[1:, :-1]) / 4
    shade = colours(mean, surface.ticks[-1]) * (0.72 + 0.28 * facing[..., None])
    depth = np.mean([corner @ towards for corner in corners], axis=0)
    flat = np.stack([place(corner) for corner in corners], axis=2)
    parts = [
        _facet(flat[i, j], shade[i, j])
        for i, j in sorted(zip(*np.nonzero(facing > 0), strict=True), key=lambda at: depth[at])
    ]
    if side == "inside" and len(surface.rim):
        parts += _sensor(place(surface.rim))
    return (
        f'<svg viewBox="0 0 {size:.0f} {tall:.0f}" role="img" shape-rendering="crispEdges" '
        f'aria-label="pressure on the leg, seen from its {side}">{"".join(parts)}</svg>'
    )


def _towards(side: str, mirrored: bool) -> np.ndarray:
    """Unit vector from the leg to who looks at this side of it."""
    angle = SIDES.index(side) * np.pi / 2
    return np.array([np.cos(angle) * (-1 if mirrored else 1), np.sin(angle), 0.0])


def _facet(corners: np.ndarray, colour: np.ndarray) -> str:
    path = " ".join(f"{x:.1f},{y:.1f}" for x, y in corners)
    tone = "#" + "".join(f"{round(part):02x}" for part in colour)
    return f'<polygon points="{path}" fill="{tone}" stroke="{tone}" stroke-width=".6"/>'


def _sensor(rim: np.ndarray) -> list[str]:
    path = " ".join(f"{x:.1f},{y:.1f}" for x, y in rim)
    return [
        f'<polygon points="{path}" fill="none" stroke="{tone}" stroke-width="{width}" '
        'shape-rendering="auto"/>'
        for tone, width in (("#fff", 4), ("#000", 1.6))
    ]


def colour_bar(surface: Surface, width: int = 340) -> str:
    """Pressures and their colours, lying."""
    top, inset = surface.ticks[-1], 14
    stops = "".join(
        f'<stop offset="{k / (len(STOPS) - 1):.3f}" stop-color="rgb({r},{g},{b})"/>'
        for k, (r, g, b) in enumerate(STOPS)
    )
    marks = "".join(
        f'<text x="{inset + tick / top * (width - 2 * inset):.1f}" y="31" '
        f'text-anchor="middle">{tick:g}</text>'
        for tick in surface.ticks
    )
    return (
        f'<svg viewBox="0 0 {width} 50" role="img" aria-label="colour bar, 0 to {top:g} mmHg">'
        f'<linearGradient id="bar">{stops}</linearGradient><rect x="{inset}" y="4" '
        f'width="{width - 2 * inset}" height="13" fill="url(#bar)"/>{marks}'
        f'<text x="{width / 2}" y="46" text-anchor="middle">pressure on the skin, mmHg</text>'
        "</svg>"
    )


def answers_drawn(told: Prediction, width: int = 400) -> str:
    """The answers on one axis: the reduced model with its interval and its parts, the others."""
    lines: list[tuple[str, float | None, float | None, float | None, str]]
    lines = [("reduced model", told.value, told.low, told.high, "strong")]
    lines += [
        (f"{part.name} alone", None, told.value + part.low, told.value + part.high, "part")
        for part in told.parts
    ]
    if told.solved:
        lines.append(("finite elements", told.solved.value, None, None, "dot"))
    lines += [
        (f"Laplace, {words}", told.laplace[leg], None, None, "hollow")
        for leg, words in (("scanned", "scan"), ("fitted", "modes"))
        if told.laplace[leg] is not None
    ]
    if told.tape is not None:
        lines.append(("Laplace, tape", told.tape, None, None, "hollow"))
    numbers = [x for _, *three, _ in lines for x in three if x is not None]
    spread = max(numbers) - min(numbers) or 1.0
    low, high = max(min(numbers) - 0.06 * spread, 0.0), max(numbers) + 0.06 * spread
    left, row, bottom = 122, 26, 10 + 26 * len(lines)

    def across(x):
        return left + (x - low) / (high - low) * (width - left - 22)

    parts = [
        f'<line x1="{across(tick):.1f}" x2="{across(tick):.1f}" y1="4" y2="{bottom}" '
        f'class="grid"/><text x="{across(tick):.1f}" y="{bottom + 16}" class="tick" '
        f'text-anchor="middle">{tick:g}</text>'
        for tick in ticks(low, high)
    ]
    for k, (name, value, *ends, kind) in enumerate(lines):
        y = 10 + row * (k + 0.5)
        parts.append(
            f'<text x="{left - 10}" y="{y + 4:.1f}" text-anchor="end">{escape(name)}</text>'
        )
        if ends[0] is not None:
            parts.append(
                f'<line x1="{across(ends[0]):.1f}" x2="{across(ends[1]):.1f}" y1="{y}" '
                f'y2="{y}" class="{kind}"/>'
            )
        if value is not None:
            parts.append(
                f'<circle cx="{across(value):.1f}" cy="{y}" r="5" class="{kind}"/>'
                f'<text x="{across(value):.1f}" y="{y - 8:.1f}" class="tick" '
                f'text-anchor="middle">{value:.1f}</text>'
            )
    parts.append(
        f'<text x="{(left + width - 22) / 2:.0f}" y="{bottom + 34}" '
        'text-anchor="middle">pressure at B1, mmHg</text>'
    )
    return (
        f'<svg viewBox="0 0 {width} {bottom + 40}" role="img" aria-label="pressure at B1 by '
        f'each method">{"".join(parts)}</svg>'
    )


def along_drawn(told: Prediction) -> str:
    """Mean and range around the leg, along it, with the target and the points."""
    curve, points = told.curve(), {point.name: point.place.height for point in told.points}
    ends = (points["B"], points["D"])
    return curves(
        curve.height,
        {
            "mean": curve.mean,
            "lowest": curve.lowest,
            "highest": curve.highest,
            "target": np.interp(curve.height, ends, told.gradient),
        },
        "height above the ankle cut, mm",
        "pressure, mmHg",
        marks={name: at for name, at in points.items() if at <= curve.height[-1]},
        from_zero=True,
    )
