"""What lies in a results folder, as far as it can be read."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import xarray as xr

from surrogate.errors import ResultsError, StudyError
from surrogate.runs.dataset import load
from surrogate.study.source import read_file


@dataclass(frozen=True, eq=False)
class ResultsFolder:
    """One side of a comparison.

    name      A or B
    words     data of the study file; None when it cannot be read
    runs      the runs dataset, or None
    figures   content of summary.json; empty when it cannot be read
    troubles  a sentence for each file that is missing or damaged
    """

    name: str
    folder: Path
    words: Any
    runs: xr.Dataset | None
    figures: Mapping[str, Any]
    troubles: tuple[str, ...]

    @property
    def study(self) -> str:
        """The study's name."""
        return str(self.figures.get("study") or (self.words or {}).get("study") or self.folder)


def read(name: str, folder: Path) -> ResultsFolder:
    """The folder's files; raises `ResultsError` when none of them is there."""
    if not folder.is_dir():
        raise ResultsError(f"{folder} is no folder; give results of a study, such as results/beam")
    troubles: list[str] = []
    words = runs = None
    figures: Mapping[str, Any] = {}
    try:
        words = read_file(folder / "study.yaml").data
        if not isinstance(words, Mapping):
            words = None
            troubles.append(f"{name}: study.yaml holds no study")
    except StudyError as error:
        troubles.append(f"{name}: study.yaml cannot be read: {error.mistakes[0]}")
    try:
        runs = load(folder / "runs.nc")
        if "run" not in runs.dims or not {"status", "design", "parameter"} <= set(runs.variables):
            runs = None
            troubles.append(f"{name}: runs.nc is no dataset of runs")
    except ResultsError as error:
        troubles.append(f"{name}: {error}")
    try:
        figures = _json(folder / "summary.json")
    except (OSError, ValueError) as error:
        why = "does not exist" if isinstance(error, FileNotFoundError) else f"is damaged: {error}"
        troubles.append(f"{name}: summary.json {why}; `surrogate report` makes it again")
    if words is None and runs is None and not figures:
        raise ResultsError(
            f"{folder} holds no results that can be read; give the folder of one study, such as "
            "results/beam"
        )
    return ResultsFolder(name, folder, words, runs, figures, tuple(troubles))


def _json(path: Path) -> Mapping[str, Any]:
    found = json.loads(path.read_text(encoding="utf-8"))
    if not isinstance(found, dict):
        raise ValueError("it holds no figures")
    return found
