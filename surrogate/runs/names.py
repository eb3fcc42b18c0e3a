"""What the names in a runs dataset may be, and the texts that a file of it can hold."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from surrogate.solver import Output
from surrogate.space.space import Space

#: Names that a study's parameters, outputs and outputs' dimensions cannot have.
RESERVED_NAMES = frozenset(
    {
        "run",
        "parameter",
        "coded",
        "design",
        "status",
        "message",
        "seconds",
        "attempts",
        "finished",
        "origin",
    }
)


def name_mistakes(space: Space, outputs: Mapping[str, Output]) -> list[str]:
    """A sentence for each name that a dataset cannot hold, or that would stand for two things.

    Units, levels and coordinates that its file cannot hold are told too.
    """
    unheld = [*_unheld_names(outputs), *_unheld_texts(space, outputs)]
    if unheld:
        return unheld
    return [
        *_reserved(space, outputs),
        *_shared_names(space, outputs),
        *_coordinate_mistakes(outputs),
    ]


def storable(text: str) -> str:
    """A text without what a netCDF file cannot hold: NUL, and bytes that were no UTF-8."""
    return text.encode(errors="replace").decode().replace("\0", "?")


def _dims(outputs: Mapping[str, Output]) -> dict[str, str]:
    """Dimension -> the last output that has it."""
    return {dim: name for name, output in outputs.items() for dim in output.dims}


def _unheld_names(outputs: Mapping[str, Output]) -> Iterator[str]:
    for what, names in (("output", list(outputs)), ("dimension", list(_dims(outputs)))):
        for name in names:
            if not isinstance(name, str):
                yield f"{what} {name!r}: a name must be text; rename it"
            elif name in ("", "."):
                yield f"{what} {name!r}: a name in the runs dataset cannot be {name!r}; rename it"
            elif "/" in name:
                yield f"{what} {name!r}: a name in the runs dataset cannot hold '/'; rename it"
            elif name != storable(name) or not name.isprintable():
                yield (
                    f"{what} {name!r}: a name in the runs dataset cannot hold NUL or other "
                    "characters that cannot be printed; rename it"
                )


def _unheld_texts(space: Space, outputs: Mapping[str, Output]) -> Iterator[str]:
    cure = "cannot hold NUL or halves of characters; correct it in the solver"
    units = {f"output '{name}'": str(output.unit) for name, output in outputs.items()}
    units |= {f"parameter '{one.name}'": one.unit or "" for one in space.parameters}
    for what, unit in units.items():
        if unit != storable(unit):
            yield f"{what}: the unit {unit!r} {cure}"
    for parameter in space.parameters:
        for level in parameter.levels:
            if level != storable(level):
                yield f"parameter '{parameter.name}': the level {level!r} {cure}"


def _reserved(space: Space, outputs: Mapping[str, Output]) -> Iterator[str]:
    reserved = f"reserved in the runs dataset ({', '.join(sorted(RESERVED_NAMES))}); rename it"
    named = [(f"parameter '{name}'", name) for name in space.names]
    named += [(f"output '{name}'", name) for name in outputs]
    named += [
        (f"dimension '{dim}' of output '{name}'", dim) for dim, name in _dims(outputs).items()
    ]
    for what, name in named:
        if name in RESERVED_NAMES:
            yield f"{what}: the name is {reserved}"


def _shared_names(space: Space, outputs: Mapping[str, Output]) -> Iterator[str]:
    for name in space.names:
        if name in outputs:
            yield f"'{name}' is both a parameter and an output; rename one"
    for dim, name in _dims(outputs).items():
        if dim in space.names or dim in outputs:
            yield (
                f"'{dim}' is both a dimension of output '{name}' and a parameter or output; "
                "rename one"
            )


def _coordinate_mistakes(outputs: Mapping[str, Output]) -> Iterator[str]:
    first: dict[str, str] = {}
    for name, output in outputs.items():
        for dim in output.dims:
            if dim not in output.coordinates:
                yield f"output '{name}' has no coordinates along '{dim}'; give it some"
                continue
            values = np.asarray(output.coordinates[dim])
            if values.ndim != 1 or not _storable_values(values):
                yield (
                    f"output '{name}': the coordinates along '{dim}' must be numbers, dates or "
                    "texts, shape (size,)"
                )
                continue
            other = first.setdefault(dim, name)
            if not np.array_equal(values, outputs[other].coordinates[dim]):
                yield (
                    f"outputs '{other}' and '{name}' have different coordinates along "
                    f"'{dim}'; give one of the dimensions another name"
                )


def _storable_values(values: NDArray[Any]) -> bool:
    if values.dtype.kind == "U":
        return all(text == storable(text) for text in values.tolist())
    return values.dtype.kind in "iufbM"
