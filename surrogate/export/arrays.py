"""Sizes and arrays of a formula, as the templates of C and Python call them."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from surrogate.export.formula import Formula


def arrays(one: Formula) -> dict[str, Any]:
    """The words of both templates: n places, `modes` amplitudes, a mapping for each process."""
    spread = one.spread
    return {
        "n": len(one.middle),
        "size": len(one.factors) + 1,
        "terms": padded(one.terms),
        "coefficients": one.coefficients,
        "modes": len(one.modes),
        "shapes": one.modes,
        "middle": one.middle,
        "left_out": one.left_out,
        "deviation": one.deviation,
        "spread": spread and vars(spread) | {"terms": padded(spread.terms)},
        "processes": [
            vars(process)
            | {
                "k": k,
                "n": len(process.centres),
                "c": len(process.columns),
                "m": len(process.members),
                "q": len(process.trend),
                "trend": padded(process.trend),
                "unit": repr(3.0 ** len(process.columns)),
                "lower": process.lower[np.tril_indices(len(process.lower))],
            }
            for k, process in enumerate(one.processes)
        ],
    }


def padded(terms: Iterable[tuple[int, ...]]) -> list[list[int]]:
    """Terms as rows of one length, filled up with factor 0, the constant 1."""
    rows = list(terms)
    longest = max([1, *map(len, rows)])
    return [[*row, *[0] * (longest - len(row))] for row in rows]
