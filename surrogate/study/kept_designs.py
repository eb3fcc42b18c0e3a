"""Points of designs that were found before: a design does not move once its runs have begun.

A search (a maximin Latin hypercube) is done once, for the first run. Its points are kept in
designs/ of the results folder under the design's identity, and taken from there whatever a
later version of the search would find. Stored runs, and the runs dataset in the results
folder, hold the points of their study's designs too.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from pathlib import Path

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from surrogate.designs.design import Design
from surrogate.errors import ResultsError, StudyError
from surrogate.runs import dataset as rundata
from surrogate.runs.files import write_text
from surrogate.solver import Solver
from surrogate.study import file as studyfile
from surrogate.study.parts.adaptive import ADAPTIVE
from surrogate.study.reading.designs import designs_of
from surrogate.study.reading.mistakes import Reading
from surrogate.study.reading.parameters import space_of
from surrogate.study.source import read_text

Coded = NDArray[np.float64]
#: The runs dataset of a study in its results folder.
RUNS = "runs.nc"


def keep(designs: Mapping[str, Design], results: Path) -> None:
    """Write the points of every search into the results folder, each whole or not at all.

    Finds those that are not at hand. Raises `ResultsError` when the disk does not take them.
    """
    for design in designs.values():
        path = _path(results, design.identity)
        if design.searched and not path.exists():
            content = {
                "method": design.method,
                "options": dict(design.options),
                "digest": _digest(design.initial),
                "coded": design.initial.tolist(),
            }
            write_text(path, json.dumps(content))


def recall(
    designs: Mapping[str, Design], results: Path, stored: Iterable[xr.Dataset], solver: Solver
) -> dict[str, Design]:
    """The designs, with their points where the results folder or stored runs hold them.

    The folder's designs/ comes first, then `stored`, then the folder's runs dataset.
    Raises `ResultsError` for a damaged file.
    """
    sought = {design.identity for design in designs.values() if not design.at_hand}
    points: dict[str, Coded] = {}
    for found in _sources(sought, results, stored, solver) if sought else ():
        points = {**found, **points}
        if sought <= points.keys():
            break
    return {
        name: design
        if design.at_hand or design.identity not in points
        else design.with_points(points[design.identity])
        for name, design in designs.items()
    }


def _sources(
    sought: Iterable[str], results: Path, stored: Iterable[xr.Dataset], solver: Solver
) -> Iterator[dict[str, Coded]]:
    """Points by the identity of their design, from one place after the other."""
    paths = {identity: _path(results, identity) for identity in sought}
    yield {identity: _read(path) for identity, path in paths.items() if path.exists()}
    for runs in stored:
        yield _points_in(runs, solver)
    if (results / RUNS).exists():
        with suppress(ResultsError):
            yield _points_in(rundata.load(results / RUNS), solver)


def _points_in(runs: xr.Dataset, solver: Solver) -> dict[str, Coded]:
    """Points of the searched designs of the study that a runs dataset tells, if all are there."""
    try:
        part, _, broken = studyfile.read(read_text(runs.attrs.get("study", ""), "runs").data)
    except StudyError:
        return {}
    if part is None:
        return {}
    notes = Reading(part, None, broken)
    designs = designs_of(notes, space_of(notes, solver))
    names, coded = runs["design"].values.astype(str), runs["coded"].values
    return {
        design.identity: coded[names == name][: design.rows]
        for name, design in designs.items()
        if design.searched and _holds(design, int((names == name).sum()))
    }


def _holds(design: Design, rows: int) -> bool:
    """Whether so many rows are those of a design; an adaptive one has grown."""
    return rows >= design.rows if design.method == ADAPTIVE else rows == design.rows


def _path(results: Path, identity: str) -> Path:
    return results / "designs" / f"{identity}.json"


def _read(path: Path) -> Coded:
    """The points in one file of designs/."""
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
        coded = np.array(content["coded"], dtype=float)
        whole = content["digest"] == _digest(coded)
    except (OSError, ValueError, KeyError, TypeError):
        whole = False
    if not whole:
        raise ResultsError(
            f"{path} is damaged: it does not hold the points that were written; restore it, or "
            "delete it to find the design again"
        )
    return coded


def _digest(coded: Coded) -> str:
    return hashlib.sha256(np.ascontiguousarray(coded, dtype="<f8").tobytes()).hexdigest()
