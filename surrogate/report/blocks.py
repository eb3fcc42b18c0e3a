"""What a section of the page is made of: sentences, tables, figures and folded parts.

Plain text everywhere; the template escapes it. Only the marks of plots are markup.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

from markupsafe import Markup

from surrogate.report import digits
from surrogate.report.plot import Plot


@dataclass(frozen=True)
class Text:
    """A paragraph; `tone` is plain, note, warning, good or lead."""

    words: str
    tone: str = "plain"
    kind: str = field(default="text", init=False)


@dataclass(frozen=True)
class Points:
    """A list of sentences."""

    items: tuple[str, ...]
    tone: str = "plain"
    kind: str = field(default="points", init=False)


@dataclass(frozen=True)
class Cell:
    """A table cell: what is printed, the value it sorts by, and how it looks."""

    words: str
    sort: float | str | None = None
    tone: str = ""


@dataclass(frozen=True)
class Head:
    """A column's head; `numeric` columns are set flush right."""

    words: str
    numeric: bool = True
    hint: str = ""


@dataclass(frozen=True)
class Table:
    """Heads and rows of cells; the first column names the row."""

    caption: str
    heads: tuple[Head, ...]
    rows: tuple[tuple[Cell, ...], ...]
    sortable: bool = False
    wide: bool = False
    kind: str = field(default="table", init=False)

    @property
    def aligned(self) -> list[tuple[str, ...]]:
        """The words of the rows; in columns of plain numbers the decimal points line up."""
        columns = [
            digits.aligned([row[k].words for row in self.rows])
            if head.numeric
            else [row[k].words for row in self.rows]
            for k, head in enumerate(self.heads)
        ]
        return list(zip(*columns, strict=True))


@dataclass(frozen=True)
class Figure:
    """A plot, the sentence under it, and the question above it that it answers."""

    plot: Plot
    caption: str
    question: str = ""
    wide: bool = False
    stamp: str = ""


@dataclass(frozen=True)
class Figures:
    """Drawings that stand side by side where there is room."""

    items: tuple[Figure, ...]
    small: bool = False
    kind: str = field(default="figures", init=False)


@dataclass(frozen=True)
class Fold:
    """Blocks behind a title that opens them; print shows them open."""

    title: str
    blocks: tuple[Block, ...]
    open: bool = False
    kind: str = field(default="fold", init=False)


@dataclass(frozen=True)
class Listing:
    """Text as it was written, such as a study file."""

    words: str
    kind: str = field(default="listing", init=False)


@dataclass(frozen=True)
class Verdict:
    """What the study says of one output: a row of the first table, a sentence, three figures.

    surrogate  the best one
    q2, error  as printed; `poor` when the predictions are rough
    matters    the leading inputs in words
    shares     sizes of the inputs' indices in the order of the study, largest 1
    sentence   the answer, without the name of the output, which stands before it
    meaning    what the output is
    """

    output: str
    anchor: str
    sentence: str
    meaning: str = ""
    surrogate: str = ""
    q2: str = ""
    error: str = ""
    poor: bool = False
    matters: str = ""
    shares: tuple[tuple[str, float], ...] = ()
    figures: tuple[Figure, ...] = ()


@dataclass(frozen=True)
class Answer:
    """The verdicts of all outputs, of which one is looked at."""

    verdicts: tuple[Verdict, ...]
    kind: str = field(default="answer", init=False)


@dataclass(frozen=True)
class Heading:
    """A heading inside a section, reachable from the contents."""

    words: str
    anchor: str
    kind: str = field(default="heading", init=False)


@dataclass(frozen=True)
class Live:
    """A part that a script of its own draws."""

    markup: Markup
    kind: str = field(default="live", init=False)


#: What stands in a section; the template draws each by its `kind`.
Block = Text | Points | Table | Figures | Fold | Listing | Answer | Heading | Live


@dataclass(frozen=True)
class Section:
    """A titled part of the page."""

    anchor: str
    title: str
    blocks: tuple[Block, ...]

    @property
    def headings(self) -> list[Heading]:
        """The headings inside, for the contents."""
        return [block for block in self.blocks if isinstance(block, Heading)]


def heads(*words: str, names: int = 1) -> tuple[Head, ...]:
    """Column heads of which the first `names` hold words and the others numbers."""
    return tuple(Head(word, numeric=k >= names) for k, word in enumerate(words))


def cells(words: Iterable[str], values: Sequence[float | str | None] | None = None) -> list[Cell]:
    """A column of cells, sorted by `values` when given."""
    words = list(words)
    values = [None] * len(words) if values is None else values
    return [
        Cell(word, value if isinstance(value, str) or value is None else float(value))
        for word, value in zip(words, values, strict=True)
    ]


def anchor(*words: str) -> str:
    """A fragment name made of these words; different names stay different."""
    return "".join(
        letter if letter.isalnum() or letter == "_" else f"-{ord(letter)}-"
        for letter in "|".join(words)
    ).replace("-124-", "-")
