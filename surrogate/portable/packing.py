"""Numbers of a document as base64 of float64, those that stand in it twice once.

`javascript/numbers.js` reads them: {"float64": base64, "shape": [...]} for lists of numbers,
nested in a rectangle, and {"shared": k} for the k-th of those that are met again.
"""

from __future__ import annotations

import base64
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

#: Fewer numbers than this are shorter as they are.
FEW = 3


@dataclass
class Packer:
    """Packs documents that share numbers; `shared` is what `packed` refers to."""

    shared: list[dict[str, Any]] = field(default_factory=list)
    _known: dict[tuple[bytes, tuple[int, ...]], int] = field(default_factory=dict)

    def packed(self, part: Any) -> Any:
        """JSON data with its lists of numbers packed; all else as it is."""
        if isinstance(part, Mapping):
            return {key: self.packed(value) for key, value in part.items()}
        if not isinstance(part, list | tuple):
            return part
        numbers = _numbers(part)
        return [self.packed(value) for value in part] if numbers is None else self._put(numbers)

    def _put(self, numbers: np.ndarray) -> dict[str, Any]:
        data = numbers.tobytes()
        key = (data, numbers.shape)
        if key not in self._known:
            self._known[key] = len(self.shared)
            text = base64.b64encode(data).decode("ascii")
            self.shared.append({"float64": text, "shape": list(numbers.shape)})
        return {"shared": self._known[key]}


def _numbers(part: list[Any] | tuple[Any, ...]) -> np.ndarray | None:
    """The list as an array of little-endian float64; None when it is none, or short."""
    leaf: Any = part
    while isinstance(leaf, list | tuple) and leaf:
        leaf = leaf[0]
    if not isinstance(leaf, float):
        return None
    try:
        numbers = np.array(part)
    except ValueError:  # rows of different lengths
        return None
    if numbers.dtype != np.float64 or numbers.size <= FEW:
        return None
    return numbers.astype("<f8")
