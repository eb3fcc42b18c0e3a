"""Which parameters matter enough to keep."""

from __future__ import annotations

from surrogate.report.blocks import Section, Text
from surrogate.report.content import Content


def blocks(content: Content, output: str) -> list:
    """Nothing yet."""
    return []


def section(content: Content) -> Section:
    """Placeholder sentence until the decision is drawn."""
    return Section("screening", "Screening", (Text("No screening was asked for.", "note"),))
