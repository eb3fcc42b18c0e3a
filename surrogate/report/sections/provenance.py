"""Provenance: study file, solver, packages, seeds, times."""

from __future__ import annotations

import json

import numpy as np

from surrogate.report import digits
from surrogate.report.blocks import Block, Cell, Fold, Head, Listing, Section, Table, Text
from surrogate.report.content import Content


def section(content: Content) -> Section:
    """Attributes of the runs as a table; the study file as it was run."""
    rows = [(Cell("study"), Cell(content.name)), *_cost(content)]
    for key, value in content.runs.attrs.items():
        if key != "study":
            rows.append((Cell(str(key).replace("_", " ")), Cell(_words(value))))
    blocks: list[Block] = [
        Table(
            "Solver, versions and seeds behind these numbers.",
            (Head("what", numeric=False), Head("value", numeric=False)),
            tuple(rows),
        )
    ]
    study = str(content.runs.attrs.get("study", ""))
    if study:
        blocks.append(Fold("Study file", (Listing(study),)))
    blocks.append(Text("The same study with the same seeds gives the same numbers."))
    return Section("provenance", "Provenance", tuple(blocks))


def _cost(content: Content) -> list[tuple[Cell, ...]]:
    if not np.isfinite(content.seconds).any():
        return []
    own = ~content.repeated
    return [
        (
            Cell("cost of the runs"),
            Cell(
                f"{digits.duration(np.nansum(content.seconds[own]))} of solver time in "
                f"{digits.quantity(int(own.sum()), 'run')}"
            ),
        )
    ]


def _words(value: object) -> str:
    """An attribute as words; JSON objects become `name value` pairs."""
    text = str(value)
    try:
        found = json.loads(text)
    except ValueError:
        return text
    if isinstance(found, dict):
        return ", ".join(f"{key} {item}" for key, item in found.items()) or digits.NOTHING
    return text
