"""How objects show themselves: a few facts and small tables, as text and in a notebook."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from html import escape
from typing import Any

#: Rows of a table that are shown.
MOST = 40
#: Readable on light and dark pages: no colour of its own, faint lines in that of the text.
_STYLE = """\
<style>.surrogate-card{font:13px/1.45 system-ui,sans-serif}
.surrogate-card table{border-collapse:collapse;margin:.4em 0;background:none}
.surrogate-card caption{text-align:left;font-weight:600}
.surrogate-card :is(th,td){text-align:left;padding:.1em .9em .1em 0;
border-bottom:1px solid rgba(128,128,128,.35);color:inherit;background:none}</style>"""


@dataclass(frozen=True)
class Rows:
    """A small table."""

    title: str
    headings: Sequence[str]
    rows: Sequence[Sequence[Any]]


@dataclass(frozen=True)
class Card:
    """What is worth knowing of an object at a glance.

    kind, name  what it is, and what it is called
    facts       word -> value; empty values are left out
    tables      shown in a notebook only
    """

    kind: str
    name: str
    facts: Mapping[str, Any]
    tables: Sequence[Rows] = field(default=())

    def line(self) -> str:
        """All facts in one line."""
        told = ", ".join(f"{word} {_shown(value)}" for word, value in self._known.items())
        return f"<{self.kind} {self.name}: {told}>"

    def text(self) -> str:
        """A line for each fact."""
        told = [f"  {word}: {_shown(value)}" for word, value in self._known.items()]
        return "\n".join([f"<{self.kind} {self.name}>", *told])

    def html(self) -> str:
        """A fragment of HTML, complete in itself."""
        facts = "".join(
            f"<tr><th>{escape(word)}</th><td>{escape(_shown(value))}</td></tr>"
            for word, value in self._known.items()
        )
        tables = "".join(_table(table) for table in self.tables if table.rows)
        return (
            f'{_STYLE}<div class="surrogate-card"><b>{escape(self.kind)} {escape(self.name)}</b>'
            f"<table>{facts}</table>{tables}</div>"
        )

    @property
    def _known(self) -> dict[str, Any]:
        return {word: value for word, value in self.facts.items() if value not in ("", None)}


class Carded(ABC):
    """Shows its `_card`: one line in Python, a card in a notebook."""

    @property
    @abstractmethod
    def _card(self) -> Card: ...

    def __repr__(self) -> str:
        return self._card.line()

    def _repr_html_(self) -> str:
        return self._card.html()


def _table(table: Rows) -> str:
    head = "".join(f"<th>{escape(heading)}</th>" for heading in table.headings)
    body = "".join(
        "<tr>" + "".join(f"<td>{escape(_shown(cell))}</td>" for cell in row) + "</tr>"
        for row in table.rows[:MOST]
    )
    more = len(table.rows) - MOST
    rest = f'<tr><td colspan="{len(table.headings)}">and {more} more</td></tr>' * (more > 0)
    caption = f"<caption>{escape(table.title)}</caption>"
    return f"<table>{caption}<tr>{head}</tr>{body}{rest}</table>"


def _shown(value: Any) -> str:
    if isinstance(value, float):
        return f"{value:.4g}"
    return str(value)
