"""Input files with placeholders: `{{ name }}` or `{{ name:format }}`, on one line.

`format` is a Python format specification (`10.3e`, `.6f`, `d` for whole numbers); without
one, numbers are written so that reading them back gives the same number. Everything else
in the file stays as it is. Files that use `{{` themselves take other `delimiters`.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping

from surrogate.errors import SolverError, nearest
from surrogate.solver import Input


def pattern(delimiters: tuple[str, str]) -> re.Pattern[str]:
    """Finds placeholders; its groups are the name and the format."""
    left, right = map(re.escape, delimiters)
    return re.compile(rf"{left}[ \t]*([^\n]*?)[ \t]*{right}")


def _split(inside: str) -> tuple[str, str]:
    name, _, specification = inside.partition(":")
    return name.strip(), specification.strip()


def names(text: str, placeholder: re.Pattern[str]) -> set[str]:
    """Names of the inputs that a text uses."""
    return {_split(found[1])[0] for found in placeholder.finditer(text)}


def mistakes(
    text: str, where: str, placeholder: re.Pattern[str], inputs: Mapping[str, Input]
) -> Iterable[str]:
    """A sentence for each placeholder that no input fills or whose format does not work."""
    for found in placeholder.finditer(text):
        line = text.count("\n", 0, found.start()) + 1
        name, specification = _split(found[1])
        if name not in inputs:
            yield f"{where}:{line}: '{found[0]}' names no input; {nearest(name, inputs)}"
            continue
        levels = inputs[name].levels
        try:
            _written(levels[0] if levels else 1.0, specification)
        except ValueError as error:
            yield (
                f"{where}:{line}: '{found[0]}' has a format that does not work "
                f"({error}); write for instance {name}:.6e"
            )


def fill(text: str, placeholder: re.Pattern[str], values: Mapping[str, float | str]) -> str:
    """The text with every placeholder replaced; raises `SolverError` for a fractional `d`."""

    def replace(found: re.Match[str]) -> str:
        name, specification = _split(found[1])
        try:
            return _written(values[name], specification)
        except ValueError as error:
            raise SolverError(
                f"{name}: {values[name]} cannot be written as '{specification}' "
                f"({error}); vary whole numbers only, or change the format"
            ) from error

    return placeholder.sub(replace, text)


def _written(value: float | str, specification: str) -> str:
    if isinstance(value, str):
        return format(value, specification)
    value = float(value)
    if specification.endswith("d"):
        if not value.is_integer():
            raise ValueError("not a whole number")
        return format(int(value), specification)
    return format(value, specification) if specification else repr(value)
