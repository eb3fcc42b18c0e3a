"""The comparison as a page in the style of the report."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from surrogate.differences.folder import ResultsFolder
from surrogate.differences.part import Part
from surrogate.report import digits
from surrogate.report.blocks import Block, Cell, Fold, Head, Section, Table, Text, anchor
from surrogate.report.page import Page, rendered

#: Rows beyond which the whole table is folded behind those that changed.
MOST = 12


def page(a: ResultsFolder, b: ResultsFolder, parts: Sequence[Part]) -> Page:
    """What changed from A to B."""
    sections = [_sides(a, b), *(_section(part) for part in parts if part.sentences or part.rows)]
    title = a.study if a.study == b.study else f"{a.study} and {b.study}"
    return rendered(sections, f"{title}: what changed", f"{a.folder} and {b.folder}")


def _sides(a: ResultsFolder, b: ResultsFolder) -> Section:
    rows = tuple((Cell(one.name), Cell(one.study), Cell(str(one.folder))) for one in (a, b))
    heads = tuple(Head(words, numeric=False) for words in ("side", "study", "folder"))
    blocks: list[Block] = [Table("The two results folders.", heads, rows)]
    blocks += [Text(words, "warning") for words in (*a.troubles, *b.troubles)]
    return Section("sides", "What is compared", tuple(blocks))


def _section(part: Part) -> Section:
    blocks: list[Block] = [Text(digits.squared(words), "lead") for words in part.sentences]
    changed = part.rows if part.shown is None else part.shown
    if changed:
        blocks.append(
            _table(part, "What differs." if part.shown is not None else part.title, changed)
        )
    if part.shown is not None and len(part.rows) > len(changed):
        whole = _table(part, part.title, part.rows)
        many = len(part.rows) > MOST
        blocks.append(Fold(f"All {len(part.rows)} rows", (whole,)) if many else whole)
    return Section(anchor(part.key), part.title, tuple(blocks))


def _table(part: Part, caption: str, rows: Sequence[Mapping[str, Any]]) -> Table:
    heads = tuple(Head(digits.squared(words), numeric=False) for words in part.columns.values())
    cells = tuple(tuple(map(Cell, row)) for row in part.table(rows))
    return Table(caption, heads, cells, wide=True)
