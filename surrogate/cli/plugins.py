"""The page of `surrogate list`; apart from the others, because it needs next to nothing."""

from __future__ import annotations

from importlib.metadata import EntryPoint

from surrogate.cli.page import Page
from surrogate.cli.table import Table
from surrogate.study.catalogue import catalogue, summary
from surrogate.study.plugins import DESIGNS

#: The design that is no plug-in, because its points follow from answers.
ADAPTIVE = EntryPoint("adaptive", "surrogate.study.parts.adaptive:AdaptivePart", DESIGNS)


def plugins() -> Page:
    """Every installed plug-in with the first line of its documentation, and adaptive designs."""
    data = catalogue()
    data["designs"][ADAPTIVE.name] = summary(ADAPTIVE)
    parts = [Table(kind, ("name", "what it is"), list(rows.items())) for kind, rows in data.items()]
    return Page(data, [part for made in parts for part in (made, "")])
