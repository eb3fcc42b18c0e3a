"""Units by pint: the straight line from one unit to another."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from functools import lru_cache

import pint
from pint.util import UnitsContainer

from surrogate.errors import StudyError

NUMBER_AND_UNIT = re.compile(
    r"([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)(?:(?:\s+|(?=[^\W\d_]|[°%]))(\S.*))?"
)
_REGISTRY: pint.UnitRegistry[float] = pint.UnitRegistry(autoconvert_offset_to_baseunit=True)

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


@dataclass(frozen=True)
class Conversion:
    """y = slope * x + offset, from one unit to another."""

    slope: float
    offset: float

    def place(self, x: float) -> float:
        """A value on the scale, such as a temperature."""
        return self.slope * x + self.offset if self.offset else self.slope * x

    def distance(self, x: float) -> float:
        """A difference of values, such as a standard deviation."""
        return self.slope * x


IDENTITY = Conversion(1.0, 0.0)


def known(unit: str) -> bool:
    """True when pint can read `unit`."""
    if len(unit) > _LONGEST_UNIT or not _UNIT.fullmatch(unit):
        return False
    try:
        _REGISTRY.parse_units(unit)
    except (
        pint.errors.PintError,
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
    for name in (unit, target):
        if not known(name):
            shown = name if len(name) <= _LONGEST_UNIT else f"{name[:_LONGEST_UNIT]}..."
            raise StudyError(f"unit '{shown}' is unknown; write it as 'mm', 'N/mm', 'kPa' ...")
    try:
        zero = _REGISTRY.Quantity(0.0, unit).to(target).magnitude
        one = _REGISTRY.Quantity(1.0, unit).to(target).magnitude
    except (pint.errors.PintError, ArithmeticError):
        raise StudyError(f"unit '{unit}' does not convert to {_named(target)}") from None
    return Conversion(one - zero, zero)


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


#: Powers of length, mass, time ...: what `dimension` gives; supports *, / and **.
Dimension = UnitsContainer


@lru_cache(maxsize=256)
def dimension(unit: str) -> Dimension:
    """Dimension of a unit, such as [length] / [time]; of "" it has none."""
    found: Dimension = _REGISTRY.get_dimensionality(_REGISTRY.parse_units(unit))
    return found


@lru_cache(maxsize=256)
def base_unit(unit: str) -> str:
    """The unit of the same dimension made of metre, kilogram, second, kelvin ..."""
    return str(_REGISTRY.get_base_units(unit)[1]) if unit else ""
