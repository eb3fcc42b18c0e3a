"""Numbers as people read them: sensible digits, uncertainty beside the value, units set well."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Sequence
from typing import TypeGuard

import numpy as np
from numpy.typing import ArrayLike

from surrogate.space.units import dimensionless

MINUS = "\N{MINUS SIGN}"
THIN = "\N{NARROW NO-BREAK SPACE}"
NOTHING = "\N{EN DASH}"
FIGURE_SPACE, POINT_SPACE = "\N{FIGURE SPACE}", "\N{PUNCTUATION SPACE}"
#: What is printed: a number, or None where there is none.
Number = float | np.floating | None
_NUMBER = re.compile(rf"({MINUS}?\d(?:[\d{THIN}]*\d)?(?:\.\d+)?)")
_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def figure(value: Number, digits: int = 3) -> str:
    """A number with about `digits` significant digits; an en dash when there is none."""
    if value is None or not np.isfinite(float(value)):
        return _not_finite(value)
    value = float(value)
    if value == 0.0:
        return "0"
    exponent = math.floor(math.log10(abs(value)))
    if not -4 <= exponent < 7:
        return _scientific(value, digits)
    return fixed(value, max(0, digits - 1 - exponent))


def number(value: Number, digits: int = 6) -> str:
    """A number as somebody wrote it: up to `digits` significant digits, no trailing zeros."""
    text = figure(value, digits)
    if "." in text and "×" not in text:
        text = text.rstrip("0").rstrip(".")
    return text


def fixed(value: Number, decimals: int) -> str:
    """A number with this many decimals, thousands set apart and a true minus sign."""
    if value is None or not np.isfinite(float(value)):
        return _not_finite(value)
    text = f"{float(value):,.{decimals}f}"
    if not re.search("[1-9]", text):
        text = text.lstrip("-")
    whole = abs(float(value)) >= 10_000
    return text.replace(",", THIN if whole else "").replace("-", MINUS)


def decimals_of(values: ArrayLike, digits: int = 3) -> int:
    """Decimals with which the spread of these values shows `digits` significant digits."""
    finite = np.asarray(values, dtype=float)
    finite = finite[np.isfinite(finite)]
    if finite.size == 0:
        return 0
    spread = float(np.ptp(finite)) or float(np.abs(finite).max())
    return 0 if spread == 0.0 else int(np.clip(digits - 1 - _exponent(spread), 0, 9))


def column(values: ArrayLike, digits: int = 3) -> list[str]:
    """A column of numbers with the same decimals throughout, so that the points line up."""
    values = np.asarray(values, dtype=float)
    largest = np.abs(values[np.isfinite(values)]).max(initial=0.0)
    if largest >= 1e7 or 0.0 < largest < 1e-4:
        return [figure(value, digits + 1) for value in values]
    decimals = decimals_of(values, digits)
    return [fixed(value, decimals) for value in values]


def aligned(words: Sequence[str]) -> list[str]:
    """A column whose decimal points stand below each other when it is set flush right.

    Words of the same pattern, such as `0.71 (0.69 to 0.73)` or `11.5 ± 0.12`, are padded number
    by number with spaces as wide as the digits and the point that are missing; the last number
    behind its unit. A column of several patterns is left as it is.
    """
    known = [k for k, word in enumerate(words) if word not in ("", NOTHING)]
    split = {k: _NUMBER.split(words[k]) for k in known}
    if len({tuple(parts[::2]) for parts in split.values()}) != 1:
        return list(words)
    result = list(words)
    columns = [_padded(column) for column in zip(*(split[k][1::2] for k in known), strict=True)]
    for row, k in enumerate(known):
        parts = split[k].copy()
        parts[1::2] = [column[row] for column in columns]
        if columns:
            parts[1] = parts[1].lstrip(FIGURE_SPACE)
            number = parts[-2].rstrip(FIGURE_SPACE + POINT_SPACE)
            parts[-2:] = [number, parts[-1], parts[-2][len(number) :]]
        result[k] = "".join(parts)
    return result


def _padded(numbers: Sequence[str]) -> list[str]:
    """Numbers of one width, with their points in one place."""
    whole = max(len(number.partition(".")[0]) for number in numbers)
    decimals = max(len(number.partition(".")[2]) for number in numbers)
    padded = []
    for number in numbers:
        before, point, behind = number.partition(".")
        missing = (POINT_SPACE if decimals and not point else "") + FIGURE_SPACE * (
            decimals - len(behind)
        )
        padded.append(FIGURE_SPACE * (whole - len(before)) + number + missing)
    return padded


def with_half(value: Number, half: Number) -> str:
    """`11.54 ± 0.12`: two significant digits of the half-width decide the decimals."""
    if not _finite(value) or not _finite(half) or half <= 0.0:
        return figure(value)
    if _awkward(max(abs(value), half)):
        return f"{figure(value)} ± {figure(half, 2)}"
    decimals = _interval_decimals(half)
    return f"{fixed(value, decimals)} ± {fixed(half, decimals)}"


def with_interval(value: Number, low: Number, high: Number, *, most: int = 9) -> str:
    """`0.709 (0.690 to 0.731)`, `most` decimals at most; the value alone without an interval."""
    if not (_finite(value) and _finite(low) and _finite(high)):
        return figure(value)
    if _awkward(max(abs(value), abs(low), abs(high))) and most == 9:
        return f"{figure(value)} ({figure(low)} to {figure(high)})"
    decimals = min(most, _interval_decimals((high - low) / 2.0, fallback=decimals_of([value])))
    return f"{fixed(value, decimals)} ({fixed(low, decimals)} to {fixed(high, decimals)})"


def interval(low: Number, high: Number) -> str:
    """`0.690 to 0.731`: digits that show its width, and on which side of zero an end lies."""
    if not (_finite(low) and _finite(high)):
        return NOTHING
    decimals = _interval_decimals((high - low) / 2.0, fallback=decimals_of([low]))
    while decimals < 6 and any(
        end != 0.0 and round(float(end), decimals) == 0.0 for end in (low, high)
    ):
        decimals += 1
    return f"{fixed(low, decimals)} to {fixed(high, decimals)}"


def p_value(p: Number) -> str:
    """A probability: two digits, and no pretence below one in a thousand."""
    if not _finite(p):
        return NOTHING
    return f"<{THIN}0.001" if p < 0.001 else figure(p, 2)


def score(value: Number) -> str:
    """R2 or Q2: three decimals, or as many more as tell it from a perfect 1 (up to six)."""
    if not _finite(value):
        return NOTHING
    decimals = next((d for d in (3, 4, 5) if round(float(value), d) < 1.0), 6)
    return fixed(value, decimals if value < 1.0 - 5e-7 else 3)


def percent(share: Number) -> str:
    """`93.4 %` of a share 0.934; never rounded up to 100 or down to 0."""
    if not _finite(share):
        return NOTHING
    decimals = 0 if abs(share) < 1e-12 or abs(share - 1.0) < 1e-12 else 1
    if decimals and share > 0.9995 and share < 1.0:
        return f"above 99.9{THIN}%"
    if decimals and 0.0 < share < 0.0005:
        return f"below 0.1{THIN}%"
    return f"{fixed(100.0 * share, decimals).removesuffix('.0')}{THIN}%"


def duration(seconds: Number) -> str:
    """Seconds in the unit that people would use: 4.2 ms, 42 s, 3 min 10 s, 2 h 5 min, 1.3 days."""
    if not _finite(seconds):
        return NOTHING
    if 0.0 < seconds < 0.1:
        small, name = (1e6, "µs") if seconds < 1e-3 else (1e3, "ms")
        return f"{figure(small * seconds, 2)}{THIN}{name}"
    if seconds < 100.0:
        return f"{figure(seconds, 2)}{THIN}s"
    whole = round(float(seconds))
    if whole < 3600:
        return f"{whole // 60}{THIN}min {whole % 60}{THIN}s"
    if whole < 48 * 3600:
        return f"{whole // 3600}{THIN}h {whole % 3600 // 60}{THIN}min"
    return f"{fixed(whole / 86400.0, 1)} days"


def unit(text: str) -> str:
    """A unit as it is printed: `mm**2` becomes `mm²`, `kg*m/s^-2` becomes `kg·m/s⁻²`."""
    raised = re.sub(r"\s*(?:\*\*|\^)\s*(-?\d+)", lambda power: power[1].translate(_RAISED), text)
    return raised.replace("*", "·")


def with_unit(text: str, units: str) -> str:
    """A number and its unit, kept on one line; a dimensionless number stands alone."""
    return text if dimensionless(units) else f"{text}{THIN}{unit(units)}"


def setting(value: float | str, units: str = "") -> str:
    """The value of an input: a level by its name, a number to four digits with its unit."""
    return value if isinstance(value, str) else with_unit(number(value, 4), units)


def labelled(name: str, units: str) -> str:
    """An axis label or table head: `tension (N/mm)`, with (-) when dimensionless."""
    printed = NOTHING if dimensionless(units) else unit(units)
    return f"{name} ({printed})"


def squared(sentence: str) -> str:
    """A sentence from a dataset with its Q2 and R2 as the page prints them."""
    return re.sub(r"\b([QR])2\b", r"\1²", sentence)


def capital(words: str) -> str:
    """The words with a capital first letter, for the start of a sentence."""
    return words[:1].upper() + words[1:]


def quantity(count: int, one: str, many: str = "") -> str:
    """`1 run`, `3 runs`."""
    return f"{count} {one if count == 1 else many or one + 's'}"


def listing(words: Iterable[object], most: int = 0) -> str:
    """`a`, `a and b`, `a, b and c`; with `most`, so many words and how many more there are."""
    listed = [str(word) for word in words]
    if most and len(listed) > most + 1:
        listed = [*listed[:most], f"{len(listed) - most} more"]
    return " and ".join([", ".join(listed[:-1]), listed[-1]] if len(listed) > 1 else listed)


def _finite(value: Number) -> TypeGuard[float]:
    return value is not None and bool(np.isfinite(float(value)))


def _awkward(value: float) -> bool:
    """Too large or too small to write out."""
    return value != 0.0 and not -4 <= _exponent(value) < 7


def _exponent(value: float) -> int:
    return math.floor(math.log10(abs(float(value))))


def _interval_decimals(half: float, fallback: int = 3) -> int:
    return int(np.clip(1 - _exponent(half), 0, 9)) if half > 1e-12 else min(fallback, 6)


def _scientific(value: float, digits: int) -> str:
    mantissa, exponent = f"{value:.{digits - 1}e}".split("e")
    return f"{mantissa} × 10{str(int(exponent)).translate(_RAISED)}".replace("-", MINUS)


def _not_finite(value: Number) -> str:
    if value is None or np.isnan(float(value)):
        return NOTHING
    return "∞" if float(value) > 0 else f"{MINUS}∞"
