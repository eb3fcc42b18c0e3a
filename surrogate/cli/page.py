"""A page for the terminal: text and tables for people, data for `--json`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from rich.console import Console
from rich.text import Text

from surrogate.cli.table import Table, wrapped


@dataclass(frozen=True)
class Page:
    """People's text for the terminal, and the same as data for `--json`."""

    data: Any
    parts: Sequence[str | Table] = field(default=())

    def show(self, console: Console) -> None:
        """Print the text, no line wider than the terminal; 80 columns where there is none."""
        for part in self.parts:
            if isinstance(part, str):
                _print(console, part)
            else:
                console.print(part, highlight=False, markup=False)


def say(text: object) -> None:
    """A sentence for people beside the output, on the error stream."""
    _print(Console(stderr=True), str(text))


def _print(console: Console, text: str) -> None:
    for paragraph in text.split("\n"):
        lead = paragraph[: len(paragraph) - len(paragraph.lstrip())]
        for line in wrapped(paragraph, console.width, f"{lead}  " if lead else ""):
            console.print(Text(line), no_wrap=True, overflow="ignore", crop=False)
