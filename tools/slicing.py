"""Horizontal cuts through triangle meshes."""

from __future__ import annotations

import numpy as np


def segments(triangles: np.ndarray, z: float) -> np.ndarray:
    """Segments (n, 2 ends, 2) in which triangles (m, 3 corners, 3) meet the height z.

    A height that hits a corner exactly is moved by a billionth of a millimetre.
    """
    height = triangles[..., 2] - z
    height = np.where(height == 0, 1e-9, height)
    hit = np.abs(np.sign(height).sum(axis=1)) == 1
    corners, height = triangles[hit], height[hit]
    ends = []
    for start, end in ((0, 1), (1, 2), (2, 0)):
        a, b = height[:, start], height[:, end]
        share = np.divide(a, a - b, out=np.zeros_like(a), where=a != b)
        point = corners[:, start] + share[:, None] * (corners[:, end] - corners[:, start])
        ends.append(np.where((a * b < 0)[:, None], point[:, :2], np.nan))
    ends = np.stack(ends, axis=1)
    return ends[~np.isnan(ends[..., 0])].reshape(-1, 2, 2)


def cut(triangles: np.ndarray, z: float) -> np.ndarray:
    """Points (n, 2) of the cut at z, each once."""
    return np.unique(np.round(segments(triangles, z).reshape(-1, 2), 9), axis=0)
