"""Points of one's own, from a CSV file in physical units.

The first line names the columns; every parameter needs one, others are ignored. Values
are in each parameter's unit; categorical ones are level names. Lines that start with #
and empty lines are skipped. ::

    mu_skin,tension
    0.10,0.059
    0.30,0.137
"""

from __future__ import annotations

import csv as reader
import math
from pathlib import Path

import numpy as np

from surrogate.errors import DesignError, StudyError, nearest
from surrogate.space.discrete import DiscreteLaw
from surrogate.space.space import Parameter, Space

#: Mistakes shown before the rest is only counted.
SHOWN = 20


def csv(
    space: Space,
    *,
    path: str,
    delimiter: str = ",",
    folder: Path | None = None,
    seed: int | None = None,
) -> np.ndarray:
    """Coded points (run, parameter) of the file's rows.

    path       the file, relative to `folder` (the study's; default the current one)
    delimiter  the character between columns; `;` is common where commas are decimal points,
               but values need points as decimal signs
    Raises `DesignError` naming the line of every missing, unreadable or out-of-range value.
    """
    file = Path(folder or ".") / path
    lines = _read(file, delimiter)
    if len(lines) < 2:
        raise DesignError(
            f"{file}: has no points; write a line of parameter names and a line for each point"
        )
    header = [name.strip() for name in lines[0][1]]
    _check_header(file, header, space, delimiter)
    mistakes: list[str] = []
    rows, at = [], []
    for number, cells in lines[1:]:
        if len(cells) != len(header):
            mistakes.append(
                f"{file}:{number}: {len(cells)} values where the first line names "
                f"{len(header)} columns"
            )
            continue
        named = dict(zip(header, cells, strict=True))
        at.append(number)
        rows.append(
            [
                _coded(p, named[p.name].strip(), f"{file}:{number}", mistakes)
                for p in space.parameters
            ]
        )
    if not mistakes and space.region is not None:
        rows = space.region.completed(np.array(rows)).tolist()
        mistakes += [
            f"{file}:{at[i]}: the point breaks constraint '{text}'; change the point or the "
            "constraint"
            for text, where in space.region.broken(np.array(rows))
            for i in np.flatnonzero(where)
        ]
    if mistakes:
        more = [f"and {len(mistakes) - SHOWN} more"] if len(mistakes) > SHOWN else []
        raise DesignError("\n".join(mistakes[:SHOWN] + more))
    return np.array(rows)


def _read(file: Path, delimiter: str) -> list[tuple[int, list[str]]]:
    """(line number, cells) of every line with content."""
    if not isinstance(delimiter, str) or len(delimiter) != 1:
        raise DesignError(f"delimiter: {delimiter!r} must be one character, such as ';'")
    try:
        text = file.read_text(encoding="utf-8-sig")
    except OSError as error:
        raise DesignError(
            f"path: {file} cannot be read ({error.strerror}); give the path "
            "relative to the study file"
        ) from error
    except UnicodeDecodeError as error:
        raise DesignError(
            f"path: {file} is not a text file in UTF-8; save it as CSV UTF-8"
        ) from error
    # Quoted cells cannot span lines here, so that a line number is always a file's line.
    return [
        (number, next(reader.reader([line], delimiter=delimiter)))
        for number, line in enumerate(text.splitlines(), 1)
        if line.strip() and not line.lstrip().startswith("#")
    ]


def _check_header(file: Path, header: list[str], space: Space, delimiter: str) -> None:
    mistakes = [
        f"{file}:1: no column for parameter '{name}'; {nearest(name, header)}"
        for name in space.names
        if name not in header
    ]
    mistakes += [
        f"{file}:1: column '{name}' stands twice" for name in space.names if header.count(name) > 1
    ]
    if mistakes and len(header) == 1:
        mistakes.append(f"{file}:1: there is one column only; is '{delimiter}' the delimiter?")
    if mistakes:
        raise DesignError("\n".join(mistakes))


def _coded(parameter: Parameter, cell: str, where: str, mistakes: list[str]) -> float:
    """Coded value of one cell; adds a sentence to `mistakes` (and gives NaN) when it has none."""
    if parameter.categorical:
        try:
            return float(parameter.encode(cell))
        except StudyError as error:
            mistakes.append(f"{where}: {error}")
            return math.nan
    try:
        value = float(cell)
    except ValueError:
        mistakes.append(f"{where}: {parameter.name}: '{cell}' is not a number")
        return math.nan
    low, high = parameter.law.support
    # The last digit of a printed end of the range is forgiven.
    slack = 1e-9 * (high - low) if parameter.bounded else 0.0
    if not low - slack <= value <= high + slack:
        mistakes.append(
            f"{where}: {parameter.name}: {cell} lies outside [{low:g}, {high:g}] "
            f"{parameter.unit}".rstrip()
            + "; change the point or the range"
        )
        return math.nan
    law = parameter.distribution
    if isinstance(law, DiscreteLaw) and not law.allows(value):
        nearest_value = law.values[law.nearest(value)]
        mistakes.append(
            f"{where}: {parameter.name}: {cell} is not allowed ({law}); the nearest is "
            f"{nearest_value:g}"
        )
        return math.nan
    return float(np.clip(parameter.snap(parameter.encode(value)), -1.0, 1.0))
