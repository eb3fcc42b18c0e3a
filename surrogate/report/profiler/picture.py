"""A still picture of a surface: samples of its triangles, of which each pixel keeps the nearest."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

HEIGHT, WIDEST = 360, 360
#: Samples a pixel along the longest side of a triangle: no pixel between them stays empty.
DENSE = 1.5
LIGHT = np.array([-0.35, 0.45, 0.82])
INK = np.array([20, 24, 29, 255], np.uint8)
#: Share of the scene's size by which a line may lie behind the surface and is still seen.
SUNK = 0.006
#: Shades of a colour that are told apart, so that the pictures stay small.
SHADES = 8


def picture(
    surface: Array,
    triangles: NDArray[np.intp],
    tints: Array,
    view: tuple[float, float],
    lines: Sequence[Array] = (),
) -> NDArray[np.uint8]:
    """Pixels (rows, columns, 4) of a surface (n, 3) with colours (n, 3); nothing around it.

    view: azimuth and elevation, degrees. Lines (m, 3), NaN where there is none, are seen where
    they do not lie behind the surface.
    """
    right, up, towards = _axes(*view)
    across, height, near = surface @ right, surface @ up, surface @ towards
    spans = np.ptp(across), np.ptp(height)
    scale = min((HEIGHT - 4) / (spans[1] or 1.0), (WIDEST - 4) / (spans[0] or 1.0))
    rows, columns = (int(np.ceil(span * scale)) + 4 for span in spans[::-1])
    corners, shares = _samples(np.column_stack([across, height]) * scale, triangles)

    def sampled(values: Array, at: NDArray[np.intp] | slice = slice(None)) -> Array:
        return np.asarray(np.einsum("sc,sc...->s...", shares[at], values[corners[at]]))

    def pixels_of(along: Array, high: Array) -> NDArray[np.intp]:
        x = np.round(2 + (along - across.min()) * scale).astype(int)
        y = np.round(rows - 3 - (high - height.min()) * scale).astype(int)
        return np.asarray(np.clip(y, 0, rows - 1) * columns + np.clip(x, 0, columns - 1))

    pixel, depth = pixels_of(sampled(across), sampled(height)), sampled(near)
    order = np.argsort(depth, kind="stable")
    front = np.full(rows * columns, -1)
    front[pixel[order]] = order
    seen = front >= 0
    nearest = front[seen]
    light = sampled(_light(surface, triangles, towards, np.array([right, up, towards])), nearest)
    tone = 0.74 + 0.26 * np.round(np.clip(light, 0, 1) * SHADES) / SHADES
    pixels = np.zeros((rows * columns, 4), np.uint8)
    pixels[seen, :3] = np.round(sampled(tints, nearest) * tone[:, None])
    pixels[seen, 3] = 255
    sunk = SUNK * float(np.linalg.norm(np.ptp(surface, axis=0)))
    for own in lines:
        line = own[np.isfinite(own).all(axis=1)]
        at = pixels_of(line @ right, line @ up)
        shown = at[~seen[at] | (line @ towards > depth[front[at]] - sunk)]
        pixels[shown] = pixels[shown + 1 - 2 * (shown % columns == columns - 1)] = INK
    return pixels.reshape(rows, columns, 4)


def _samples(places: Array, triangles: NDArray[np.intp]) -> tuple[NDArray[np.intp], Array]:
    """Corners (s, 3) and their shares (s, 3) of points that fill triangles; places in pixels."""
    sides = places[triangles] - places[np.roll(triangles, 1, axis=1)]
    longest = np.linalg.norm(sides, axis=2).max(axis=1)
    level = np.ceil(np.log2(np.maximum(DENSE * longest, 1.0))).astype(int)
    corners, shares = [], []
    for one in np.unique(level):
        n, own = 2**one, triangles[level == one]
        grid = np.array([(i, j, n - i - j) for i in range(n + 1) for j in range(n + 1 - i)]) / n
        corners.append(np.repeat(own, len(grid), axis=0))
        shares.append(np.tile(grid, (len(own), 1)))
    return np.concatenate(corners), np.concatenate(shares)


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
