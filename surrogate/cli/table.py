"""A table for a terminal of any width: text wraps, figures stay whole, columns go into blocks."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from rich.cells import cell_len, chop_cells
from rich.console import Console, ConsoleOptions
from rich.text import Text

#: What a line is not broken in: a word, with what stands in its brackets.
_WORD = re.compile(r"(?:\[[^\]]*\]|[^\s\[])+")
_FIGURE = re.compile(r"[-+]?(\d|nan|inf|$)")
GAP = "  "
#: Columns of text become no narrower than this when they wrap, unless their words are shorter.
NARROW = 24


@dataclass(frozen=True)
class Table:
    """Rows of cells below headings. The first column names the rows: each block repeats it."""

    title: str
    headings: Sequence[str]
    rows: Sequence[Sequence[Any]]

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> Iterator[Text]:
        """For rich: the lines, title and headings marked where the terminal can."""
        for line, style in self.lines(options.max_width):
            yield Text(line, style=style, no_wrap=True, overflow="ignore")

    def lines(self, width: int) -> Iterator[tuple[str, str]]:
        """Every line, at most `width` wide, and its style."""
        columns = [
            _Column.of(heading, [row[j] for row in self.rows])
            for j, heading in enumerate(self.headings)
        ]
        if self.title:
            yield from ((line, "italic") for line in wrapped(self.title, width))
        for number, block in enumerate(_blocks(columns, width)):
            if number:
                yield "", ""
            widths = _widths(block, width)
            heads = [wrapped(column.heading, w) for column, w in zip(block, widths, strict=True)]
            yield from ((line, "bold") for line in _side_by_side(block, heads, widths))
            for k in range(len(self.rows)):
                cells = [wrapped(one.cells[k], w) for one, w in zip(block, widths, strict=True)]
                yield from ((line, "") for line in _side_by_side(block, cells, widths))


@dataclass(frozen=True)
class _Column:
    """A column: figures are not wrapped, text is.

    widest, narrowest  width without wrapping, and least width that reads well
    word               width of its longest word
    """

    heading: str
    cells: Sequence[str]
    numeric: bool
    widest: int
    narrowest: int
    word: int

    @classmethod
    def of(cls, heading: str, values: Sequence[Any]) -> _Column:
        cells = [f"{value:.4g}" if isinstance(value, float) else str(value) for value in values]
        whole = max([cell_len(cell) for cell in cells], default=0)
        word = max([cell_len(word) for cell in cells for word in _WORD.findall(cell)], default=0)
        head = max([cell_len(word) for word in _WORD.findall(heading)], default=0)
        figures = bool(cells) and all(_FIGURE.match(cell) for cell in cells)
        return cls(
            heading,
            cells,
            bool(values) and all(isinstance(value, int | float) for value in values),
            max(whole, cell_len(heading)),
            max(head, whole if figures else max(word, min(whole, NARROW))),
            max(head, word),
        )


def _blocks(columns: Sequence[_Column], width: int) -> Iterator[list[_Column]]:
    """Columns that fit side by side at their narrowest, the first one in every block."""
    first, *others = columns
    block = [first]
    for column in others:
        needed = sum(one.narrowest + len(GAP) for one in block) + column.narrowest
        if needed > width and len(block) > 1:
            yield block
            block = [first]
        block.append(column)
    yield block


def _widths(block: Sequence[_Column], width: int) -> list[int]:
    """A width for each column: the widest that fit, the widest columns giving way first."""
    room = max(width - len(GAP) * (len(block) - 1), len(block))
    widths = [min(column.widest, room) for column in block]
    floors = ([one.narrowest for one in block], [one.word for one in block], [1] * len(block))
    for floor in floors:
        while sum(widths) > room:
            able = [j for j, least in enumerate(floor) if widths[j] > least]
            if not able:
                break
            widths[max(able, key=lambda j: widths[j])] -= 1
    return widths


def _side_by_side(
    block: Sequence[_Column], cells: Sequence[Sequence[str]], widths: Sequence[int]
) -> Iterator[str]:
    for k in range(max(map(len, cells))):
        parts = [cell[k] if k < len(cell) else "" for cell in cells]
        padded = [
            " " * (w - cell_len(part)) + part if one.numeric else part + " " * (w - cell_len(part))
            for one, part, w in zip(block, parts, widths, strict=True)
        ]
        yield GAP.join(padded).rstrip()


def wrapped(text: str, width: int, indent: str = "") -> list[str]:
    """`text` in lines of at most `width`: between words, inside of one only where it must be.

    indent: of the lines after the first.
    """
    if cell_len(text) <= width:
        return [text]
    lead = text[: len(text) - len(text.lstrip())]
    lines, line = [], lead
    for word in _WORD.findall(text):
        joined = f"{line} {word}" if line.strip() else f"{line}{word}"
        if cell_len(joined) <= width:
            line = joined
            continue
        if line.strip():
            lines.append(line)
            line = indent
        *whole, last = _pieces(word, width, cell_len(line))
        for piece in whole:
            lines.append(line + piece)
            line = indent
        line += last
    return [*lines, line]


def _pieces(word: str, width: int, before: int) -> list[str]:
    """A word that may be wider than a line, cut into what fits after an indent of `before`."""
    return chop_cells(word, max(width - before, 1)) if word else [""]
