"""Fields: a line over one coordinate, a grey map over two."""

from __future__ import annotations

import numpy as np
from markupsafe import Markup

from surrogate.report import digits
from surrogate.report.drawing import Panel, group, path, span, tag, text
from surrogate.report.plot import Column, Plot, column, plot
from surrogate.report.png import png_address

#: Points along a side of a map beyond which it is drawn coarser.
FINEST = 400
#: Points along a side of a map that are written out in numbers.
WRITTEN = 64


#: Curves in their order.
KINDS = ("curve", "curve dashed")


def field_line(
    x: np.ndarray,
    curves: dict[str, np.ndarray],
    x_label: str,
    y_label: str,
    title: str,
    band: tuple[np.ndarray, np.ndarray] | None = None,
    y_span: tuple[float, float] | None = None,
) -> Plot:
    """Curves over one coordinate x (m,): what it is -> (m,); `band` is (lower, upper).

    The first curve is solid, a second one dashed.
    """
    values = [*curves.values(), *(band or ())]
    panel = Panel.within(span(x, pad=0.0), y_span or span(*values), height=240.0)
    marks = []
    if band is not None:
        lower, upper = (list(zip(panel.x(x), panel.y(edge), strict=True)) for edge in band)
        marks.append(path(upper + lower[::-1], "band", closed=True))
    marks += [
        path(zip(panel.x(x), panel.y(np.clip(curve, panel.y.low, panel.y.high)), strict=True), kind)
        for curve, kind in zip(curves.values(), KINDS, strict=False)
    ]
    told = [
        f"{name}: {digits.interval(float(np.nanmin(curve)), float(np.nanmax(curve)))}"
        for name, curve in curves.items()
        if np.isfinite(curve).any()
    ]
    return plot(
        360,
        240,
        panel.frame(x_label, y_label),
        *marks,
        title=title,
        says=f"{y_label} over {x_label}. {'; '.join(told)}.",
        numbers=(
            column(x_label, x),
            *(column(name, curve) for name, curve in curves.items()),
            *(
                column(f"band, {end} end", edge)
                for end, edge in zip(("lower", "upper"), band or (), strict=False)
            ),
        ),
    )


def field_map(
    x: np.ndarray,
    y: np.ndarray,
    values: np.ndarray,
    x_label: str,
    y_label: str,
    label: str,
    title: str,
    limits: tuple[float, float] | None = None,
) -> Plot:
    """Values (len(y), len(x)) as a map, dark where they are high, with its scale beside it."""
    low, high = limits or span(values, pad=0.0)
    panel = Panel.within(_edges(x), _edges(y), right=66.0, height=270.0)
    shown = _on_even_grid(np.asarray(x, float), np.asarray(y, float), np.asarray(values, float))
    share = np.clip((shown - low) / (high - low), 0.0, 1.0)
    left, top = panel.x.start, panel.y.end
    width, height = panel.x.end - left, panel.y.start - top
    image = tag(
        "image",
        x=left,
        y=top,
        width=width,
        height=height,
        preserveAspectRatio="none",
        href=_picture(share[::-1]),
        class_="map",
    )
    return plot(
        360,
        270,
        panel.frame(x_label, y_label),
        image,
        panel.baseline(),
        _key(panel, low, high, label),
        title=title,
        says=_extremes(x, y, np.asarray(values, float), x_label, y_label),
        numbers=_written(x, y, np.asarray(values, float), x_label, y_label),
    )


def _extremes(x: np.ndarray, y: np.ndarray, values: np.ndarray, x_label: str, y_label: str) -> str:
    if not np.isfinite(values).any():
        return "No finite value."
    said = []
    for word, place in (("Smallest", np.nanargmin(values)), ("largest", np.nanargmax(values))):
        i, j = np.unravel_index(int(place), values.shape)
        said.append(
            f"{word} value {digits.figure(values[i, j])} at {x_label} {digits.figure(x[j])}, "
            f"{y_label} {digits.figure(y[i])}"
        )
    return f"A map over {x_label} and {y_label}. {'; '.join(said)}."


def _written(
    x: np.ndarray, y: np.ndarray, values: np.ndarray, x_label: str, y_label: str
) -> list[Column]:
    """A row a place of y, a column a place of x; of fine maps every so many places."""
    rows, columns = (np.unique(_nearest(np.asarray(p, float), WRITTEN)) for p in (y, x))
    return [
        column(f"{y_label} \\ {x_label}", np.asarray(y, float)[rows]),
        *(column(digits.figure(x[j], 4), values[rows, j]) for j in columns),
    ]


def _key(panel: Panel, low: float, high: float, label: str) -> Markup:
    """The strip that says which shade is which value."""
    left = panel.x.end + 12
    top, floor = panel.y.end, panel.y.start
    strip = np.linspace(1.0, 0.0, 64)[:, None]
    marks = [
        tag(
            "image",
            x=left,
            y=top,
            width=10.0,
            height=floor - top,
            class_="map",
            preserveAspectRatio="none",
            href=_picture(strip),
        )
    ]
    for share in (0.0, 0.5, 1.0):
        words = digits.figure(low + share * (high - low))
        marks.append(text(left + 13, floor + share * (top - floor) + 4, words, "tick"))
    marks.append(text(360 - 2, top - 11, label, "label", "end"))
    return group(*marks)


def _edges(places: np.ndarray) -> tuple[float, float]:
    """Ends of the cells whose middles these are."""
    places = np.asarray(places, dtype=float)
    if len(places) < 2:
        return span(places)
    low, high = np.sort(places)[[0, -1]]
    half = (high - low) / (len(places) - 1) / 2.0
    return float(low - half), float(high + half)


def _on_even_grid(x: np.ndarray, y: np.ndarray, values: np.ndarray) -> np.ndarray:
    """The values at the nearest given points of an even, rising grid."""
    rows, columns = _nearest(y), _nearest(x)
    return np.asarray(values[np.ix_(rows, columns)])


def _nearest(places: np.ndarray, most: int = FINEST) -> np.ndarray:
    even = np.linspace(places.min(), places.max(), min(len(places), most))
    return np.asarray(np.abs(places[None, :] - even[:, None]).argmin(axis=1))


def _picture(share: np.ndarray) -> str:
    """A PNG, as a data address, of shares in [0, 1] (rows from the top); NaN is white.

    From near-white through blue to near-black: the lightness falls all the way, so
    that a print without colour says the same.
    """
    stops = np.array([[247, 249, 252], [158, 190, 220], [62, 116, 172], [16, 34, 66]], float)
    at = np.nan_to_num(share) * (len(stops) - 1)
    base = np.minimum(at.astype(int), len(stops) - 2)
    part = (at - base)[..., None]
    pixels = np.round(stops[base] * (1.0 - part) + stops[base + 1] * part).astype(np.uint8)
    pixels[np.isnan(share)] = 255
    return png_address(pixels)
