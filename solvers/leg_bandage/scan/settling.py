"""Which side a leg is of, and the pose in which the mean leg fits it.

Landmarks and foot tell the side; the shape only where it fits as well as validation legs do and the
other side clearly worse: on people's legs it told three of four wrongly or not at all.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ..geometry.basis import Basis
from .cuts import Cuts, find_cuts
from .directions import Directions
from .familiarity import WORST_RMS
from .foot import find_foot
from .marks import Landmarks
from .nearest import nearest_leg, standing_sections
from .pose import (
    SETTLED,
    STEPS,
    Body,
    Start,
    as_left,
    lost,
    shape_of,
    turn_to_mean,
)
from .sections import cut_sections

SIDES = ("auto", "right", "left")

SURE_OF_SIDE = 0.2
"""By what part worse the other side must fit for the side to be told by the shape."""


@dataclass(frozen=True)
class Options:
    """What the user said of the scan."""

    known: Directions
    marks: Landmarks
    side: str
    length: float | None
    ends: bool


@dataclass(frozen=True)
class Sided:
    """A body as a right leg in the pose of the mean leg, and how it came there."""

    side: str
    body: Body
    cuts: Cuts
    missed: float
    note: str = ""


def sided(start: Start, basis: Basis, options: Options) -> tuple[Sided, ...]:
    """The leg taken for the side that is given or told; for both, better first, if none tells."""
    side, how = options.side, "as given"
    if side == "auto":
        side, how = _told_side(start, options)
    tried = [
        settled(name, start if name == "right" else as_left(start, basis), basis, options)
        for name in (SIDES[1:] if side is None else (side,))
    ]
    best, *others = sorted(tried, key=lambda one: one.missed)
    if not others:
        return (replace(best, note=f"{best.side} leg, {how}"),)
    worse = others[0].missed / best.missed - 1
    _, error = nearest_leg(standing_sections(best.body, best.cuts), basis)
    if worse >= SURE_OF_SIDE and error.rms <= WORST_RMS:
        note = (
            f"{best.side} leg: found from the shape, the other side fits "
            f"{worse:.0%} worse; give --side if that is wrong"
        )
        return (replace(best, note=note),)
    note = (
        "neither foot nor landmarks nor shape tells whether this is a right or a left leg (the "
        f"other side fits {worse:.0%} worse): taken for a {{}} leg; give --side right or left"
    )
    return tuple(replace(one, note=note.format(one.side)) for one in (best, *others))


def _told_side(start: Start, options: Options) -> tuple[str | None, str]:
    """Side by landmarks, else by the foot, and how it was told; None if neither does."""
    side = options.marks.side(start.body)
    if side is not None:
        return side, "by the landmarks"
    foot = find_foot(start.body, start.zone.ankle)
    return (None, "") if foot is None else (foot.side, "by the foot")


def settled(side: str, start: Start, basis: Basis, options: Options) -> Sided:
    """Pose and cuts depend on each other: a step of each in turn until they stay."""
    body = start.body
    for _ in range(STEPS):
        cuts = find_cuts(body, start.zone, options.length, options.ends)
        body, angle = turn_to_mean(body, cuts.levels, basis)
        if angle < SETTLED:
            break
    return Sided(side, body, cuts, _missed(body, cuts, basis))


def _missed(body: Body, cuts: Cuts, basis: Basis) -> float:
    """Norm of what all modes miss of the shape."""
    shape = shape_of(cut_sections(body.vertices, body.triangles, cuts.levels))
    return float(np.linalg.norm(lost(shape, basis, basis.modes.shape[1])))
