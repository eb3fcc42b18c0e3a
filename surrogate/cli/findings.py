"""What came of a study, in a few lines for the terminal."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from surrogate.cli import calibrating
from surrogate.cli.figures import COMPARED, INDICES, figure_tables, validation_tables
from surrogate.cli.outcome import Outcome
from surrogate.cli.page import Page
from surrogate.cli.table import Table
from surrogate.study.study import Study


def page(study: Study, done: Outcome) -> Page:
    """The findings in a few lines, and where the report is."""
    figures = done.summary
    parts: list[str | Table] = []
    for key, titles in (("comparison", COMPARED), ("sensitivity", INDICES)):
        if figures[key]:
            parts += [part for made in figure_tables(figures[key], titles) for part in (made, "")]
    if figures["validation"]:
        parts += [*validation_tables(figures["validation"]), ""]
    if figures["calibration"]:
        parts += [*calibrating.lines(figures["calibration"]), ""]
    if figures["screening"]:
        parts.append(_screening_line(figures["screening"]))
    parts += [f"design {name}: {told}" for name, told in _adaptive(figures["adaptive"])]
    for told in (figures["noise"], figures["suspicious"]):
        parts += [f"{one['sentence']}." for one in told.values()]
    if figures["learning"]:
        parts += _learning_lines(figures["learning"], figures["comparison"])
    for name, goal in (figures["solve"] or {}).items():
        parts.append(f"goal {name} ({goal['goal']}): {goal['sentence']}")
    parts += [f"{name}: {one['sentence']}" for name, one in (figures["reliability"] or {}).items()]
    if figures["failures"]:
        parts.append(figures["failures"]["sentence"])
    parts += [
        f"{output}: standard deviation of the replicates {scatter['std']:.3g}"
        for output, scatter in figures["replicates"].items()
    ]
    parts.append(f"report: {done.report}" + ("" if done.fresh else " (was up to date)"))
    return Page({**figures, "report": str(done.report)}, parts)


def _screening_line(screening: Mapping[str, Any]) -> str:
    if screening["refused"]:
        return f"screening: nothing is frozen. {screening['refused']}"
    frozen = ", ".join(screening["freeze"]) or "nothing"
    return f"screening: keep {', '.join(screening['keep']) or 'nothing'}; may be frozen: {frozen}"


def _adaptive(designs: Mapping[str, Any]) -> list[tuple[str, str]]:
    """How each adaptive design went on, and whether choosing its points paid."""
    return [
        (name, told)
        for name, found in designs.items()
        for told in (found["sentence"], *found["paid"])
    ]


def _learning_lines(learning: Mapping[str, Any], comparison: Mapping[str, Any]) -> list[str]:
    """What the curve of each output's best surrogate says; of the first where it has none."""
    outputs, names = learning["output"]["values"], learning["surrogate"]["values"]
    best = dict(zip(comparison["output"]["values"], comparison["best"]["values"], strict=True))
    lines = []
    for k, output in enumerate(outputs):
        said = [row[k] for row in learning["sentence"]["values"]]
        own = names.index(best[output]) if best[output] in names else 0
        text = said[own] or next(filter(None, said))
        lines += [f"{output}: {sentence}" for sentence in text.splitlines()]
    return lines
