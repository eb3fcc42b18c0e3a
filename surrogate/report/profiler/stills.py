"""Two still pictures of a scene, for print and for browsers without scripts."""

from __future__ import annotations

import numpy as np
from markupsafe import Markup
from numpy.typing import NDArray

from surrogate.fitting.geometry import Geometry
from surrogate.report import digits
from surrogate.report.content import Content
from surrogate.report.png import png_address
from surrogate.report.profiler.chosen import Chosen
from surrogate.report.profiler.payload import starting_point
from surrogate.report.profiler.scene_data import Colours, colours
from surrogate.space.space import Space

Array = NDArray[np.float64]

HEIGHT, WIDEST = 360, 360
#: Samples along the sides of a triangle, dense enough that no pixel between them stays empty.
DENSE = 9
#: Viridis from light to dark, as in `javascript/colours.js`.
STOPS = np.array(
    [
        [253, 231, 37], [189, 223, 38], [122, 209, 81], [68, 191, 112], [34, 168, 132],
        [33, 145, 140], [42, 120, 142], [53, 95, 141], [65, 68, 135], [72, 36, 117], [68, 1, 84],
    ],
    float,
)  # fmt: skip
UNCOLOURED = np.array([168.0, 180.0, 194.0])
LIGHT = np.array([-0.35, 0.45, 0.82])
#: Shades of a colour that are told apart, so that the pictures stay small.
SHADES, COLOURS = 8, 40

_FIGURE = Markup('<figure class="stills">{pictures}<figcaption>{caption}</figcaption></figure>\n')
_PICTURE = Markup('<img src="{address}" width="{width}" height="{height}" alt="{words}">')


def stills(content: Content, shown: list[Chosen], geometry: Geometry) -> Markup:
    """The first two views of the scene at the profiler's start, with what they show."""
    coded = starting_point(content)[0]
    surface = geometry.at(coded)[0]
    coloured = next(iter(colours(content, shown, geometry.scene)), None)
    values = None if coloured is None else _values(coloured, coded)
    what = "The geometry" if coloured is None else f"The geometry, coloured by {_told(coloured)}"
    pictures = []
    for name, view in list(geometry.scene.views.items())[:2]:
        tints = _tints(coloured, values, len(surface))
        pixels = picture(surface, np.asarray(geometry.scene.triangles), tints, view)
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


def picture(
    surface: Array, triangles: NDArray[np.intp], tints: Array, view: tuple[float, float]
) -> NDArray[np.uint8]:
    """Pixels (rows, columns, 4) of a surface (n, 3) with colours (n, 3); nothing around it.

    Triangles are filled with samples, of which each pixel keeps the nearest.
    """
    right, up, towards = _axes(*view)
    across, height, near = surface @ right, surface @ up, surface @ towards
    spans = np.ptp(across), np.ptp(height)
    scale = min((HEIGHT - 4) / (spans[1] or 1.0), (WIDEST - 4) / (spans[0] or 1.0))
    rows, columns = (int(np.ceil(span * scale)) + 4 for span in spans[::-1])
    shares = np.array(
        [(i, j, DENSE - i - j) for i in range(DENSE + 1) for j in range(DENSE + 1 - i)], float
    )
    shares = shares / DENSE

    def sampled(values: Array) -> Array:
        corners = values[triangles]
        samples = np.einsum("sc,tc...->ts...", shares, corners)
        return np.asarray(samples.reshape(-1, *values.shape[1:]))

    x = np.round(2 + (sampled(across) - across.min()) * scale).astype(int)
    y = np.round(rows - 3 - (sampled(height) - height.min()) * scale).astype(int)
    pixel = np.clip(y, 0, rows - 1) * columns + np.clip(x, 0, columns - 1)
    order = np.argsort(sampled(near), kind="stable")
    front = np.full(rows * columns, -1)
    front[pixel[order]] = order
    seen = front >= 0
    light = sampled(_light(surface, triangles, towards, np.array([right, up, towards])))
    tone = 0.74 + 0.26 * np.round(np.clip(light[front[seen]], 0, 1) * SHADES) / SHADES
    pixels = np.zeros((rows * columns, 4), np.uint8)
    pixels[seen, :3] = np.round(sampled(tints)[front[seen]] * tone[:, None])
    pixels[seen, 3] = 255
    return pixels.reshape(rows, columns, 4)


def _axes(azimuth: float, elevation: float) -> tuple[Array, Array, Array]:
    """Unit vectors to the right, up and towards the viewer, as in `javascript/camera.js`."""
    a, e = np.radians([azimuth, elevation])
    return (
        np.array([-np.sin(a), np.cos(a), 0.0]),
        np.array([-np.sin(e) * np.cos(a), -np.sin(e) * np.sin(a), np.cos(e)]),
        np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)]),
    )


def _light(surface: Array, triangles: NDArray[np.intp], towards: Array, axes: Array) -> Array:
    """How much light each point gets, (n,), on the side that is seen."""
    a, b, c = (surface[triangles[:, k]] for k in range(3))
    facets = np.cross(b - a, c - a)
    normals = np.zeros_like(surface)
    for k in range(3):
        np.add.at(normals, triangles[:, k], facets)
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    sign = np.where(normals @ towards >= 0, 1.0, -1.0)
    return np.asarray(sign * (normals @ (LIGHT @ axes)))
