"""Where the front of a leg is, who tells it, and how far that may be off.

By the user (`--front`), by landmarks, by the foot, else by the shape. The shape tells it well on
legs of the shipped family only: on legs of another one it was 14 degrees off. How far each may
be off, 95 %, is turned into a part of the interval of the pressure.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from .directions import Directions
from .errors import ScanError
from .foot import FRONT, find_foot
from .marks import Landmarks
from .pose import Body

OFF: Mapping[str, float] = {"given": 3.0, "landmarks": 8.0, "foot": 8.0, "shape": 15.0}
"""degrees. Foot: 2 SD are 4 within the shipped family, and torsion of the tibia differs between
people (21.6 +- 7.6 degrees of all the leg in print). Shape: see `SCANS.md`. The others are
assumed."""

CREDIBLE = 60.0
"""degrees from the front that the shape tells, beyond which foot or landmark is not believed."""


@dataclass(frozen=True)
class Front:
    """Who told the front: given, landmarks, foot or shape; and the degrees it may be off."""

    source: str
    off: float


def turned_to_front(
    body: Body, ankle: float, known: Directions, marks: Landmarks
) -> tuple[Body, Front]:
    """The body turned about z to the front that landmarks or foot tell; it is a right leg.

    A front that the user gave is kept, and so is that of the shape where nothing else tells.
    Raises ScanError for landmarks that the leg cannot have.
    """
    if known.front is not None:
        return body, Front("given", OFF["given"])
    source, front = "landmarks", marks.front(body)
    if front is None and (foot := find_foot(body, ankle)) is not None:
        source, front = "foot", foot.angle - FRONT + np.pi / 2
    if front is None:
        return body, Front("shape", OFF["shape"])
    turn = np.angle(np.exp(1j * (np.pi / 2 - front)))
    if abs(np.degrees(turn)) > CREDIBLE:
        if source == "foot":
            return body, Front("shape", OFF["shape"])
        raise ScanError(
            f"the landmarks put the front {abs(np.degrees(turn)):.0f} degrees from where the shape "
            f"of the leg has it (at most {CREDIBLE:g}); look whether they are right, and the side"
        )
    return body.turned(Rotation.from_rotvec([0, 0, turn]).as_matrix()), Front(source, OFF[source])


def about_front(front: Front) -> str:
    """The sentence on where the front came from."""
    words = {
        "given": "front as given",
        "landmarks": "front by the landmarks",
        "foot": "front along the foot",
        "shape": "front found from the shape; scan the foot, or give --landmark or --front",
    }
    return f"{words[front.source]}: it may be {front.off:g} degrees off"
