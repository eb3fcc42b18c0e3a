"""What the foot tells, where it is scanned: where the front is, and which leg it is.

The axis is the long principal direction of the lowest `SLAB` mm, from heel to toes. On the
validation legs before they were cut it points 93.2 degrees from the outside (SD 2.0). The ridge
of the instep lies on the inner side of the foot, and the toes that reach farthest, the big and
the second one, bend to it: both on all of these feet, and in every anatomy of the foot.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .pose import Body
from .reading import triangle_areas

SLAB = 45.0
"""mm above the sole."""
UNDER_ANKLE, REACH, SLENDER = 50.0, 120.0, 1.8
"""A foot: reaches so many mm under the narrowest girth and before the ankle, and is so many
times as long as wide."""
FRONT = np.radians(93.2)
"""Direction of the foot in the axes of the shipped legs (x outside, y front)."""
RIDGE, TOES = 0.015, 2.0
"""Part of the width, and mm, by which ridge and toes must lie to one side for it to be told."""


@dataclass(frozen=True)
class Foot:
    """A foot under a leg that stands.

    angle  of its axis from x towards y, rad
    side   right or left, of the body as it stands; None where the foot does not tell
    """

    angle: float
    side: str | None


def find_foot(body: Body, ankle: float) -> Foot | None:
    """The foot of a body in mm whose narrowest girth is at height `ankle`; None without one."""
    corner = body.vertices[body.triangles]
    middle, area = corner.mean(axis=1), triangle_areas(corner)
    sole = float(body.vertices[:, 2].min())
    if ankle - sole < UNDER_ANKLE:
        return None
    above = np.abs(middle[:, 2] - ankle) < 10
    low = middle[:, 2] < sole + SLAB
    if not above.any() or low.sum() < 10:
        return None
    stand = np.average(middle[above, :2], axis=0, weights=area[above])
    centre, axis, slender = _axis(middle[low, :2], area[low])
    reach = (middle[low, :2] - stand) @ axis
    if abs(reach.min()) > reach.max():
        axis, reach = -axis, -reach
    if slender < SLENDER or reach.max() < REACH:
        return None
    under = middle[:, 2] < ankle - 20
    side = _side(middle[under] - [*centre, sole], area[under], axis)
    return Foot(float(np.arctan2(axis[1], axis[0])), side)


def _axis(points: np.ndarray, weight: np.ndarray) -> tuple[np.ndarray, np.ndarray, float]:
    """Middle (2,), long direction (2,), and length over width of points (n, 2)."""
    centre = np.average(points, axis=0, weights=weight)
    away = points - centre
    size, directions = np.linalg.eigh((away * weight[:, None]).T @ away)
    return centre, directions[:, 1], float(np.sqrt(size[1] / max(size[0], 1e-12)))


def _side(points: np.ndarray, area: np.ndarray, axis: np.ndarray) -> str | None:
    """Side from points (n, 3) about the foot's middle, sole at 0."""
    along = points[:, :2] @ axis
    across = points[:, :2] @ [axis[1], -axis[0]]  # to the outside of a right foot
    part = (along - along.min()) / np.ptp(along)
    instep = (part > 0.45) & (part < 0.75)
    if not instep.any():
        return None
    left, right = across[instep].min(), across[instep].max()
    height = area[instep] * points[instep, 2]
    ridge = (height @ (across[instep] - (left + right) / 2)) / height.sum() / (right - left)
    toes = across[part > 0.97].mean() - across[part < 0.1].mean()
    if ridge < -RIDGE and toes < -TOES:
        return "right"
    return "left" if ridge > RIDGE and toes > TOES else None
