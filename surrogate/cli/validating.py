"""Surrogates and models beside reference cases, as the command prints them."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from surrogate.cli import results
from surrogate.cli.figures import validation_tables
from surrogate.cli.page import Page
from surrogate.stages.stage import Step
from surrogate.stages.summary import figures_of
from surrogate.study.study import Study


def validate(
    study: Study,
    folder: Path,
    cases: Path | None,
    steps: Callable[[Step], None] = lambda step: None,
) -> Page:
    """Figures of agreement, and where the page is."""
    found, page = results.validate(study, folder, cases, steps=steps)
    parts = [*validation_tables(figures_of(found)), "", f"page: {page}"]
    return Page({**figures_of(found), "report": str(page)}, parts)
