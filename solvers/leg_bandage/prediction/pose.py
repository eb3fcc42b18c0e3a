"""What an unknown pose does to the pressure: the front elsewhere, the leg of the other side."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from ..scan import FittedScan, ScanError
from .bandage_choice import BandageChoice
from .interval import Part, reach
from .reduced import Reduced
from .shape import Shape, at_b1
from .shape_correction import shape_law

_TELLER = {"given": "user", "landmarks": "landmarks", "foot": "foot", "shape": "shape"}


def other_shapes(scan: FittedScan, shape: Shape) -> dict[str, tuple[Shape, ...]]:
    """The shapes that the leg may have instead: its front elsewhere, the other side."""
    found: dict[str, tuple[Shape, ...]] = {}
    if scan.front is not None:
        off = np.radians(scan.front.off)
        found["front"] = tuple(shape.turned(part * off) for part in (-1.0, -0.5, 0.5, 1.0))
    if scan.other is not None:
        found["side"] = (Shape.of(scan.other),)
    return found


def pose_parts(
    scan: FittedScan,
    value: float,
    others: Mapping[str, tuple[Shape, ...]],
    reduced: Reduced,
    choice: BandageChoice,
) -> Iterator[Part]:
    """Parts of front and side; raises ScanError for sides that do not agree."""
    values = {
        name: [at_b1(one, reduced, reduced.inputs(one.coordinates, choice)) for one in shapes]
        for name, shapes in others.items()
    }
    if scan.front is not None:
        yield reach(
            "front",
            value,
            values["front"],
            f"front told by the {_TELLER[scan.front.source]}, up to {scan.front.off:g} degrees off",
        )
    if scan.other is not None:
        (other,) = values["side"]
        if abs(other / value - 1) > shape_law().error():
            raise ScanError(
                f"{scan.path}: neither foot nor landmarks nor shape tells whether this is a right "
                f"or a left leg, and the pressure at B1 hangs on it: {value:.1f} mmHg as a "
                f"{scan.side} leg, {other:.1f} as a {scan.other.side} one; give --side right or "
                "--side left"
            )
        yield reach(
            "side", value, [other], f"taken for a {scan.side} leg; {other:.1f} mmHg as the other"
        )
