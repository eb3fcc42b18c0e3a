"""Horizontal sections of a surface: its radius about a centre line, at many levels at once.

A level is cut out of the triangles as segments; rays from the centre of the level meet
them at `RAYS` angles, and the outermost meeting counts, so that an inner shell of the mesh
does no harm. Rays that meet nothing show the holes. They are filled by the smoothest
continuation (least squares of the second differences over height and angle), and the centre is
moved to the centroid of the area, which is the centre that the shipped legs have.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import scipy.sparse as sp
from scipy.linalg import solveh_banded
from scipy.sparse.csgraph import reverse_cuthill_mckee

from ..geometry import section

RAYS = 180
THETA = 2 * np.pi * np.arange(RAYS) / RAYS

NEAR = 0.01
"""Part of the radius to which the centre is found by cutting again; the rest is first order."""


@dataclass(frozen=True)
class Sections:
    """Equally spaced horizontal sections.

    z        (S,) heights
    radius   (S, RAYS) distance of the skin from the centre, holes filled
    missing  (S, RAYS) where the surface has a hole
    centre   (S, 2) centroids of the areas
    """

    z: np.ndarray
    radius: np.ndarray
    missing: np.ndarray
    centre: np.ndarray

    @property
    def series(self) -> np.ndarray:
        """(S, 11) Fourier series of degree 5 of the radius."""
        return section.fit_series(THETA, self.radius)

    @property
    def girth(self) -> np.ndarray:
        """(S,) lengths of the Fourier sections: noise of the mesh does not lengthen them."""
        return section.girth(self.series)

    @property
    def points(self) -> np.ndarray:
        """(S, RAYS, 3) points of the skin."""
        ring = self.radius[..., None] * np.column_stack([np.cos(THETA), np.sin(THETA)])
        plane = ring + self.centre[:, None, :]
        height = np.broadcast_to(self.z[:, None, None], (*self.radius.shape, 1))
        return np.concatenate([plane, height], axis=-1)


def cut_sections(vertices: np.ndarray, triangles: np.ndarray, z: np.ndarray) -> Sections:
    """Sections of a surface at equally spaced heights z (S,), which must all meet it."""
    level, segments = _segments(vertices, triangles, z)
    centre = _middles(level, segments, len(z))
    for _ in range(6):
        radius = _radii(level, segments - centre[level][:, None], len(z))
        missing = np.isneginf(radius)
        radius = fill(np.where(missing, np.nan, radius))
        shift = _centroids(radius)
        if np.abs(shift).max() < NEAR * np.abs(radius).mean():
            break
        centre = centre + shift
    radius, centre = _about(radius, shift), centre + shift
    return Sections(z, radius, missing, np.column_stack([centre.real, centre.imag]))


def coverage(vertices: np.ndarray, triangles: np.ndarray, z: np.ndarray) -> np.ndarray:
    """Part of the circumference (S,) where the surface is met at heights z, 0 where it is not."""
    level, segments = _segments(vertices, triangles, z)
    met = np.bincount(level, minlength=len(z)) > 0
    centre = np.zeros(len(z), complex)
    centre[met] = _middles(level, segments, len(z))[met]
    return np.isfinite(_radii(level, segments - centre[level][:, None], len(z))).mean(axis=1)


def _segments(
    vertices: np.ndarray, triangles: np.ndarray, z: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Level (p,) and ends (p, 2), x + i y, of the segments that the triangles leave at z."""
    step = z[1] - z[0]
    height = [vertices[corner, 2] for corner in triangles.T]
    low = np.clip(np.floor((_least(*height) - z[0]) / step), 0, len(z))
    high = np.clip(np.ceil((-_least(*(-h for h in height)) - z[0]) / step), -1, len(z) - 1)
    count = np.maximum(high - low + 1, 0).astype(int)
    owner = np.repeat(np.arange(len(triangles)), count)
    level = _runs(low.astype(int), count)
    away = np.stack([h[owner] - z[level] for h in height])
    above = away >= 0
    count = above[0].astype(int) + above[1] + above[2]
    cut = (count == 1) | (count == 2)
    owner, level, away, above = owner[cut], level[cut], away[:, cut], above[:, cut]
    odd = above == (count[cut] == 1)
    lone = np.where(odd[0], 0, np.where(odd[1], 1, 2))
    flat = vertices[:, 0] + 1j * vertices[:, 1]
    ends, rows = [], np.arange(len(owner))
    for other in ((lone + 1) % 3, (lone + 2) % 3):
        share = away[lone, rows] / (away[lone, rows] - away[other, rows])
        a, b = flat[triangles[owner, lone]], flat[triangles[owner, other]]
        ends.append(a + share * (b - a))
    return level, np.stack(ends, axis=1)


