"""The pinned core of a leg: the envelope of tibia and fibula.

`data/bones.json` holds, at 21 heights, the convex hull of both bones in the mean leg as
fractions of the leg's local mean radius r0: scaled by the length instead, the bones of
slim legs pierce the skin. `tools/build_bones.py` rebuilds it from public meshes.

A hollow in the skin may still come nearer to the bones than any tissue is thin. There the
section of the bones shrinks about its own centre until LEAST_COVER is left. No shipped leg
needs it; the corners of their range need up to 9 %; `feasibility.py` refuses beyond 15 %.
"""

from __future__ import annotations

import json
from functools import cache

import numpy as np
from scipy.interpolate import CubicSpline

from . import section
from .cohort import DATA
from .leg import Leg

LEAST_COVER = 2.0
"""mm of tissue between bone and skin."""

THETA = np.radians(np.arange(0, 360, 10))


@cache
def _fractions() -> CubicSpline:
    """The 13 numbers of the envelope over r0, as a spline of height / length."""
    rows = json.loads((DATA / "bones.json").read_text())["rows"]
    return CubicSpline(
        [row["h"] for row in rows], [row["coefficients"] + row["offset"] for row in rows]
    )


@cache
def _fractions_at(sections: int) -> np.ndarray:
    """(S, 13) at equally spaced sections."""
    return _fractions()(np.linspace(0, 1, sections))


def bone_envelope(leg: Leg) -> Leg:
    """The bone envelope of this leg, a tube of the same kind with its own centre line.

    Its `surface(theta, z)` turns about the bone's centre, not the leg's: from a third of
    the height on the leg's centre lies outside the bones. Same sections, same extensions,
    but there the bone goes on straight: its widening to the ankle would reach the skin.
    """
    series, offset, _ = envelope(leg.coefficients)
    return Leg(leg.length, series, leg.centre + offset, leg.alphas, leg.below, leg.above, trend=0.5)


def envelope(skin: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Bones in equally spaced sections skin (S, 11), from cut to cut.

    Returns their series (S, 11), the offset (S, 2) of their centre from the leg's, mm, and
    the factor (S,) by which they had to shrink.
    """
    full, offset = np.split(skin[:, :1] * _fractions_at(len(skin)), [11], axis=1)
    missing = LEAST_COVER - _cover(skin, full, offset, THETA[:, None])
    shrink = 1 - np.maximum(missing / section.radius(full, THETA[:, None]), 0).max(axis=0)
    return shrink[:, None] * full, offset, shrink


def cover(leg: Leg, theta, z) -> np.ndarray:
    """Tissue between the skin and the bone's point at theta (about the bone's centre), mm.

    Measured along the normal of the horizontal section of the skin, to first order;
    negative where the bone is outside the skin. Arguments broadcast.
    """
    skin, bone = leg.numbers(z), bone_envelope(leg).numbers(z)
    return _cover(skin[..., :11], bone[..., :11], bone[..., 11:] - skin[..., 11:], theta)


def _cover(skin: np.ndarray, bone: np.ndarray, offset: np.ndarray, theta) -> np.ndarray:
    """`cover` of sections skin, bone (..., 11); offset (..., 2) of the bone's centre, mm."""
    point = offset[..., 0] + 1j * offset[..., 1] + section.curve(bone, theta)
    angle = np.angle(point)
    gap = section.curve(skin, angle) - point
    tangent = section.curve(skin, angle, 1)
    return (gap.conj() * tangent).imag / np.abs(tangent)
