"""How numbers are written: decimal point or comma, marks between thousands, missing ones."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from typing import Any

MISSING = frozenset(
    ("", "na", "n/a", "nan", "null", "none", "-", "--", "#n/a", "#na", "?", "missing", "nil")
)

_EXPONENT = r"(?:[eEdD][-+]?\d+)?"
_POINT = re.compile(rf"[-+]?(?:\d+\.?\d*|\.\d+){_EXPONENT}")
_POINT_GROUPED = re.compile(rf"[-+]?\d{{1,3}}(?:[, '’]\d{{3}})+(?:\.\d+)?{_EXPONENT}")
_COMMA = re.compile(rf"[-+]?(?:\d+,\d*|,\d+|\d+){_EXPONENT}")
_COMMA_GROUPED = re.compile(rf"[-+]?\d{{1,3}}(?:[. '’]\d{{3}})+(?:,\d+)?{_EXPONENT}")
_EITHER = re.compile(r"[-+]?[1-9]\d{0,2}[.,]\d{3}")
_INFINITE = re.compile(r"[-+]?(?:inf|infinity|1\.#inf)", re.IGNORECASE)


def missing(cell: Any) -> bool:
    """True for an empty cell and for words that stand for one."""
    if cell is None or (isinstance(cell, float) and math.isnan(cell)):
        return True
    return isinstance(cell, str) and cell.strip().lower() in MISSING


def decimal_mark(cells: Iterable[Any], usual: str | None = None) -> str | None:
    """'.' or ',' of texts with numbers; None when a comma in them can be read either way.

    `1,234` may be 1.234 or 1234; a text such as `1,5`, `0,123` or `1.234,5` decides. usual:
    what the rest of the file says, for texts that do not decide.
    """
    texts = [_bare(cell) for cell in cells if isinstance(cell, str)]
    point = [bool(_POINT.fullmatch(t) or _POINT_GROUPED.fullmatch(t)) for t in texts]
    comma = [bool(_COMMA.fullmatch(t) or _COMMA_GROUPED.fullmatch(t)) for t in texts]
    surely_point = sum(a and not b for a, b in zip(point, comma, strict=True))
    surely_comma = sum(b and not a for a, b in zip(point, comma, strict=True))
    if surely_point != surely_comma:
        return "," if surely_comma > surely_point else "."
    unclear = any(_EITHER.fullmatch(t) and "," in t for t in texts)
    return usual or (None if unclear else ".")


def number(cell: Any, decimal: str = ".") -> float | None:
    """The number in a cell; None when it holds something else. Infinite ones count as such."""
    if isinstance(cell, bool):
        return None
    if isinstance(cell, int | float):
        try:
            return float(cell)
        except OverflowError:
            return math.inf
    if not isinstance(cell, str):
        return None
    text = _bare(cell)
    plain, grouped = (_COMMA, _COMMA_GROUPED) if decimal == "," else (_POINT, _POINT_GROUPED)
    if plain.fullmatch(text):
        return _float(text.replace(",", "."))
    if grouped.fullmatch(text):
        bare = re.sub(r"[. '’]" if decimal == "," else r"[, '’]", "", text)
        return _float(bare.replace(",", "."))
    if _INFINITE.fullmatch(text):
        return -math.inf if text.startswith("-") else math.inf
    return None


def _bare(text: str) -> str:
    """Without quotes, with plain minus signs and spaces."""
    return (
        text.strip()
        .strip("\"'")
        .replace("\u2212", "-")
        .replace("\u00a0", " ")
        .replace("\u202f", " ")
    )


def _float(text: str) -> float:
    return float(text.replace("d", "e").replace("D", "e"))
