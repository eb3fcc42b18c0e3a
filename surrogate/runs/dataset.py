"""The runs dataset: every run of a study, in the words of its user, with its history.

Dimensions `run`, `parameter` and those of the outputs. Variables `coded`, each
parameter and each output under its own name, `design`, `status`, `message`,
`seconds`, `attempts`, `finished`. A run without an answer is a row of NaN.
`surrogate.runs.assembly` makes it.
"""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from surrogate.errors import ResultsError, nearest
from surrogate.runs.files import write_bytes
from surrogate.runs.identity import RunInputs
from surrogate.runs.names import RESERVED_NAMES
from surrogate.runs.netcdf import encoded
from surrogate.runs.time_left import time_left

#: Status of a row: has an answer, has none, took too long, was not run yet.
STATUSES = ("ok", "failed", "timed_out", "missing")

#: Of a study with levels of fidelity: the variable that tells a run's level, and the attribute
#: that describes the levels, cheapest first.
LEVEL, LEVELS = "level", "levels"


def save(runs: xr.Dataset | xr.DataTree, path: str | Path, *, compressed: bool = False) -> None:
    """Write a dataset as netCDF4, all of it or nothing: an older file stays until it is whole.

    It is made in memory, because HDF5 takes the process down when a disk fills under it.
    compressed: numbers, without loss. Raises `ResultsError` when the disk does not take it.
    """
    write_bytes(path, encoded(runs, compressed=compressed))


def load(
    path: str | Path,
    *,
    missing: str = "run the study first",
    damaged: str = "delete it and run the study again: finished runs come back from the journal",
) -> xr.Dataset:
    """The dataset in `path`, read whole.

    Raises `ResultsError` with the cure for a file that is `missing`, or `damaged`.
    """
    if not Path(path).is_file():
        raise ResultsError(f"{path} does not exist; {missing}")
    try:
        return xr.load_dataset(path, engine="h5netcdf", decode_timedelta=False)
    except Exception as error:  # a damaged file fails in the depths of HDF5 in many ways
        raise ResultsError(
            f"{path} cannot be read ({type(error).__name__}: {error}); {damaged}"
        ) from error


def select(
    runs: xr.Dataset, *, designs: Iterable[str] | None = None, statuses: Iterable[str] | None = None
) -> xr.Dataset:
    """The rows that belong to one of `designs` and ended in one of `statuses` (None: any).

    Raises `ResultsError` for a design that the dataset does not have.
    """
    keep = np.ones(runs.sizes["run"], dtype=bool)
    if designs is not None:
        present = set(runs["design"].values.tolist())
        for name in (designs := list(designs)):
            if name not in present:
                raise ResultsError(
                    f"there are no runs of design '{name}'; {nearest(name, present)}"
                )
        keep &= np.isin(runs["design"].values.astype(str), designs)
    if statuses is not None:
        keep &= np.isin(runs["status"].values.astype(str), list(statuses))
    return runs.isel(run=keep)


def level_names(runs: xr.Dataset) -> list[str]:
    """Levels of fidelity, cheapest first; none where there is but one solver."""
    return [one["name"] for one in described(runs, LEVELS)] if LEVELS in runs.attrs else []


def at_level(runs: xr.Dataset, level: str | None = None) -> xr.Dataset:
    """The rows of one level of fidelity; None: of the truth. All rows where there are no levels."""
    names = level_names(runs)
    if not names:
        return runs
    level = names[-1] if level is None else level
    return runs.isel(run=np.flatnonzero(runs[LEVEL].values.astype(str) == level))


def training(
    runs: xr.Dataset,
    output: str,
    designs: Iterable[str] = ("train",),
    level: str | None = None,
) -> tuple[np.ndarray, np.ndarray]:
    """Coded points (n, parameter) and values (n, ...) of `output` in the good runs of `designs`.

    Runs in which the output has a gap are left out. level: of fidelity; default the truth.
    """
    known = output_names(runs)
    if output not in known:
        raise ResultsError(f"there is no output '{output}'; {nearest(output, known)}")
    chosen = select(runs, designs=designs, statuses=["ok"])
    good = at_level(chosen, level)
    values = good[output].values
    known = np.isfinite(values).all(axis=tuple(range(1, values.ndim)))
    return good["coded"].values[known], values[known]


def output_names(runs: xr.Dataset) -> list[str]:
    """Names of the solver's outputs in a runs dataset."""
    return [
        str(name)
        for name in runs.data_vars
        if name not in RESERVED_NAMES
        and name not in runs["parameter"].values
        and not (name == LEVEL and LEVELS in runs.attrs)
    ]


def call_and_answer(runs: xr.Dataset, run: int) -> tuple[RunInputs, dict[str, np.ndarray]]:
    """What the solver was called with in row `run`, and what it answered, in its own units.

    `study.spec.solver(**call)` must give the answer again, to rounding.
    """
    row = runs.isel(run=run)
    call = {
        **described(runs, "fixed_inputs"),
        **{name: row[name].item() for name in runs["parameter"].values.tolist()},
        **({LEVEL: row[LEVEL].item()} if LEVELS in runs.attrs else {}),
    }
    return call, {name: row[name].values for name in output_names(runs)}


def counts(runs: xr.Dataset) -> dict[str, int]:
    """Number of runs by status, every status named."""
    found = Counter(runs["status"].values.tolist())
    return {status: found[status] for status in STATUSES}


def seconds_left(runs: xr.Dataset, workers: int = 1, more: int = 0) -> float | None:
    """Estimated time of the missing runs on `workers`; None when no run tells how long one takes.

    more: runs that are missing besides those of the dataset. Equal points are counted once per
    row, so it errs on the long side.
    """
    names = level_names(runs)
    if names:  # each run costs what those of its level do; more runs are of the truth
        each = [
            seconds_left(at_level(runs, name).drop_attrs(), workers, more * (name == names[-1]))
            for name in names
        ]
        known = [seconds for seconds in each if seconds is not None]
        return sum(known) if known else None
    took = runs["seconds"].values
    begun = runs["finished"].values - (took * 1e9).astype("timedelta64[ns]")
    seconds = took[np.argsort(begun, kind="stable")]
    left = counts(runs)["missing"] + more
    return time_left(seconds[np.isfinite(seconds)].tolist(), [], left, workers)


def described(runs: xr.Dataset, attribute: str) -> Any:
    """A dataset attribute that is kept as JSON text (constants, seeds, versions, options)."""
    return json.loads(runs.attrs[attribute])
