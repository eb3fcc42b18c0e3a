"""What a dossier of credibility is made of: statements, and figures that can be made again."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from surrogate.report import digits
from surrogate.report.blocks import Block, Cell, Points, Section, Table, Text, heads


@dataclass(frozen=True)
class Evidence:
    """A claim with its figure: the command that makes it again, and the place where it lies."""

    claim: str
    result: str = ""
    command: str = ""
    place: str = ""


@dataclass(frozen=True)
class Chapter:
    """What is known under one heading.

    asks        what a reviewer looks for here
    statements  in words of the study's authors, or of the study itself
    evidence    figures
    findings    what a reviewer should not overlook
    missing     what is not told anywhere, with the words of the study file that would tell it
    """

    anchor: str
    title: str
    asks: str
    statements: Sequence[str] = ()
    evidence: Sequence[Evidence] = ()
    findings: Sequence[str] = ()
    missing: Sequence[str] = ()

    def section(self) -> Section:
        """As a section of a page."""
        return Section(self.anchor, self.title, tuple(self._blocks()))

    def _blocks(self) -> Iterator[Block]:
        yield Text(self.asks, "note")
        yield from (Text(words) for words in self.statements)
        if self.missing:
            yield Points(tuple(f"MISSING: {words}" for words in self.missing), "warning")
        if self.findings:
            yield Points(tuple(self.findings))
        for command, evidence in self._by_command.items():
            yield Table(
                f"Made again by: {command}" if command else "Stated in the study file.",
                heads("claim", "result", "place", names=3),
                tuple(
                    tuple(Cell(words or digits.NOTHING) for words in _row(one)) for one in evidence
                ),
            )

    @property
    def _by_command(self) -> dict[str, list[Evidence]]:
        """The evidence of each command, in order."""
        found: dict[str, list[Evidence]] = {}
        for one in self.evidence:
            found.setdefault(one.command, []).append(one)
        return found

    def markdown(self) -> str:
        """As a chapter in Markdown."""
        parts = [f"## {self.title}", f"*{self.asks}*", *self.statements]
        if self.missing:
            parts.append("\n".join(f"- **MISSING:** {words}" for words in self.missing))
        if self.findings:
            parts.append("\n".join(f"- {words}" for words in self.findings))
        for command, evidence in self._by_command.items():
            parts.append(f"`{command}`" if command else "Stated in the study file.")
            rows = [("claim", "result", "place"), ("---",) * 3, *map(_row, evidence)]
            parts.append("\n".join(f"| {' | '.join(map(_cell, row))} |" for row in rows))
        return "\n\n".join(parts)


def _row(one: Evidence) -> tuple[str, str, str]:
    return one.claim, one.result, one.place


def _cell(words: str) -> str:
    return words.replace("|", "\\|").replace("\n", " ")


@dataclass(frozen=True)
class Figures:
    """The figures of summary.json, each with its place."""

    summary: Mapping[str, Any]

    def names(self, part: str, dimension: str) -> list[str]:
        """Names along a dimension of a part; none where the part is not there."""
        found = self.summary.get(part) or {}
        return [str(name) for name in found.get(dimension, {}).get("values", ())]

    def at(self, part: str, key: str, *index: int) -> tuple[float | None, str]:
        """A number of a table, and where it lies; None for one that is not there."""
        place = f"summary.json: {part}.{key}.values" + "".join(f"[{k}]" for k in index)
        found = (self.summary.get(part) or {}).get(key, {}).get("values")
        for k in index:
            found = None if found is None else found[k]
        return found, place
