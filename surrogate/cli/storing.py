"""Runs put beside the study, as the command prints it."""

from __future__ import annotations

import os
from pathlib import Path

from surrogate.cli import results
from surrogate.cli.page import Page
from surrogate.runs import dataset as rundata
from surrogate.study.study import Study


def store(study: Study, folder: Path, to: Path | None) -> Page:
    """Where the stored runs are, and the line that the study needs."""
    path, runs = results.store(study, folder, to)
    counts = rundata.counts(runs)
    done = runs.sizes["run"] - counts["missing"]
    parts = [f"{path} holds {done} runs ({path.stat().st_size / 1e3:.0f} kB)"]
    if counts["missing"]:
        parts.append(f"{counts['missing']} runs of the study are not done yet and not in it")
    name = Path(os.path.relpath(path, study.place)).as_posix()
    named = name in (file.name for file in study.stored_runs)
    parts.append("the study names it already" if named else f"add to the study:\n\nstored: {name}")
    return Page(
        {"file": str(path), "runs": done, "missing": counts["missing"], "stored": name}, parts
    )
