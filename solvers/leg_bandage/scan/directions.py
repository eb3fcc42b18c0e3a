"""Directions that the user knows in the axes of the scan: `--up z --front -y`."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from surrogate.errors import nearest

from .errors import ScanError

AXES = {
    sign + name: factor * np.eye(3)[k]
    for k, name in enumerate("xyz")
    for sign, factor in (("", 1), ("-", -1))
}


@dataclass(frozen=True)
class Directions:
    """Unit vectors (3,) of up and front in the axes of the scan; None: to be told by the shape."""

    up: np.ndarray | None = None
    front: np.ndarray | None = None

    @classmethod
    def parse(cls, up: str | None, front: str | None) -> Directions:
        """From names like `z` or `-y`; raises ScanError."""
        if front is not None and up is None:
            raise ScanError(f"front {front} is given without up; give --up too, or neither")
        found = [
            None if name is None else _axis(option, name)
            for option, name in (("up", up), ("front", front))
        ]
        if front is not None and abs(found[0] @ found[1]) > 0.5:
            raise ScanError(f"up {up} and front {front} are the same axis; give two different ones")
        return cls(*found)


def _axis(option: str, name: str) -> np.ndarray:
    if name.removeprefix("+") not in AXES:
        raise ScanError(f"{option} {name!r} is not a direction; {nearest(name, AXES)}")
    return AXES[name.removeprefix("+")]
