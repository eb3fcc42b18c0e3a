"""Two still pictures of a scene, for print and for browsers without scripts."""

from __future__ import annotations

import numpy as np
from markupsafe import Markup
from numpy.typing import NDArray
from scipy.interpolate import LinearNDInterpolator

from surrogate.fitting.geometry import Geometry
from surrogate.report import digits
from surrogate.report.content import Content
from surrogate.report.png import png_address
from surrogate.report.profiler.chosen import Chosen
from surrogate.report.profiler.payload import starting_point
from surrogate.report.profiler.picture import picture
from surrogate.report.profiler.scene_data import Colours, colours
from surrogate.scene import Scene
from surrogate.space.space import Space

Array = NDArray[np.float64]

#: Viridis from light to dark, as in `javascript/colours.js`.
STOPS = np.array(
    [
        [253, 231, 37], [189, 223, 38], [122, 209, 81], [68, 191, 112], [34, 168, 132],
        [33, 145, 140], [42, 120, 142], [53, 95, 141], [65, 68, 135], [72, 36, 117], [68, 1, 84],
    ],
    float,
)  # fmt: skip
UNCOLOURED = np.array([168.0, 180.0, 194.0])
#: Colours that are told apart, so that the pictures stay small.
COLOURS = 40

_FIGURE = Markup('<figure class="stills">{pictures}<figcaption>{caption}</figcaption></figure>\n')
_PICTURE = Markup('<img src="{address}" width="{width}" height="{height}" alt="{words}">')


def stills(content: Content, shown: list[Chosen], geometry: Geometry) -> Markup:
    """The first two views of the scene at the profiler's start, with what they show."""
    coded = starting_point(content)[0]
    surface, *others = geometry.at(coded)
    lines = _in_space(geometry.scene, surface, others[: len(geometry.scene.lines)])
    coloured = next(colours(content, shown, geometry.scene), None)
    values = None if coloured is None else _values(coloured, coded)
    what = "The geometry" if coloured is None else f"The geometry, coloured by {_told(coloured)}"
    tints, pictures = _tints(coloured, values, len(surface)), []
    for name, view in list(geometry.scene.views.items())[:2]:
        pixels = picture(surface, np.asarray(geometry.scene.triangles), tints, view, lines)
        words = f"{what}, seen from: {name}."
        pictures.append(
            _PICTURE.format(
                address=png_address(pixels),
                width=pixels.shape[1],
                height=pixels.shape[0],
                words=words,
            )
        )
    names = " and ".join(list(geometry.scene.views)[:2])
    caption = f"{what}, at {_place(content.space, coded)}; views: {names}."
    if coloured is not None:
        caption += _range(coloured, content.unit(coloured.one.output))
    return _FIGURE.format(pictures=Markup("").join(pictures), caption=caption)


def _told(coloured: Colours) -> str:
    return f"{coloured.one.output} of {coloured.one.surrogate}"


def _range(coloured: Colours, unit: str) -> str:
    ends = [digits.figure(end) for end in (coloured.low, coloured.high)]
    return f" Yellow: {ends[0]}, dark violet: {ends[1]} {digits.unit(unit)}".rstrip() + "."


def _place(space: Space, coded: Array) -> str:
    values = space.decode(coded[None])
    return ", ".join(
        f"{name} {value[0]}"
        if space[name].categorical
        else f"{name} {digits.figure(float(value[0]))} {digits.unit(space[name].unit)}".rstrip()
        for name, value in values.items()
    )


def _values(coloured: Colours, coded: Array) -> Array:
    """The field at the points of the surface, (n,), by its surrogate."""
    model = coloured.one.document["model"]
    field = np.asarray(coloured.one.fit.predict(coded[None]), float).reshape(-1)
    modes = np.asarray(model["modes"], float).reshape(-1, len(field))
    amplitudes = modes @ (field - np.asarray(model["mean"], float))
    return np.asarray(coloured.mean + amplitudes @ coloured.modes)


def _tints(coloured: Colours | None, values: Array | None, count: int) -> Array:
    """Colours of the points, (n, 3)."""
    if coloured is None or values is None:
        return np.tile(UNCOLOURED, (count, 1))
    share = np.clip((values - coloured.low) / (coloured.high - coloured.low), 0, 1)
    at = np.round(share * COLOURS) / COLOURS * (len(STOPS) - 1)
    places = np.arange(len(STOPS))
    return np.column_stack([np.interp(at, places, channel) for channel in STOPS.T])


def _in_space(scene: Scene, surface: Array, lines: list[Array]) -> list[Array]:
    """Lines as dense points (m, 3); those on the surface are NaN where it ends."""
    closed = [
        np.vstack([own, own[:1]]) if line.closed else own
        for line, own in zip(scene.lines, lines, strict=True)
    ]
    dense = [
        np.column_stack(
            [np.interp(np.arange(0, len(own) - 1, 0.1), np.arange(len(own)), c) for c in own.T]
        )
        for own in closed
    ]
    if all(own.shape[1] == 3 for own in dense):
        return dense
    dims = list(scene.coordinates)[:2]
    places = np.column_stack([np.asarray(scene.coordinates[dim], float) for dim in dims])
    lows = places.min(axis=0)
    periods = [scene.periods.get(dim) for dim in dims]
    for d, period in enumerate(periods):
        if period is not None:  # the start again, at the end
            again = places[:, d] <= lows[d]
            places = np.vstack([places, places[again] + period * np.eye(2)[d]])
            surface = np.vstack([surface, surface[again]])
    between = LinearNDInterpolator(places, surface, rescale=True)

    def wrapped(own: Array) -> Array:
        columns = [
            column if period is None else low + (column - low) % period
            for column, low, period in zip(own.T, lows, periods, strict=True)
        ]
        return np.column_stack(columns)

    return [own if own.shape[1] == 3 else np.asarray(between(wrapped(own))) for own in dense]
