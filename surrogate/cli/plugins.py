"""The page of `surrogate list`; apart from the others, because it needs next to nothing."""

from __future__ import annotations

from surrogate.cli.page import Page
from surrogate.cli.table import Table
from surrogate.study.catalogue import catalogue


def plugins() -> Page:
    """Every installed plug-in with the first line of its documentation."""
    data = catalogue()
    parts = [Table(kind, ("name", "what it is"), list(rows.items())) for kind, rows in data.items()]
    return Page(data, [part for made in parts for part in (made, "")])
