"""`surrogate compare`: what changed between two results folders."""

from __future__ import annotations

from pathlib import Path

from surrogate.cli.page import Page
from surrogate.cli.table import Table
from surrogate.differences.compare import compare as compared
from surrogate.differences.page import page

NAME = "compare.html"


def compare(a: Path, b: Path, to: Path | None) -> Page:
    """What changed from A to B, printed and written as a page (default: in B)."""
    one, other, parts = compared(a, b)
    written = page(one, other, parts).save(to or b / NAME)
    shown: list[str | Table] = [f"A: {a}", f"B: {b}", *one.troubles, *other.troubles]
    for part in parts:
        if not (part.sentences or part.rows):
            continue
        shown += ["", part.title, *(f"  {words}" for words in part.sentences)]
        rows = part.rows if part.shown is None else part.shown
        if rows and part.columns:
            shown.append(Table("", list(part.columns.values()), part.table(rows)))
    shown += ["", f"page: {written}"]
    data = {
        "a": str(a),
        "b": str(b),
        "troubles": [*one.troubles, *other.troubles],
        **{part.key: part.data for part in parts},
        "page": str(written),
    }
    return Page(data, shown)
