"""The runs dataset: every run of a study, in the words of its user, with its history.

Dimensions `run`, `parameter` and those of the outputs. Variables `coded`, each
parameter and each output under its own name, `design`, `status`, `message`,
`seconds`, `attempts`, `finished`. A run without an answer is a row of NaN.
"""

from __future__ import annotations

import json
import platform
from collections import Counter
from collections.abc import Iterable, Mapping
from contextlib import suppress
from datetime import UTC, datetime
from importlib import metadata
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from surrogate.errors import ResultsError, StudyError, nearest
from surrogate.runs.files import write_bytes
from surrogate.runs.identity import RunInputs, SolverSpec, canonical, keys, run_inputs
from surrogate.runs.journal import JournalContents
from surrogate.runs.record import Record
from surrogate.solver import Output
from surrogate.space.space import Space

#: Names that a study's parameters, outputs and outputs' dimensions cannot have.
RESERVED_NAMES = frozenset(
    {"run", "parameter", "coded", "design", "status", "message", "seconds", "attempts", "finished"}
)

#: Status of a row: has an answer, has none, took too long, was not run yet.
STATUSES = ("ok", "failed", "timed_out", "missing")

#: Distributions whose versions a dataset remembers.
REMEMBERED = ("surrogate-studies", "numpy", "scipy", "scikit-learn", "xarray", "scikit-fem")

Designs = Mapping[str, np.ndarray]


def name_mistakes(space: Space, outputs: Mapping[str, Output]) -> list[str]:
    """A sentence for each name that a dataset cannot hold, or that would stand for two things."""
    reserved = f"reserved in the runs dataset ({', '.join(sorted(RESERVED_NAMES))}); rename it"
    dims = {dim: name for name, output in outputs.items() for dim in output.dims}
    mistakes = [
        f"parameter '{name}': the name is {reserved}"
        for name in space.names
        if name in RESERVED_NAMES
    ]
    mistakes += [
        f"output '{name}': the name is {reserved}" for name in outputs if name in RESERVED_NAMES
    ]
    mistakes += [
        f"dimension '{dim}' of output '{name}': the name is {reserved}"
        for dim, name in dims.items()
        if dim in RESERVED_NAMES
    ]
    mistakes += [
        f"{what} '{name}': a name in the runs dataset cannot hold '/'; rename it"
        for what, names in (("output", outputs), ("dimension", dims))
        for name in names
        if "/" in name
    ]
    mistakes += [
        f"'{name}' is both a parameter and an output; rename one"
        for name in space.names
        if name in outputs
    ]
    mistakes += [
        f"'{dim}' is both a dimension of output '{name}' and a parameter or output; rename one"
        for dim, name in dims.items()
        if dim in space.names or dim in outputs
    ]
    return mistakes + _coordinate_mistakes(outputs)


def _coordinate_mistakes(outputs: Mapping[str, Output]) -> list[str]:
    first: dict[str, str] = {}
    mistakes = []
    for name, output in outputs.items():
        for dim in output.dims:
            other = first.setdefault(dim, name)
            if not np.array_equal(output.coordinates[dim], outputs[other].coordinates[dim]):
                mistakes.append(
                    f"outputs '{other}' and '{name}' have different coordinates along "
                    f"'{dim}'; give one of the dimensions another name"
                )
    return mistakes


def physical_columns(space: Space, designs: Designs) -> dict[str, np.ndarray]:
    """Physical values, name -> (run,), of all designs' coded points one after the other."""
    return space.decode(np.concatenate([np.atleast_2d(coded) for coded in designs.values()]))


def assemble(
    space: Space,
    designs: Designs,
    spec: SolverSpec,
    journal: JournalContents,
    *,
    constants: Mapping[str, Any] | None = None,
    outputs: Iterable[str] | None = None,
    study: str = "",
    seeds: Mapping[str, Any] | None = None,
) -> xr.Dataset:
    """The runs dataset of several designs, from what the journal holds.

    designs  name -> coded points (run, parameter); a point in two of them is two rows that
             share one result
    journal  what `surrogate.runs.journal.read` gave; a run that it lacks has status "missing"
    study    text of the study file; seeds: name -> seed. Both are kept as attributes

    Raises `StudyError` when a name would stand for two things.
    """
    wanted = spec.wanted(outputs)
    mistakes = name_mistakes(space, wanted)
    if mistakes:
        raise StudyError(*mistakes)
    physical = physical_columns(space, designs)
    asked = run_inputs(spec, physical, constants)
    fixed = {
        name: value for name, value in (asked[0] if asked else {}).items() if name not in physical
    }
    records = [journal.records.get(key) for key in keys(spec, asked)]
    records = [record if record and record.answers(wanted) else None for record in records]
    return xr.Dataset(
        {
            "coded": (
                ("run", "parameter"),
                np.concatenate([np.atleast_2d(c) for c in designs.values()]),
                {"units": "1", "long_name": "coded value, -1 to 1 over the range"},
            ),
            **_parameters(space, physical),
            **_outputs(wanted, records, journal),
            **_history(designs, records),
        },
        coords={"parameter": list(space.names), **_coordinates(wanted)},
        attrs=_provenance(spec, constants, fixed, study, seeds),
    )


def _parameters(space: Space, physical: Mapping[str, np.ndarray]) -> dict[str, tuple]:
    result = {}
    for parameter in space.parameters:
        attributes = {"units": parameter.unit, "long_name": parameter.description or parameter.name}
        if parameter.categorical:
            attributes = {"long_name": attributes["long_name"], "levels": list(parameter.levels)}
        result[parameter.name] = ("run", physical[parameter.name], attributes)
    return result


