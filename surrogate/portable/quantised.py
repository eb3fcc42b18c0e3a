"""Numbers to a step: rows of whole numbers of 8 bits, or of 16 where asked, packed to be short.

`javascript/numbers.js` reads them: {"steps": ["low step bytes base64", ...]} is a list of rows,
each low + step * k; a row is off by half a step at most. Stored are the differences of one k to the
next, all low bytes and then all high ones: where neighbours are alike these are few and small.
"""

from __future__ import annotations

import base64
import zlib
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


def quantised(rows: ArrayLike, tolerance: float | Array = 0.0) -> dict[str, Any]:
    """Rows (k, n) to 8 bits where half a step is below the tolerance (of all, or a row), else 16.

    16 bits: half a step is 1 / 131 070 of the row's span.
    """
    given = np.asarray(rows, float)
    allowed = np.broadcast_to(tolerance, len(given))
    return {"steps": [_row(row, float(one)) for row, one in zip(given, allowed, strict=True)]}


def whole(rows: ArrayLike) -> dict[str, Any]:
    """Rows of whole numbers from 0 to 65535, exactly."""
    return {"steps": [f"0 1 2 {_text(np.asarray(row), 2)}" for row in np.asarray(rows)]}


def read(packed: dict[str, Any]) -> Array:
    """The rows as the page has them, (k, n)."""
    return np.array([_read(*row.split()) for row in packed["steps"]])


def cost(packed: dict[str, Any]) -> NDArray[np.intp]:
    """Characters that each row takes, compressed and in base64."""
    return np.array([len(zlib.compress(row.encode())) * 4 // 3 for row in packed["steps"]], np.intp)


def _row(row: Array, tolerance: float) -> str:
    low, span = float(row.min()), float(np.ptp(row))
    size = 1 if span / 510.0 <= tolerance else 2
    step = float(span / (256**size - 1)) or 1.0
    return f"{low!r} {step!r} {size} {_text(np.round((row - low) / step), size)}"


def _text(numbers: NDArray[Any], size: int) -> str:
    differences = np.diff(numbers.astype(f"<u{size}"), prepend=np.zeros(1, f"<u{size}"))
    planes = differences.view(np.uint8).reshape(-1, size).T
    return base64.b64encode(planes.tobytes()).decode("ascii")


def _read(low: str, step: str, size: str, text: str) -> Array:
    planes = np.frombuffer(base64.b64decode(text), np.uint8).reshape(int(size), -1)
    differences = np.ascontiguousarray(planes.T).view(f"<u{size}").ravel()
    numbers = np.cumsum(differences, dtype=f"<u{size}").astype(float)
    return np.asarray(float(low) + float(step) * numbers)
