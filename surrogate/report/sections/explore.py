"""The live profiler: predictions, target search and Monte Carlo in the browser."""

from __future__ import annotations

from collections.abc import Iterator

from surrogate.report import digits
from surrogate.report.blocks import Block, Live, Section, Text
from surrogate.report.content import Content
from surrogate.report.profiler.chosen import Chosen, chosen, notes
from surrogate.report.profiler.scene_data import scene_note
from surrogate.report.profiler.widget import widget
from surrogate.report.sections.leading import leading


def sections(content: Content) -> Iterator[Section]:
    """The section, where some output has a surrogate that runs in a browser."""
    shown = chosen(content)
    if not shown:
        return
    blocks: list[Block] = [Text(_sentence(content, shown))]
    blocks += [Text(words, "note") for words in notes(content, shown)]
    if words := scene_note(content):
        blocks.append(Text(words, "note"))
    found = leading(content, shown[0].output)
    live = Live(widget(content, shown, found.names if found else ()))
    yield Section("explore", "Explore", (*blocks, live))


def _sentence(content: Content, shown: list[Chosen]) -> str:
    used = {one.surrogate: None for one in shown}
    names = digits.listing(list(used))
    return (
        f"Predictions of {names}, worked out in this page. Bands are 95{digits.THIN}% prediction "
        "intervals. Move a parameter and every curve follows."
    )
