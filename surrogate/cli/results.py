"""What lies in results/<study>/, and the whole way from a study to its report.

journal/              every finished run, as it finishes
designs/              points of designs that were searched for
runs.nc               the runs dataset
comparison.nc, sensitivity.nc, regression.nc, learning.nc, validation.nc
surrogates/*.json     surrogates that evaluate without this package
summary.json          the figures of the report, for scripts
study.yaml            the study as run
study_reduced.yaml    the study without the parameters that may be frozen
report.html           opens offline
kept/                 results of stages, so that they need not be done again

What is written after the runs stands in `surrogate.stages.table`.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import xarray as xr

from surrogate.cli.meanwhile import loading
from surrogate.cli.outcome import Outcome
from surrogate.errors import ResultsError, StudyError
from surrogate.execution.progress import Progress
from surrogate.runs import dataset as rundata
from surrogate.runs import stored as storing
from surrogate.stages import kept
from surrogate.stages.stage import Step
from surrogate.stages.table import SUMMARY
from surrogate.study.analysis import walk
from surrogate.study.study import Study

RUNS = "runs.nc"


def folder_of(study: Study, results: Path | None) -> Path:
    """The study's own folder below `results` (default: results/ in the current folder)."""
    return study.folder if results is None else results / study.name


def do_runs(
    study: Study,
    folder: Path,
    *,
    workers: int | None = None,
    retry_failed: bool | tuple[str, ...] = False,
    fresh: bool = False,
    progress: Callable[[Progress], None] | None = None,
    tell: Callable[[str], None] = lambda sentence: None,
) -> xr.Dataset:
    """Do the missing runs; returns the runs dataset.

    fresh: all of them again, and of what follows from them nothing is taken over either.
    The missing runs of a study that gives the cases of validation are done too.
    Raises KeyboardInterrupt when stopped; all finished runs are kept.
    """
    try:
        with loading(progress) as told:
            runs = study.run(
                workers=workers,
                results=folder,
                retry_failed=retry_failed,
                fresh=fresh,
                progress=told,
                tell=tell,
            )
        reference = study.validation.reference if study.validation else None
        if reference is not None:
            reference.run(
                workers=workers, results=study.beside(reference, folder), progress=progress
            )
        if fresh:
            kept.forget_all(folder)
    except KeyboardInterrupt:
        rundata.save(study.stored(folder), folder / RUNS)
        raise
    return runs


def analyse(
    study: Study,
    folder: Path,
    runs: xr.Dataset | None = None,
    *,
    again: bool = False,
    workers: int | None = None,
    steps: Callable[[Step], None] = lambda step: None,
) -> Outcome:
    """Everything that follows from the runs: fits, tables, indices, decision, report.

    runs: default, what the journal and stored files hold. Only what is out of date, missing
    or damaged is made; `again`: the report in any case. Raises `ResultsError` when nothing
    was run, KeyboardInterrupt when stopped; all finished stages are kept.
    """
    runs = study.stored(folder) if runs is None else runs
    if (runs["status"] == "missing").all():
        raise ResultsError(_no_runs(study, folder))
    stages = walk(study, folder, runs, workers=workers, progress=steps)
    try:
        fresh = stages.write(again=["report"] if again else [])
    except KeyboardInterrupt:
        raise KeyboardInterrupt(
            f"{study.name}: stopped; all runs and finished fits are kept, run again to go on"
        ) from None
    summary = json.loads((folder / SUMMARY).read_text(encoding="utf-8"))
    return Outcome(folder, summary, _trouble(runs, summary["not_done"]), fresh)


def store(study: Study, folder: Path, to: Path | None = None) -> tuple[Path, xr.Dataset]:
    """Write the finished runs into a file that ships with the study; returns it and all runs.

    to: default runs/<study>.nc beside the study file. Raises `ResultsError` when no run is
    finished.
    """
    runs = study.stored(folder)
    path = to or study.place / "runs" / f"{study.name}.nc"
    storing.write(runs, path)
    return path, runs


def validate(
    study: Study,
    folder: Path,
    cases: Path | None = None,
    *,
    steps: Callable[[Step], None] = lambda step: None,
) -> tuple[xr.Dataset, Path]:
    """Set the stored runs' surrogates beside cases; returns the figures and their page's path.

    cases: a file; default the study's own. The dataset is written beside the page, both named
    after the file when it is given. Raises `StudyError` when there are no cases and
    `ResultsError` when there is nothing to set beside them.
    """
    if cases is None and study.validation is None:
        raise StudyError(
            "the study has no validation: and no cases are given; add "
            "validation: {cases: FILE.csv} or give --cases FILE"
        )
    runs = study.stored(folder)
    fits = walk(study, folder, runs, progress=steps).result("fits")
    table = study.validate(fits.value, cases, results=folder)
    lost = [*study.to_find(folder), *fits.not_done]
    assert table is not None  # there are cases
    if not table.sizes["model"]:
        raise ResultsError(_nothing_beside(study, table, runs, folder, lost))
    table.attrs["notes"] = "\n".join(filter(None, [table.attrs["notes"], *lost]))
    name = "validation" if cases is None else f"validation_{cases.stem}"
    rundata.save(table, folder / f"{name}.nc")
    return table, study.validation_page(runs, table).save(folder / f"{name}.html")


def _no_runs(study: Study, folder: Path) -> str:
    first = (
        "tell some answers (Python: surrogate.Campaign)"
        if study.spec.told
        else "do `surrogate run`"
    )
    return f"{folder} holds no runs of this study; {first} first"


def _nothing_beside(
    study: Study, table: xr.Dataset, runs: xr.Dataset, folder: Path, lost: list[str]
) -> str:
    """Why nothing stands beside the cases."""
    if not table["inside"].any():
        return f"every case lies outside of the parameters' ranges: {table['outside'].values[0]}"
    if (runs["status"] == "missing").all():
        return _no_runs(study, folder)
    return "\n".join(["there is no surrogate or model to set beside the cases", *lost])


def _trouble(runs: xr.Dataset, not_done: list[str]) -> str:
    counts = rundata.counts(runs)
    words = {"failed": "failed", "timed_out": "timed out", "missing": "not done yet"}
    found = [f"{counts[key]} {word}" for key, word in words.items() if counts[key]]
    sentences = (
        [f"of {runs.sizes['run']} runs: {', '.join(found)}; `surrogate status` says why"]
        if found
        else []
    )
    return "\n".join([*sentences, *not_done])
