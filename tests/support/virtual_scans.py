"""Scans whose truth is known: meshes of virtual legs, and what scanners do to them.

`data/whole_leg.npz` is a whole leg with foot, knee and thigh: validation leg 3 as
`tools/build_cohort.py` shapes it, before it is cut, with the level-one mesh of the body
model (MakeHuman / MPFB2, CC0 1.0). Vertices in fiftieths of a millimetre.
"""

from pathlib import Path

import numpy as np
import trimesh
from scipy.spatial.transform import Rotation

from surrogate_solvers.leg_bandage.geometry.cohort import snapshot
from surrogate_solvers.leg_bandage.geometry.leg import Leg

WHOLE_LEG = 3
"""Which validation leg `whole_leg` is."""


def whole_leg():
    """Vertices (n, 3), mm, in the axes of the shipped legs, and triangles (m, 3)."""
    with np.load(Path(__file__).parent / "data" / "whole_leg.npz") as stored:
        return stored["vertices"] / 50.0, stored["triangles"].astype(int)


def leg_mesh(
    leg: Leg,
    low: float = 0.0,
    high: float | None = None,
    foot: bool = False,
    levels: int = 120,
    around: int = 90,
):
    """The skin from low to high, mm; below z = 0 it may widen to a foot, above L to a thigh.

    A foot is 1 + (s / 45)^2 times as wide s mm under the ankle, a knee sinks by 4 % and a
    thigh widens by 40 % over 200 mm above the upper cut.
    """
    high = leg.length if high is None else high
    leg = leg.extended(max(0.0, -low) + 1, max(0.0, high - leg.length) + 1)
    z = np.linspace(low, high, levels)
    theta = 2 * np.pi * np.arange(around) / around
    points = leg.surface(theta, z[:, None])
    centre = np.column_stack([leg.centre_line(z), z])[:, None, :]
    wider = np.ones(levels)
    if foot:
        wider += (np.maximum(-z, 0) / 45) ** 2
        above = np.maximum(z - leg.length, 0)
        wider += (
            -0.04 * np.sin(np.pi * np.minimum(above / 80, 1)) ** 2
            + 0.4 * np.maximum(above - 80, 0) / 200
        )
    points = (
        centre
        + (points - centre) * np.append(np.ones(2), 0) * wider[:, None, None]
        + (points - centre) * [0, 0, 1]
    )
    corner = np.arange(levels * around).reshape(levels, around)
    right = np.roll(corner, -1, axis=1)
    a, b, c, d = (x.ravel() for x in (corner[:-1], right[:-1], right[1:], corner[1:]))
    return points.reshape(-1, 3), np.concatenate(
        [np.column_stack([a, b, c]), np.column_stack([a, c, d])]
    )


def truth(leg: Leg, basis, low: float, high: float):
    """Alphas of the part of a leg between two heights, without any mesh."""
    numbers = leg.numbers(np.linspace(low, high, 100))
    return basis.project(snapshot(numbers[:, :11], numbers[:, 11:] - numbers[0, 11:], high - low))


def moved(vertices, seed=None, scale=1.0, mirror=False):
    """Vertices after a random rigid motion, in another unit, as the other leg."""
    if mirror:
        vertices = vertices * [-1, 1, 1]
    if seed is not None:
        rng = np.random.default_rng(seed)
        vertices = vertices @ Rotation.random(rng=rng).as_matrix().T + rng.normal(0, 500, 3)
    return vertices / scale


def noisy(vertices, sigma, seed=0):
    """Independent noise on every coordinate, mm."""
    return vertices + np.random.default_rng(seed).normal(0, sigma, vertices.shape)


def without(vertices, triangles, balls):
    """Triangles without those whose middle lies in one of the balls (centre, radius)."""
    middle = vertices[triangles].mean(axis=1)
    gone = np.zeros(len(triangles), bool)
    for centre, radius in balls:
        gone |= np.linalg.norm(middle - np.asarray(centre), axis=1) < radius
    return triangles[~gone]


def save(path, vertices, triangles):
    """Write a mesh in the format that the name tells; returns the path."""
    trimesh.Trimesh(vertices, triangles, process=False).export(path)
    return path
