"""From designs and journal to the runs dataset."""

from __future__ import annotations

import platform
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from datetime import UTC, datetime
from importlib import metadata
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from surrogate.errors import StudyError
from surrogate.runs.dataset import LEVEL, LEVELS, STATUSES
from surrogate.runs.identity import SolverSpec, canonical, keys, run_inputs
from surrogate.runs.journal import JournalContents
from surrogate.runs.levels import LevelsSpec
from surrogate.runs.names import name_mistakes, storable
from surrogate.runs.record import Record
from surrogate.runs.stored import KnownRuns
from surrogate.solver import Output
from surrogate.space.space import Space

#: Distributions whose versions a dataset remembers.
REMEMBERED = ("surrogate-studies", "numpy", "scipy", "scikit-learn", "xarray", "scikit-fem")

Designs = Mapping[str, NDArray[np.float64]]
Variable = tuple[Any, ...]


def physical_columns(space: Space, designs: Designs) -> dict[str, NDArray[Any]]:
    """Physical values, name -> (run,), of all designs' coded points one after the other."""
    return space.decode(np.concatenate([np.atleast_2d(coded) for coded in designs.values()]))


def assemble(
    space: Space,
    designs: Designs,
    spec: SolverSpec,
    journal: JournalContents | KnownRuns,
    *,
    constants: Mapping[str, Any] | None = None,
    outputs: Iterable[str] | None = None,
    study: str = "",
    seeds: Mapping[str, Any] | None = None,
    run_keys: Sequence[str] | None = None,
    values: bool = True,
    levels: Sequence[str] = (),
) -> xr.Dataset:
    """The runs dataset of several designs, from what the journal holds.

    designs  name -> coded points (run, parameter); a point in two of them is two rows that
             share one result
    journal  what `surrogate.runs.journal.read` gave; a run that it lacks has status "missing"
    study    text of the study file; seeds: name -> seed. Both are kept as attributes
    run_keys identity of each row (surrogate.runs.identity.keys), where it is at hand
    values   False: without the outputs
    levels   level of fidelity of each row, where the study has levels

    Raises `StudyError` when a name would stand for two things.
    """
    wanted = spec.wanted(outputs)
    mistakes = name_mistakes(space, wanted)
    if mistakes:
        raise StudyError(*mistakes)
    physical = physical_columns(space, designs)
    first = {name: column[:1] for name, column in physical.items()}
    one = next(iter(run_inputs(spec, first, constants)), {})
    leveled = isinstance(spec, LevelsSpec)
    fixed = {k: v for k, v in one.items() if k not in physical and not (leveled and k == LEVEL)}
    if run_keys is None:
        columns = {**physical, LEVEL: list(levels)} if leveled else physical
        run_keys = keys(spec, run_inputs(spec, columns, constants))
    known = journal.records
    found = [known.get(key) for key in run_keys]
    records = [record if record and record.answers(wanted) else None for record in found]
    return xr.Dataset(
        {
            "coded": (
                ("run", "parameter"),
                np.concatenate([np.atleast_2d(c) for c in designs.values()]),
                {"units": "1", "long_name": "coded value, -1 to 1 over the range"},
            ),
            **_parameters(space, physical),
            **_outputs(wanted if values else {}, records, journal),
            **_history(designs, records),
            "origin": _origins(journal, run_keys),
            **(_levels(levels) if leveled else {}),
        },
        coords={"parameter": list(space.names), **_coordinates(wanted if values else {})},
        attrs={
            **_provenance(spec, constants, fixed, study, seeds),
            **({LEVELS: spec.told_of(space.names, one)} if isinstance(spec, LevelsSpec) else {}),
        },
    )


def _parameters(space: Space, physical: Mapping[str, NDArray[Any]]) -> dict[str, Variable]:
    result: dict[str, Variable] = {}
    for parameter in space.parameters:
        attributes: dict[str, Any] = {
            "units": parameter.unit,
            "long_name": storable(parameter.description or parameter.name),
        }
        if parameter.categorical:
            attributes = {"long_name": attributes["long_name"], "levels": list(parameter.levels)}
        result[parameter.name] = ("run", physical[parameter.name], attributes)
    return result


def _outputs(
    wanted: Mapping[str, Output],
    records: list[Record | None],
    journal: JournalContents | KnownRuns,
) -> dict[str, Variable]:
    result: dict[str, Variable] = {}
    for name, output in wanted.items():
        values = np.full((len(records), *output.shape), np.nan)
        for i, record in enumerate(records):
            if record and record.status == "ok":
                values[i] = journal.values(record, name)
        result[name] = (
            ("run", *output.dims),
            values,
            {"units": output.unit, "long_name": storable(output.description or name)},
        )
    return result


def _coordinates(wanted: Mapping[str, Output]) -> dict[str, NDArray[Any]]:
    return {
        dim: np.asarray(output.coordinates[dim])
        for output in wanted.values()
        for dim in output.dims
    }


def _history(designs: Designs, records: list[Record | None]) -> dict[str, Variable]:
    """What is known of each run besides its numbers."""
    lengths = [len(np.atleast_2d(coded)) for coded in designs.values()]
    finished = np.full(len(records), np.datetime64("NaT", "us"))
    done = np.array([r is not None for r in records], dtype=bool)
    since_1970 = np.array([r.finished for r in records if r])
    finished[done] = np.round(since_1970 * 1e6).astype("datetime64[us]")
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
            np.array([storable(r.message) if r else "" for r in records], dtype=str),
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
            finished.astype("datetime64[ns]"),
            {"long_name": "when the run ended (UTC)"},
        ),
    }


def _origins(journal: JournalContents | KnownRuns, run_keys: Sequence[str]) -> Variable:
    """Which row of a table each run is; empty for runs of the solver."""
    known = journal if isinstance(journal, KnownRuns) else None
    origins = np.array([known.origin(key) if known else "" for key in run_keys], dtype=str)
    return "run", origins, {"long_name": "file and row that the run comes from"}


def _levels(levels: Sequence[str]) -> dict[str, Variable]:
    """Level of fidelity of each run."""
    return {LEVEL: ("run", np.array(levels, dtype=str), {"long_name": "level of fidelity"})}


def _provenance(
    spec: SolverSpec,
    constants: Mapping[str, Any] | None,
    fixed: Mapping[str, Any],
    study: str,
    seeds: Mapping[str, Any] | None,
) -> dict[str, str]:
    """Who made it, when, with which versions; mappings as JSON text."""
    return {
        "study": storable(study),
        "solver": storable(spec.name),
        "solver_version": storable(str(spec.solver.version)),
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
        **({"recorded": "true"} if spec.recorded else {}),
        "created": datetime.now(UTC).isoformat(timespec="seconds"),
    }


def versions() -> dict[str, str]:
    """Versions of Python and of the packages that make the numbers."""
    found = {"python": platform.python_version()}
    for name in REMEMBERED:
        with suppress(metadata.PackageNotFoundError):
            found[name] = metadata.version(name)
    return found
