"""Runs of the solver at candidates: promises that are put to the test."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from surrogate.errors import StudyError
from surrogate.execution.progress import Progress
from surrogate.solving.solution import Solution
from surrogate.stages.solve import design_of
from surrogate.study.study import Study
from surrogate.study.verified_points import keep, points


def verify(
    study: Study,
    folder: Path,
    solution: Solution,
    *,
    runs: int | None = None,
    workers: int | None = None,
    progress: Callable[[Progress], None] | None = None,
) -> Study:
    """Run the solver at the candidates; returns the study with these runs in it.

    Raises `StudyError` for a study whose solver cannot be called.
    """
    if study.spec.recorded:
        raise StudyError("a table has no solver to verify with; run the tests and add their rows")
    if study.spec.told:
        raise StudyError(
            f"the answers of {study.spec.name} are told; ask a Campaign for the points of design "
            f"{design_of(solution.problem.name)}"
        )
    keep(folder, solution.problem.name, points(solution, study.space, runs))
    again = replace(study)  # its runs are found anew
    again.run(workers=workers, results=folder, progress=progress)
    return again
