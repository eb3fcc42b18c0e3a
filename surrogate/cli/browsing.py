"""`surrogate open`: a study's report in the browser."""

from __future__ import annotations

import webbrowser
from pathlib import Path

from surrogate.errors import ResultsError
from surrogate.stages.table import REPORT
from surrogate.study.analysis import walk
from surrogate.study.study import Study


def report_of(study: Study, folder: Path, file: Path) -> tuple[Path, list[str]]:
    """The report's path, and a sentence when it shows less than is known now.

    file: the study's file, for the cure. Raises `ResultsError` when there is no report.
    """
    path = folder / REPORT
    if not path.is_file():
        raise ResultsError(f"{path} does not exist; `surrogate run {file}` makes it")
    if walk(study, folder).is_up_to_date("report"):
        return path, []
    return path, [f"the report is older than the runs or the study; `surrogate report {file}`"]


def browse(path: Path) -> bool:
    """Open a file in the browser; False when there is none."""
    return webbrowser.open(path.resolve().as_uri())
