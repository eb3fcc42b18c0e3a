"""A page for the terminal: text and tables for people, data for `--json`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from rich.console import Console
from rich.table import Table


@dataclass(frozen=True)
class Page:
    """People's text for the terminal, and the same as data for `--json`."""

    data: Any
    parts: Sequence[Any] = field(default=())

    def show(self, console: Console) -> None:
        """Print the text, nothing cut off where lines can wrap."""
        for part in self.parts:
            console.print(part, highlight=False, markup=False, soft_wrap=isinstance(part, str))


def table(title: str, headings: Sequence[str], rows: Sequence[Sequence[Any]]) -> Table:
    """A table with numbers aligned to the right."""
    made = Table(title=title, title_justify="left", box=None, pad_edge=False)
    for j, heading in enumerate(headings):
        numeric = bool(rows) and all(isinstance(row[j], int | float) for row in rows)
        made.add_column(heading, justify="right" if numeric else "left", overflow="fold")
    for row in rows:
        made.add_row(*(f"{cell:.4g}" if isinstance(cell, float) else str(cell) for cell in row))
    return made
