"""What lies in a results folder, as far as it can be read."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

import xarray as xr

from surrogate.errors import ResultsError, StudyError
from surrogate.runs.dataset import load
from surrogate.study.source import read_file

Content = TypeVar("Content")


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
    words: Mapping[str, Any] | None
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

    def known(reader: Callable[[Path], Content], file: str) -> Content | None:
        try:
            return reader(folder / file)
        except ResultsError as error:
            troubles.append(f"{name}: {error}")
            return None

    words, runs = known(_words, "study.yaml"), known(_runs, "runs.nc")
    figures = known(_figures, "summary.json") or {}
    if words is None and runs is None and not figures:
        raise ResultsError(
            f"{folder} holds no results that can be read; give the folder of one study, such as "
            "results/beam"
        )
    return ResultsFolder(name, folder, words, runs, figures, tuple(troubles))


def _words(path: Path) -> Mapping[str, Any]:
    try:
        found = read_file(path).data
    except StudyError as error:
        raise ResultsError(f"{path.name} cannot be read: {error.mistakes[0]}") from error
    if not isinstance(found, Mapping):
        raise ResultsError(f"{path.name} holds no study")
    return found


def _runs(path: Path) -> xr.Dataset:
    found = load(path)
    if "run" not in found.dims or not {"status", "design", "parameter"} <= set(found.variables):
        raise ResultsError(f"{path.name} is no dataset of runs")
    return found


def _figures(path: Path) -> Mapping[str, Any]:
    cure = "`surrogate report` makes it again"
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError as error:
        raise ResultsError(f"{path.name} does not exist; {cure}") from error
    except (OSError, ValueError) as error:
        raise ResultsError(f"{path.name} is damaged: {error}; {cure}") from error
    if not isinstance(found, dict):
        raise ResultsError(f"{path.name} is damaged: it holds no figures; {cure}")
    return found
