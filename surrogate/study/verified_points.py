"""Points at which promises are verified, kept in the results folder.

They are a design of the study from then on, named after the goal or the calibration. No surrogate
learns from it unless it names it in `train:`.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from surrogate.designs.design import Design
from surrogate.errors import ResultsError, StudyError
from surrogate.runs.files import write_text
from surrogate.solving.solution import Solution
from surrogate.space.space import Space
from surrogate.stages.verified import PREFIX, design_of

Coded = NDArray[np.float64]
Columns = Mapping[str, NDArray[Any]]

#: Runs at the best candidate when inputs are uncertain.
RUNS = 20
SEED = 22


def points(solution: Solution, space: Space, runs: int | None = None) -> dict[str, NDArray[Any]]:
    """Physical inputs of the verifying runs, name -> (run,).

    Without uncertain inputs one run at each candidate. With some, `runs` (default `RUNS`) at
    the best candidate, the uncertain inputs drawn from their law.
    """
    problem = solution.problem
    chosen = solution.candidates[:1] if problem.uncertain else solution.candidates
    count = (runs or RUNS) if problem.uncertain else len(chosen)
    drawn = space.decode(space.sample(count, seed=SEED))
    columns: dict[str, NDArray[Any]] = {}
    for name in space.names:
        if name in problem.free:
            values = [one.inputs[name] for one in chosen]
            columns[name] = np.array(values * (count // len(values)))
        elif name in problem.uncertain:
            columns[name] = drawn[name]
        else:
            columns[name] = np.array([problem.held[name]] * count)
    return columns


def keep(folder: Path, promise: str, columns: Columns, *, anew: bool = False) -> None:
    """Write the points of a verification into the results folder, beside those there.

    anew: in place of those there.
    """
    path = _path(folder, promise)
    old = _read(path) if path.exists() and not anew else {}
    if set(old) == set(columns):
        columns = {name: np.concatenate([old[name], columns[name]]) for name in columns}
    rows = dict.fromkeys(zip(*(column.tolist() for column in columns.values()), strict=True))
    lists = dict(zip(columns, map(list, zip(*rows, strict=True)), strict=True))
    path.parent.mkdir(parents=True, exist_ok=True)
    write_text(path, json.dumps({"columns": lists}))


def kept(folder: Path, space: Space) -> dict[str, Design]:
    """The designs of verifications in a results folder, by name.

    Points that the parameters as they are now do not hold are left out.
    """
    found = {}
    for path in sorted((folder / "designs").glob(f"{PREFIX}*.json")):
        coded = _coded(space, _read(path))
        if len(coded):
            found[path.stem] = Design(
                path.stem, "solve", {}, len(coded), partial(np.copy, coded), identity=path.stem
            )
    return found


def _path(folder: Path, promise: str) -> Path:
    return folder / "designs" / f"{design_of(promise)}.json"


def _read(path: Path) -> dict[str, NDArray[Any]]:
    try:
        columns = json.loads(path.read_text(encoding="utf-8"))["columns"]
        return {name: np.array(column) for name, column in columns.items()}
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        raise ResultsError(
            f"{path} is damaged: it does not hold the points that were written; restore it, or "
            "delete it to verify again"
        ) from None


def _coded(space: Space, columns: Columns) -> Coded:
    """Coded points (run, parameter) of those columns that fit to the parameters."""
    if set(columns) != set(space.names):
        return np.empty((0, space.size))
    try:
        coded = space.encode(columns)
    except (StudyError, ValueError, TypeError):  # levels that are no longer there
        return np.empty((0, space.size))
    return coded[np.all(np.abs(coded) <= 1.0 + 1e-9, axis=1)]
