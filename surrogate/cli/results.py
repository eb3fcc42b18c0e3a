"""What lies in results/<study>/, and the whole way from a study to its report.

journal/              every finished run, as it finishes
designs/              points of designs that were searched for
runs.nc               the runs dataset
comparison.nc, sensitivity.nc, regression.nc, validation.nc
surrogates/*.json     surrogates that evaluate without this package
summary.json          the figures of the report, for scripts
study.yaml            the study as run
study_reduced.yaml    the study without the parameters that may be frozen
report.html           opens offline
"""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from surrogate.errors import FitError, ResultsError, StudyError, SurrogateError
from surrogate.execution.execute import Progress
from surrogate.runs import dataset as rundata
from surrogate.runs import stored as storing
from surrogate.runs.assembly import versions
from surrogate.runs.files import write_text
from surrogate.study.reduction import reduced_text
from surrogate.study.study import Fits, Study
from surrogate.validation.cases import Cases

REPORT, SUMMARY, RUNS = "report.html", "summary.json", "runs.nc"
#: Datasets that follow from the runs: those that a study does not ask for are not there.
DERIVED = ("comparison", "sensitivity", "regression", "validation")


@dataclass(frozen=True)
class Outcome:
    """What came of a study.

    folder   where everything lies
    summary  the content of summary.json
    trouble  a sentence when something failed, else ""
    fresh    False when all was up to date already
    """

    folder: Path
    summary: Mapping[str, Any]
    trouble: str
    fresh: bool = True

    @property
    def report(self) -> Path:
        """The report's path."""
        return self.folder / REPORT


def folder_of(study: Study, results: Path | None) -> Path:
    """The study's own folder below `results` (default: results/ in the current folder)."""
    return study.folder if results is None else results / study.name


def complete(
    study: Study,
    folder: Path,
    *,
    workers: int | None = None,
    retry_failed: bool = False,
    fresh: bool = False,
    progress: Callable[[Progress], None] | None = None,
) -> Outcome:
    """Do the missing runs (`fresh`: all of them again), then everything that follows from them.

    The missing runs of a study that gives the cases of validation are done too.
    Raises KeyboardInterrupt when stopped; all finished runs are kept.
    """
    try:
        runs = study.run(
            workers=workers,
            results=folder,
            retry_failed=retry_failed,
            fresh=fresh,
            progress=progress,
        )
        reference = study.validation and study.validation.reference
        if reference is not None:
            reference.run(
                workers=workers, results=study.beside(reference, folder), progress=progress
            )
    except KeyboardInterrupt:
        rundata.save(study.stored(folder), folder / RUNS)
        raise
    return analyse(study, folder, runs)


def analyse(
    study: Study, folder: Path, runs: xr.Dataset | None = None, *, again: bool = False
) -> Outcome:
    """Everything that follows from the runs: fits, tables, indices, decision, report.

    runs: default, what the journal and stored files hold. Nothing is done when all files are
    up to date, unless `again`. Raises `ResultsError` when nothing was run.
    """
    runs = study.stored(folder) if runs is None else runs
    if (runs["status"] == "missing").all():
        raise ResultsError(f"{folder} holds no runs of this study; do `surrogate run` first")
    stamp = _stamp(study, runs, _cases(study, folder)[0])
    known = _read_summary(folder)
    if not again and known.get("stamp") == stamp and (folder / REPORT).exists():
        return Outcome(folder, known, _trouble(runs, known["not_done"]), fresh=False)
    return _write(study, folder, runs, stamp)


def store(study: Study, folder: Path, to: Path | None = None) -> tuple[Path, xr.Dataset]:
    """Write the finished runs into a file that ships with the study; returns it and all runs.

    to: default runs/<study>.nc beside the study file. Raises `ResultsError` when no run is
    finished.
    """
    runs = study.stored(folder)
    path = to or study.place / "runs" / f"{study.name}.nc"
    storing.write(runs, path)
    return path, runs


def validate(study: Study, folder: Path, cases: Path | None = None) -> tuple[xr.Dataset, Path]:
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
    fits = study.fit(runs)
    table = study.validate(fits, cases, results=folder)
    lost = study.unfitted(runs, fits)
    if not table.sizes["model"]:
        raise ResultsError(_nothing_beside(table, runs, folder, lost))
    table.attrs["notes"] = "\n".join(filter(None, [table.attrs["notes"], *lost]))
    name = "validation" if cases is None else f"validation_{cases.stem}"
    rundata.save(table, folder / f"{name}.nc")
    return table, study.validation_page(runs, table).save(folder / f"{name}.html")


def _nothing_beside(table: xr.Dataset, runs: xr.Dataset, folder: Path, lost: list[str]) -> str:
    """Why nothing stands beside the cases."""
    if not table["inside"].any():
        return f"every case lies outside of the parameters' ranges: {table['outside'].values[0]}"
    if (runs["status"] == "missing").all():
        return f"{folder} holds no runs of this study; do `surrogate run` first"
    return "\n".join(["there is no surrogate or model to set beside the cases", *lost])