def _least(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
    """Elementwise; a reduction over three columns takes ten times as long."""
    return np.minimum(np.minimum(a, b), c)


def _runs(first: np.ndarray, count: np.ndarray) -> np.ndarray:
    """first[0], first[0] + 1, ... count[0] of them, then the same of the next; (sum(count),)."""
    start = np.cumsum(count) - count
    return np.arange(count.sum()) - np.repeat(start - first, count)


def _middles(level: np.ndarray, segments: np.ndarray, levels: int) -> np.ndarray:
    """Middle (S,) of each outline by its length; the next one's where a level is not met."""
    length = np.abs(segments[:, 1] - segments[:, 0])
    middle = segments.mean(axis=1)
    total = np.bincount(level, weights=length, minlength=levels)
    x, y = (
        np.bincount(level, weights=length * part, minlength=levels)
        for part in (middle.real, middle.imag)
    )
    met, every = np.flatnonzero(total > 0), np.arange(levels)
    safe = total[met]
    return np.interp(every, met, x[met] / safe) + 1j * np.interp(every, met, y[met] / safe)


def _radii(level: np.ndarray, segments: np.ndarray, levels: int) -> np.ndarray:
    """Outermost meeting of each ray with the segments about 0, (S, RAYS); -inf: it meets none."""
    angle = np.angle(segments[:, 0])
    turn = np.angle(segments[:, 1] * segments[:, 0].conj())
    start = np.where(turn < 0, angle + turn, angle)
    spacing = 2 * np.pi / RAYS
    first = np.ceil(start / spacing).astype(int)
    count = np.ceil((start + np.abs(turn)) / spacing).astype(int) - first
    owner = np.repeat(np.arange(len(level)), count)
    ray = _runs(first, count)
    begin, along = segments[owner, 0], segments[owner, 1] - segments[owner, 0]
    across = (np.exp(-1j * spacing * ray) * along).imag
    along_ray = np.divide(
        (begin.conj() * along).imag, across, out=np.abs(begin), where=np.abs(across) > 1e-12
    )
    radius = np.full((levels, RAYS), -np.inf)
    np.maximum.at(radius, (level[owner], ray % RAYS), along_ray)
    return radius


def fill(radius: np.ndarray) -> np.ndarray:
    """Radii (S, RAYS) with the NaNs filled by the smoothest surface.

    Least squares of the second differences along the angle (periodic) and the height:
    exact for radii that are the same all around and linear in the height.
    """
    holes = np.isnan(radius).ravel()
    if not holes.any() or holes.all():
        return radius
    bend = _second_differences(*radius.shape)
    values = np.where(holes, 0, radius.ravel())
    unknown = bend[:, np.flatnonzero(holes)]
    values[holes] = _solved((unknown.T @ unknown).tocsr(), -unknown.T @ (bend @ values))
    return values.reshape(radius.shape)


def _solved(matrix: sp.csr_matrix, right: np.ndarray) -> np.ndarray:
    """Solution of a positive definite system of neighbours on a grid.

    By Cholesky of the band that Cuthill and McKee's order leaves, twice as fast as sparse LU.
    """
    order = reverse_cuthill_mckee(matrix, symmetric_mode=True)
    ordered = sp.tril(matrix[order][:, order]).tocoo()
    below = ordered.row - ordered.col
    band = np.zeros((below.max() + 1, len(right)))
    band[below, ordered.col] = ordered.data
    values = np.empty_like(right)
    values[order] = solveh_banded(band, right[order], lower=True, overwrite_ab=True)
    return values


@lru_cache(maxsize=8)
def _second_differences(levels: int, rays: int) -> sp.csc_matrix:
    """Of a grid (levels, rays): along the rays, periodic, then along the levels."""
    ring = sp.diags([1.0, 1.0, -2.0, 1.0, 1.0], [1 - rays, -1, 0, 1, rays - 1], (rays, rays))
    line = sp.diags([1.0, -2.0, 1.0], [0, 1, 2], (levels - 2, levels))
    return sp.vstack([sp.kron(sp.eye(levels), ring), sp.kron(line, sp.eye(rays))]).tocsc()


def _about(radius: np.ndarray, shift: np.ndarray) -> np.ndarray:
    """Radii (S, RAYS) about centres moved by a little, shift (S,), to first order."""
    away = shift[:, None] * np.exp(-1j * THETA)
    slope = (np.roll(radius, -1, axis=1) - np.roll(radius, 1, axis=1)) * RAYS / (4 * np.pi)
    return radius - away.real + slope / radius * away.imag


def _centroids(radius: np.ndarray) -> np.ndarray:
    """Centroids (S,) of the areas inside radii (S, RAYS) about 0, as x + i y."""
    corner = radius * np.exp(1j * THETA)
    ahead = np.roll(corner, -1, axis=1)
    cross = (corner.conj() * ahead).imag
    return ((corner + ahead) * cross).sum(axis=1) / (3 * cross.sum(axis=1))
