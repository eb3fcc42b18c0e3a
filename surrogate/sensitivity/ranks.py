"""Which parameters the intervals of an index cannot put in order."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from surrogate.estimator import Array

#: Parameters whose interval ends below this have no rank that anybody asks for.
SMALL = 0.01


def ties(value: Array, low: Array, high: Array) -> list[list[int]]:
    """Runs of parameters, largest first, of which each interval meets that of the next.

    value, low, high: (parameter,). Parameters without a value, and those that are small, have
    no rank. Intervals that do not meet differ at their confidence; those that do may as well
    be in either order.
    """
    ranked = [k for k in np.argsort(-np.nan_to_num(value, nan=-1.0)) if high[k] >= SMALL]
    found: list[list[int]] = []
    for k in map(int, ranked):
        if found and high[k] >= min(low[other] for other in found[-1]):
            found[-1].append(k)
        else:
            found.append([k])
    return [tied for tied in found if len(tied) > 1]


def sentence(names: Sequence[str], index: str, value: Array, low: Array, high: Array) -> str:
    """`The order of a, b and c by total index is open: ...`; empty when the order is known."""
    said = [_listed([names[k] for k in tied]) for tied in ties(value, low, high)]
    if not said:
        return ""
    return f"The order of {'; of '.join(said)} by {index} is open: their intervals meet."


def _listed(words: list[str]) -> str:
    return f"{', '.join(words[:-1])} and {words[-1]}"
