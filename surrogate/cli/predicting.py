"""Predictions at new points, as the command prints them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from surrogate.cli.page import Page
from surrogate.cli.table import Table
from surrogate.stages.stage import Step
from surrogate.study import prediction
from surrogate.study.study import Study


def predict(
    study: Study,
    results: Path,
    surrogate: str | None,
    words: Sequence[str],
    points: Path | None,
    steps: Callable[[Step], None] = lambda step: None,
) -> Page:
    """Values with intervals at points given as words or as a CSV file."""
    found = prediction.predict(study, results, surrogate, words, points, steps=steps)
    parts: list[str | Table] = [found.note] if found.note else []
    rows = []
    for row in found.rows:
        for output, answer in row["outputs"].items():
            unit = study.spec.solver.outputs[output].unit
            value = answer["value"]
            shown = (
                f"{value:.5g} {unit}".strip()
                if np.ndim(value) == 0
                else f"field {np.shape(value)} {unit}: mean {np.mean(value):.5g}"
            )
            low, high = answer["low"], answer["high"]
            interval = f"[{low:.5g}, {high:.5g}]" if np.ndim(low) == 0 else "see --json"
            rows.append(
                (
                    row["point"],
                    output,
                    answer["surrogate"],
                    shown,
                    interval,
                    _place(row),
                )
            )
    parts.append(
        Table(
            "",
            ("point", "output", "surrogate", "value", "95 % interval", "range of the study"),
            rows,
        )
    )
    return Page(found.rows, parts)


def _place(row: Mapping[str, Any]) -> str:
    if not row["inside"]:
        return "OUTSIDE"
    return "inside, but FAR FROM THE ROWS (extrapolated)" if row["extrapolated"] else "inside"
