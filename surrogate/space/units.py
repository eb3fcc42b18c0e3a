"""Units by pint: the straight line from one unit to another.

pint is loaded when two units differ: most studies write the solver's own, and loading it
takes longer than reading them.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from functools import cache, lru_cache
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from surrogate.errors import StudyError

if TYPE_CHECKING:
    from pint import UnitRegistry
    from pint.util import UnitsContainer

    #: Powers of length, mass, time ...: what `dimension` gives; supports *, / and **.
    Dimension = UnitsContainer

NUMBER_AND_UNIT = re.compile(
    r"([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)(?:(?:\s+|(?=[^\W\d_]|[°%]))(\S.*))?"
)
#: What may be read as a unit: a product of names with small exponents. pint computes what it
#: reads, and 9**9**9**9 would fill the memory.
_UNIT = re.compile(
    r"""(?:
        (?:\*\*|\^)\s*\(?\s*[-+]?\d{1,2}(?:\.\d*)?(?![\w.])\s*\)?(?!\s*(?:\*\*|\^))  # exponent
        | 1(?![\w.])                                                                   # 1/s
        | [^\W\d]\w*+                                                                  # name
        | (?!\*\*)[^\w^,]                                                              # * / ( ) %
    )*+""",
    re.VERBOSE,
)
_LONGEST_UNIT = 100

#: Seconds of the units that durations are written in; the others are left to pint.
_SECONDS = {"ms": 1e-3, "min": 60.0, "h": 3600.0, "day": 86400.0, "days": 86400.0}


@dataclass(frozen=True)
class Conversion:
    """y = slope * x + offset, from one unit to another."""

    slope: float
    offset: float

    def place(self, x: float) -> float:
        """A value on the scale, such as a temperature."""
        return self.slope * x + self.offset if self.offset else self.slope * x

    def places(self, x: ArrayLike) -> NDArray[np.float64]:
        """The same for many values, of any shape."""
        return np.asarray(self.slope * np.asarray(x, dtype=float) + self.offset)

    def distance(self, x: float) -> float:
        """A difference of values, such as a standard deviation."""
        return self.slope * x


IDENTITY = Conversion(1.0, 0.0)


@cache
def _registry() -> UnitRegistry[float]:
    """pint's units, read once."""
    from pint import UnitRegistry

    return UnitRegistry(autoconvert_offset_to_baseunit=True)


def known(unit: str) -> bool:
    """True when pint can read `unit`."""
    if len(unit) > _LONGEST_UNIT or not _UNIT.fullmatch(unit):
        return False
    from pint.errors import PintError

    try:
        _registry().parse_units(unit)
    except (
        PintError,
        ValueError,
        TypeError,
        AttributeError,
        SyntaxError,
        AssertionError,
        ArithmeticError,
        LookupError,
    ):
        return False
    except Exception as error:  # pint lets errors of Python's tokenizer through
        if type(error).__name__ in ("TokenError", "DefinitionSyntaxError"):
            return False
        raise
    return True


@lru_cache(maxsize=256)
def conversion(unit: str, target: str) -> Conversion:
    """How values in `unit` become values in `target`; raises `StudyError` when they cannot."""
    if unit == target:
        return IDENTITY
    if target == "s" and unit in _SECONDS:
        return Conversion(_SECONDS[unit], 0.0)
    for name in (unit, target):
        if not known(name):
            shown = name if len(name) <= _LONGEST_UNIT else f"{name[:_LONGEST_UNIT]}..."
            raise StudyError(f"unit '{shown}' is unknown; write it as 'mm', 'N/mm', 'kPa' ...")
    from pint.errors import PintError

    try:
        zero = _registry().Quantity(0.0, unit).to(target).magnitude
        one = _registry().Quantity(1.0, unit).to(target).magnitude
    except (PintError, ArithmeticError):
        raise StudyError(f"unit '{unit}' does not convert to {_named(target)}") from None
    return Conversion(one - zero, zero)


def dimensionless(unit: str) -> bool:
    """Whether a unit is none, by the names that solvers give to none."""
    return unit in ("", "1", "dimensionless")


def _named(unit: str) -> str:
    return f"'{unit}', the solver's unit" if unit else "a number without unit, as the solver has it"


def seconds(text: str | float) -> float:
    """Seconds of a duration such as '30 min', '2 h' or a number of seconds."""
    if isinstance(text, (int, float)) and not isinstance(text, bool):
        return float(text)
    try:
        return quantity(str(text), "s")
    except StudyError:
        shown = text if len(str(text)) <= _LONGEST_UNIT else f"{str(text)[:_LONGEST_UNIT]}..."
        raise StudyError(
            f"duration '{shown}' is not understood; write '30 s', '30 min' or '2 h'"
        ) from None


def size(text: str | float) -> float:
    """Bytes of a size such as '4 GB', '512 MiB' or a number of bytes."""
    if isinstance(text, (int, float)) and not isinstance(text, bool):
        return float(text)
    try:
        return quantity(str(text), "byte")
    except StudyError:
        shown = text if len(str(text)) <= _LONGEST_UNIT else f"{str(text)[:_LONGEST_UNIT]}..."
        raise StudyError(f"size '{shown}' is not understood; write '4 GB' or '512 MB'") from None


def quantity(text: str, target: str) -> float:
    """Number in `target` units of a text such as '98', '98 N/m', '98N/m' or '1e-3'.

    A bare number is taken to be in `target` units already.
    """
    found = NUMBER_AND_UNIT.fullmatch(str(text).strip())
    head, unit = found.groups() if found else (text, None)
    try:
        value = float(head)
    except ValueError:
        raise StudyError(f"'{text}' is not a number; write 0.098 or '98 N/m'") from None
    if not math.isfinite(value):
        raise StudyError(f"'{text}' is not a finite number")
    return conversion(unit or target, target).place(value)


def distance(text: str, target: str, what: str, cure: str) -> float:
    """A positive difference in `target` units of a text such as '2 mmHg' or '2'.

    what, cure: for the sentence of the `StudyError` about a text that is none.
    """
    text = text.strip()
    found = NUMBER_AND_UNIT.fullmatch(text)
    if found is None:
        raise StudyError(f"{what} '{text}' is not a number; {cure}")
    value = conversion(found[2] or target, target).distance(float(found[1]))
    if not value > 0.0:
        raise StudyError(f"{what} {text} must be above 0")
    return value


@lru_cache(maxsize=256)
def dimension(unit: str) -> Dimension:
    """Dimension of a unit, such as [length] / [time]; of "" it has none."""
    found: Dimension = _registry().get_dimensionality(_registry().parse_units(unit))
    return found


@lru_cache(maxsize=256)
def base_unit(unit: str) -> str:
    """The unit of the same dimension made of metre, kilogram, second, kelvin ..."""
    return str(_registry().get_base_units(unit)[1]) if unit else ""