def _write(study: Study, folder: Path, runs: xr.Dataset, stamp: str) -> Outcome:
    fits = study.fit(runs)
    table = study.compare(fits, runs)
    regressions = study.regressions(fits)
    indices, unmeasured = _indices(study, fits, runs, table)
    screening = study.screening(fits, table, indices)
    reduced = reduced_text(study, screening) if screening is not None else ""
    cases, trouble = _cases(study, folder)
    validation = study.validate(fits, cases) if cases is not None else None
    not_done = study.unfitted(runs, fits) + unmeasured + trouble
    for outdated in (
        folder / SUMMARY,
        *(folder / f"{name}.nc" for name in DERIVED),
        folder / "study_reduced.yaml",
        *(folder / "surrogates").glob("*.json"),
    ):
        outdated.unlink(missing_ok=True)
    rundata.save(runs, folder / RUNS)
    for name, dataset in zip(
        DERIVED, (table, indices, _tree(regressions), validation), strict=True
    ):
        if dataset is not None:
            rundata.save(dataset, folder / f"{name}.nc")
    _save_portable(fits, folder / "surrogates")
    write_text(folder / "study.yaml", study.text)
    if reduced:
        write_text(folder / "study_reduced.yaml", reduced)
    study.report(
        runs,
        fits,
        table,
        indices,
        screening=screening,
        validation=validation,
        reduced=reduced,
        not_done=not_done,
    ).save(folder / REPORT)
    summary = {
        "study": study.name,
        "stamp": stamp,
        "runs": rundata.counts(runs),
        "stored": rundata.described(runs, "stored"),
        "comparison": figures_of(table),
        "sensitivity": figures_of(indices),
        "regression": {
            name: {output: figures_of(one) for output, one in by.items()}
            for name, by in regressions.items()
        },
        "screening": json_data(screening.summary()) if screening else None,
        "validation": figures_of(validation),
        "not_done": not_done,
    }
    write_text(folder / SUMMARY, json.dumps(summary, indent=1, allow_nan=False))
    return Outcome(folder, summary, _trouble(runs, not_done))


def _cases(study: Study, folder: Path) -> tuple[Cases | None, list[str]]:
    """The cases of validation, or why there are none."""
    try:
        return study.cases(results=folder), []
    except StudyError as error:
        return None, [f"validation: {sentence}" for sentence in error.mistakes]


def _stamp(study: Study, runs: xr.Dataset, cases: Cases | None) -> str:
    """Digest of all that the derived files depend on."""
    digest = hashlib.sha256(study.text.encode())
    if cases is not None:
        digest.update(
            repr(
                [(name, column.tolist()) for name, column in cases.columns.items()] + [cases.labels]
            ).encode()
        )
    models = study.validation.models if study.validation else {}
    digest.update(
        json.dumps(
            [versions(), {name: spec.context for name, spec in models.items()}],
            sort_keys=True,
        ).encode()
    )
    for name in sorted(map(str, runs.data_vars)):
        values = runs[name].values
        digest.update(
            np.ascontiguousarray(
                values if values.dtype.kind in "fiuM" else values.astype("U")
            ).tobytes()
        )
    return digest.hexdigest()[:16]


def _read_summary(folder: Path) -> dict[str, Any]:
    with suppress(OSError, ValueError):
        found = json.loads((folder / SUMMARY).read_text(encoding="utf-8"))
        return found if isinstance(found, dict) else {}
    return {}


def _indices(
    study: Study, fits: Fits, runs: xr.Dataset, table: xr.Dataset | None
) -> tuple[xr.Dataset | None, list[str]]:
    """Sensitivity indices, or why there are none: the rest of the report stands without them."""
    try:
        return study.sensitivity(fits, runs, table), []
    except SurrogateError as error:
        return None, [f"no sensitivity indices: {error}"]


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


def _tree(regressions: Mapping[str, Mapping[str, xr.Dataset]]) -> xr.DataTree | None:
    """A group per surrogate; with several outputs, a group per output inside it."""
    groups = {
        f"/{name}" if len(by) == 1 else f"/{name}/{output}": table
        for name, by in regressions.items()
        for output, table in by.items()
    }
    return xr.DataTree.from_dict(groups) if groups else None


def _save_portable(fits: Fits, folder: Path) -> None:
    for name, by_output in fits.items():
        described = {}
        for output, fit in by_output.items():
            with suppress(FitError):  # a regressor without a portable form
                described[output] = fit.portable()
        if described:
            write_text(folder / f"{name}.json", json.dumps(described, allow_nan=False))


def figures_of(dataset: xr.Dataset | None) -> dict[str, Any] | None:
    """A dataset's numbers as JSON data."""
    if dataset is None:
        return None
    return {
        "attributes": {str(k): json_data(v) for k, v in dataset.attrs.items()},
        **{
            str(name): {
                "dimensions": list(map(str, values.dims)),
                "values": json_data(values.values),
            }
            for name, values in {**dataset.coords, **dataset.data_vars}.items()
        },
    }


def json_data(value: Any) -> Any:
    """JSON data of numbers, arrays, lists and mappings; what is not finite becomes null."""
    if isinstance(value, np.ndarray | np.generic):
        return json_data(value.tolist())
    if isinstance(value, list | tuple):
        return [json_data(item) for item in value]
    if isinstance(value, Mapping):
        return {str(key): json_data(item) for key, item in value.items()}
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
