"""What measurements say about inputs, as the command prints it."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import xarray as xr

from surrogate.calibration.posterior import Posterior
from surrogate.calibration.verification import points
from surrogate.cli.page import Page
from surrogate.cli.progress import RunsBar, StagesBar
from surrogate.cli.table import Table
from surrogate.errors import StudyError
from surrogate.stages.calibration import figures
from surrogate.stages.verified import CALIBRATION
from surrogate.study import verifying
from surrogate.study.analysis import walk
from surrogate.study.prediction import told, usable
from surrogate.study.study import Study

HEADS = (
    "unknown",
    "posterior mean",
    "sd",
    "95 % from",
    "to",
    "prior sd",
    "shrinkage",
    "R-hat",
    "ESS",
)


def calibrate(
    study: Study, results: Path, *, verify: bool, runs: int | None, workers: int | None, quiet: bool
) -> Page:
    """The posterior from the runs there are; writes posterior.nc and what depends on it.

    verify: run the solver at draws of it. Raises `StudyError` when the study asks for no
    calibration or it cannot be had, and `ResultsError` when no runs are stored.
    """
    if study.calibration is None:
        raise StudyError(
            "the study has no calibration; add calibration: {cases: measured.csv, free: [..]}"
        )
    stored, unfound = usable(study, results, None)
    found = _found(study, results, stored, quiet)
    if verify:
        columns = points(found, runs)
        with RunsBar(study.name, hidden=quiet) as bar:
            study = verifying.verify(
                study, results, CALIBRATION, columns, anew=True, workers=workers, progress=bar
            )
        found = _found(study, results, study.stored(results), quiet)
    data = figures(found) or {}
    return Page(
        {**data, "file": str(results / "posterior.nc")},
        [
            *lines(data),
            *told(stored, unfound),
            f"draws: {results / 'posterior.nc'} (arviz.from_netcdf opens it)",
        ],
    )


def _found(study: Study, results: Path, runs: xr.Dataset, quiet: bool) -> Posterior:
    """The posterior, with what verifying runs say; files that depend on it are written."""
    with StagesBar(study.name, hidden=quiet) as steps:
        stages = walk(study, results, runs, progress=steps)
        found: Posterior | None = stages.value("calibration")
    if found is None:
        raise StudyError(*stages.result("posterior").not_done)
    stages.write()
    return found


def lines(data: Mapping[str, Any]) -> list[str | Table]:
    """A table of the unknowns, the sentences, and what a reader should know."""
    said = filter(None, [data["sentence"], data["convergence"], data["verification"]])
    return [_table(data["unknowns"]), "", *said, *data["notes"]]


def _table(unknowns: Mapping[str, Mapping[str, Any]]) -> Table:
    rows = [
        (
            f"{name} ({row['units'] or '-'})",
            *(f"{row[key]:.5g}" for key in ("mean", "sd", "low", "high", "prior_sd")),
            f"{row['shrinkage']:.2f}",
            f"{row['r_hat']:.3f}",
            f"{min(row['ess_bulk'], row['ess_tail']):.0f}",
        )
        for name, row in unknowns.items()
    ]
    return Table("", list(HEADS), rows)
