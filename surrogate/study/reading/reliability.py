"""From the words of `reliability:` to failures whose probability is asked for."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Literal

from surrogate.errors import nearest
from surrogate.reliability.problem import METHODS, Failure
from surrogate.solver import Output, Solver
from surrogate.space import units
from surrogate.space.space import Space
from surrogate.study.parts.reliability import ReliabilityPart
from surrogate.study.reading.mistakes import Reading
from surrogate.study.reading.named import check_surrogate, is_scalar


def limits_of(
    reading: Reading, solver: Solver, space: Space | None, outputs: Iterable[str]
) -> dict[str, Failure]:
    """Every failure of the study; outputs: those that the study keeps. Mistakes are noted."""
    offered = {name: solver.outputs[name] for name in outputs if name in solver.outputs}
    found = {}
    for name, part in reading.part.reliability.items():
        one = _failure(reading, name, part, space, offered)
        if one is not None:
            found[name] = one
    return found


def _failure(
    reading: Reading,
    name: str,
    part: ReliabilityPart,
    space: Space | None,
    offered: Mapping[str, Output],
) -> Failure | None:
    path = ("reliability", name)
    check_surrogate(reading, part.surrogate, "reliability reads a surrogate", *path)
    if part.method not in METHODS:
        sentence = f"method '{part.method}' is unknown; {nearest(part.method, METHODS)}"
        reading.wrong(sentence, *path, "method")
    elif space is not None and space.region is not None and part.method not in ("auto", "crude"):
        reading.wrong(
            f"method {part.method} knows no constraints between parameters; take crude",
            *path,
            "method",
        )
    needed = "a limit needs a single number"
    if not is_scalar(reading, part.output, offered, needed, *path, "output"):
        return None
    unit = offered[part.output].unit
    key, given = ("above", part.above) if part.above is not None else ("below", part.below)
    with reading.mistakes_at(*path, key):
        limit = units.quantity(str(given), unit)
        sign: Literal[1, -1] = 1 if key == "above" else -1
        return Failure(name, part.output, limit, sign, unit, part.surrogate, part.method)
    return None