def _outputs(
    wanted: Mapping[str, Output], records: list[Record | None], journal: JournalContents
) -> dict[str, tuple]:
    result = {}
    for name, output in wanted.items():
        values = np.full((len(records), *output.shape), np.nan)
        for i, record in enumerate(records):
            if record and record.status == "ok":
                values[i] = journal.values(record, name)
        result[name] = (
            ("run", *output.dims),
            values,
            {"units": output.unit, "long_name": output.description or name},
        )
    return result


def _coordinates(wanted: Mapping[str, Output]) -> dict[str, np.ndarray]:
    return {
        dim: np.asarray(output.coordinates[dim])
        for output in wanted.values()
        for dim in output.dims
    }


def _history(designs: Designs, records: list[Record | None]) -> dict[str, tuple]:
    """What is known of each run besides its numbers."""
    lengths = [len(np.atleast_2d(coded)) for coded in designs.values()]
    finished = [
        np.datetime64(round(r.finished * 1e6), "us") if r else np.datetime64("NaT", "us")
        for r in records
    ]
    return {
        "design": (
            "run",
            np.repeat(list(designs), lengths),
            {"long_name": "design that the run belongs to"},
        ),
        "status": (
            "run",
            np.array([r.status if r else "missing" for r in records], dtype=str),
            {"long_name": f"how the run ended: {', '.join(STATUSES)}"},
        ),
        "message": (
            "run",
            np.array([_storable(r.message) if r else "" for r in records], dtype=str),
            {"long_name": "why the run has no answer"},
        ),
        "seconds": (
            "run",
            np.array([r.seconds if r else np.nan for r in records]),
            {"units": "s", "long_name": "duration of the last attempt"},
        ),
        "attempts": (
            "run",
            np.array([r.attempts if r else 0 for r in records]),
            {"units": "1", "long_name": "attempts made"},
        ),
        "finished": (
            "run",
            np.array(finished, dtype="datetime64[ns]"),
            {"long_name": "when the run ended (UTC)"},
        ),
    }


def _storable(text: str) -> str:
    """A message without what a netCDF text cannot hold: NUL, and bytes that were no UTF-8."""
    return text.encode(errors="replace").decode().replace("\0", "?")


def _provenance(spec: SolverSpec, constants, fixed, study: str, seeds) -> dict[str, str]:
    """Who made it, when, with which versions; mappings as JSON text."""
    return {
        "study": study,
        "solver": spec.name,
        "solver_version": str(spec.solver.version),
        "solver_options": canonical(spec.options),
        "constants": canonical(constants or {}),
        "identity": spec.context,
        "fixed_inputs": canonical(fixed),
        "fixed_units": canonical(
            {
                name: spec.solver.inputs[name].unit
                for name in fixed
                if not spec.solver.inputs[name].levels
            }
        ),
        "seeds": canonical(seeds or {}),
        "versions": canonical(versions()),
        "deterministic": str(spec.deterministic).lower(),
        "created": datetime.now(UTC).isoformat(timespec="seconds"),
    }


def versions() -> dict[str, str]:
    """Versions of Python and of the packages that make the numbers."""
    found = {"python": platform.python_version()}
    for name in REMEMBERED:
        with suppress(metadata.PackageNotFoundError):
            found[name] = metadata.version(name)
    return found


def save(runs: xr.Dataset | xr.DataTree, path: str | Path, **options: Any) -> None:
    """Write a dataset as netCDF4, all of it or nothing: an older file stays until it is whole.

    It is made in memory, because HDF5 takes the process down when a disk fills under it.
    options: of `to_netcdf`. Raises `ResultsError` when the disk does not take it.
    """
    write_bytes(path, runs.to_netcdf(engine="h5netcdf", **options))


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


def training(
    runs: xr.Dataset, output: str, designs: Iterable[str] = ("train",)
) -> tuple[np.ndarray, np.ndarray]:
    """Coded points (n, parameter) and values (n, ...) of `output` in the good runs of `designs`.

    Runs in which the output has a gap are left out.
    """
    known = output_names(runs)
    if output not in known:
        raise ResultsError(f"there is no output '{output}'; {nearest(output, known)}")
    good = select(runs, designs=designs, statuses=["ok"])
    values = good[output].values
    known = np.isfinite(values).all(axis=tuple(range(1, values.ndim)))
    return good["coded"].values[known], values[known]


def output_names(runs: xr.Dataset) -> list[str]:
    """Names of the solver's outputs in a runs dataset."""
    return [
        str(name)
        for name in runs.data_vars
        if name not in RESERVED_NAMES and name not in runs["parameter"].values
    ]


def call_and_answer(runs: xr.Dataset, run: int) -> tuple[RunInputs, dict[str, np.ndarray]]:
    """What the solver was called with in row `run`, and what it answered, in its own units.

    `study.spec.solver(**call)` must give the answer again, to rounding.
    """
    row = runs.isel(run=run)
    call = {
        **described(runs, "fixed_inputs"),
        **{name: row[name].item() for name in runs["parameter"].values.tolist()},
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
    missing = counts(runs)["missing"] + more
    seconds = runs["seconds"].values
    if missing == 0:
        return 0.0
    if not np.isfinite(seconds).any():
        return None
    return missing * float(np.nanmean(seconds)) / workers


def described(runs: xr.Dataset, attribute: str) -> Any:
    """A dataset attribute that is kept as JSON text (constants, seeds, versions, options)."""
    return json.loads(runs.attrs[attribute])
