"""What a design asks of a space and of its options, checked in one place.

Every check lists all offenders in one `DesignError` and says what to do instead.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from surrogate.errors import DesignError, nearest
from surrogate.space.space import Space

#: A design larger than this is a slip of the pen: no one runs a solver a million times.
LARGEST = 1_000_000


def bounded(space: Space, method: str) -> None:
    """Raise when a parameter has no finite value at coded -1 and 1."""
    _refuse(
        [
            f"{p.name}: {method} sets it to both ends of its range, but {p.distribution} has no "
            "ends; give it a range, or use latin_hypercube, sobol or halton"
            for p in space.parameters
            if not p.bounded
        ]
    )


def two_level(space: Space, method: str) -> None:
    """Raise when a parameter is unbounded or has more than two named levels."""
    bounded(space, method)
    _refuse(
        [
            f"{p.name}: {method} has two levels a parameter, but this one has {len(p.levels)} "
            f"({', '.join(p.levels)}); keep two of them, or use full_factorial, d_optimal, "
            "latin_hypercube or sobol"
            for p in space.parameters
            if len(p.levels) > 2
        ]
    )


def continuous(space: Space, method: str) -> None:
    """Raise when a parameter is unbounded, categorical, or has two allowed values only."""
    bounded(space, method)
    _refuse(
        [
            f"{p.name}: {method} needs values between the ends of a range, but this parameter has "
            f"levels ({', '.join(p.levels)}); use full_factorial, d_optimal, latin_hypercube "
            "or sobol"
            for p in space.parameters
            if p.categorical
        ]
        + [
            f"{p.name}: {method} needs a value between the ends, but this parameter takes only "
            f"{p.decode(-1.0):g} and {p.decode(1.0):g}; use full_factorial, d_optimal, "
            "latin_hypercube or sobol"
            for p in space.parameters
            if p.allowed is not None and len(p.allowed) == 2
        ]
    )


def uncut(space: Space, coded: NDArray[np.float64], method: str) -> NDArray[np.float64]:
    """The points (run, parameter); raise when a constraint cuts some of them."""
    if space.region is not None:
        _refuse(
            [
                f"constraint '{text}' cuts {int(where.sum())} of the {len(coded)} points of "
                f"{method}; use d_optimal or latin_hypercube, or narrow a range"
                for text, where in space.region.broken(coded)
            ]
        )
    return coded


def whole(option: str, value: object, least: int) -> int:
    """`value` as an int; raise unless it is a whole number from `least` on."""
    if isinstance(value, bool) or not isinstance(value, int | np.integer) or value < least:
        raise DesignError(f"{option}: {value!r} must be a whole number of at least {least}")
    return int(value)


def number(option: str, value: object, low: float, high: float) -> float:
    """`value` as a float; raise unless it lies in [low, high]."""
    if (
        isinstance(value, bool)
        or not isinstance(value, int | float | np.number)
        or not low <= value <= high
    ):
        raise DesignError(f"{option}: {value!r} must be a number from {low:g} to {high:g}")
    return float(value)


def choice(option: str, value: str, allowed: Iterable[str]) -> str:
    """`value`; raise unless it is one of the words `allowed`."""
    if value not in allowed:
        raise DesignError(f"{option}: {value!r} is unknown; {nearest(value, allowed)}")
    return value


def affordable(runs: int, method: str, cure: str) -> None:
    """Raise when a design would have more than `LARGEST` runs."""
    if runs > LARGEST:
        raise DesignError(f"{method} would have {runs:,} runs; {cure}")


def _refuse(mistakes: list[str]) -> None:
    if mistakes:
        raise DesignError("\n".join(mistakes))
