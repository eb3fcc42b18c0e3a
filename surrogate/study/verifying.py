"""Runs of the solver where surrogates made promises: these are put to the test."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from surrogate.errors import StudyError
from surrogate.execution.progress import Progress
from surrogate.stages.verified import design_of
from surrogate.study.study import Study
from surrogate.study.verified_points import Columns, keep


def verify(
    study: Study,
    folder: Path,
    promise: str,
    columns: Columns,
    *,
    anew: bool = False,
    workers: int | None = None,
    progress: Callable[[Progress], None] | None = None,
) -> Study:
    """Run the solver at points (name -> (run,)); returns the study with these runs in it.

    Runs of other designs that are still missing are not done.

    promise: a goal's name, or `CALIBRATION`. anew: points verified before are dropped.
    Raises `StudyError` for a study whose solver cannot be called.
    """
    if study.spec.recorded:
        raise StudyError("a table has no solver to verify with; run the tests and add their rows")
    if study.spec.told:
        raise StudyError(
            f"the answers of {study.spec.name} are told; ask a Campaign for the points of design "
            f"{design_of(promise)}"
        )
    keep(folder, promise, columns, anew=anew)
    again = replace(study)  # its runs are found anew
    again.run(workers=workers, results=folder, only=[design_of(promise)], progress=progress)
    return again
