"""What measurements say about inputs, as the command prints it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from surrogate.cli.page import Page
from surrogate.cli.table import Table
from surrogate.errors import StudyError
from surrogate.stages.calibration import figures
from surrogate.stages.stage import Step
from surrogate.study.analysis import walk
from surrogate.study.prediction import told, usable
from surrogate.study.study import Study

HEADS = ("unknown", "posterior mean", "sd", "95 % from", "to", "prior sd", "shrinkage", "ESS")


def calibrate(
    study: Study, results: Path, steps: Callable[[Step], None] = lambda step: None
) -> Page:
    """The posterior from the runs there are; writes posterior.nc and what depends on it.

    Raises `StudyError` when the study asks for no calibration or it cannot be had, and
    `ResultsError` when no runs are stored.
    """
    if study.calibration is None:
        raise StudyError(
            "the study has no calibration; add calibration: {cases: measured.csv, free: [..]}"
        )
    stored, unfound = usable(study, results, None)
    stages = walk(study, results, stored, progress=steps)
    found = stages.value("calibration")
    if found is None:
        raise StudyError(*stages.result("calibration").not_done)
    stages.write()
    data = figures(found) or {}
    return Page(
        {**data, "file": str(results / "posterior.nc")},
        [
            *lines(data),
            *told(stored, unfound),
            f"draws: {results / 'posterior.nc'} (arviz.from_netcdf opens it)",
        ],
    )


def lines(data: Mapping[str, Any]) -> list[str | Table]:
    """A table of the unknowns, the sentence, and what a reader should know."""
    return [_table(data["unknowns"]), "", data["sentence"], *data["notes"]]


def _table(unknowns: Mapping[str, Mapping[str, Any]]) -> Table:
    rows = [
        (
            f"{name} ({row['units'] or '-'})",
            *(f"{row[key]:.5g}" for key in ("mean", "sd", "low", "high", "prior_sd")),
            f"{row['shrinkage']:.2f}",
            f"{min(row['ess_bulk'], row['ess_tail']):.0f}",
        )
        for name, row in unknowns.items()
    ]
    return Table("", list(HEADS), rows)
