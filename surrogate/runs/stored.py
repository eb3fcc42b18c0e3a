"""Stored runs: datasets of runs that ship with a study, so that nobody has to wait for them.

A stored run is taken for a point of the study when solver, version, options and all
inputs are the same: to the last digit, or to `SAME` of an input's size in the file, because
another machine may round a design point differently. It is not copied into the
journal, and what the journal holds goes before it.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import chain, product
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from surrogate.errors import ResultsError, StudyError
from surrogate.runs import dataset as rundata
from surrogate.runs.compaction import JOURNAL
from surrogate.runs.identity import RunInputs, SolverSpec, keys_in
from surrogate.runs.journal import JournalContents
from surrogate.runs.record import Record
from surrogate.solver import Output

#: Inputs that differ by less than this share of the largest value in a file are one input.
SAME = 1e-12
#: A field is stored in single precision when that moves it by less than this share of its range.
FIELD_ROUNDING = 1e-6
_NEEDED = ("status", "message", "seconds", "attempts", "finished")


@dataclass(frozen=True)
class StoredRuns:
    """The runs in one file.

    name    the path as the study writes it
    runs    the dataset
    """

    name: str
    runs: xr.Dataset

    @property
    def context(self) -> str:
        """Solver, version and options as canonical JSON (`SolverSpec.context`)."""
        return str(self.runs.attrs["identity"])

    @property
    def tabulated(self) -> bool:
        """True when runs of it are rows of a table, which no solver can repeat."""
        return "origin" in self.runs and bool((self.runs["origin"].values != "").any())

    @cached_property
    def parts(self) -> tuple[StoredRuns, ...]:
        """The runs of each solver in it: one, but for levels of fidelity."""
        if rundata.LEVELS not in self.runs.attrs:
            return (self,)
        return tuple(
            StoredRuns(
                self.name,
                rundata.at_level(self.runs, one["name"]).assign_attrs(
                    identity=one["identity"],
                    fixed_inputs=json.dumps(one["fixed_inputs"]),
                    taken=one["parameters"],
                ),
            )
            for one in rundata.described(self.runs, rundata.LEVELS)
        )

    @cached_property
    def run_inputs(self) -> list[RunInputs]:
        """What the solver was called with, for each run."""
        fixed = json.loads(self.runs.attrs["fixed_inputs"])
        names = self.runs.attrs.get("taken", self.runs["parameter"].values.tolist())
        rows = zip(*(self.runs[name].values.tolist() for name in names), strict=True)
        return [{**fixed, **dict(zip(names, row, strict=True))} for row in rows]

    @cached_property
    def rows(self) -> dict[str, int]:
        """Row of each run by its identity; of equal runs the first with an answer."""
        deterministic = self.runs.attrs["deterministic"] != "false"
        found: dict[str, int] = {}
        status = self.runs["status"].values
        for row, key in enumerate(keys_in(self.context, self.run_inputs, deterministic)):
            if status[row] != "missing" and (
                key not in found or (status[row] == "ok" != status[found[key]])
            ):
                found[key] = row
        return found

    def record(self, key: str, row: int) -> Record:
        """The run in `row`, as a journal would hold it; arrays are left in the dataset."""
        status, message, seconds, attempts, finished = (
            self.runs[name].values[row] for name in _NEEDED
        )
        outputs, fields = {}, {}
        for name in rundata.output_names(self.runs) if status == "ok" else ():
            if self.runs[name].ndim > 1:
                fields[name] = {"row": row, "shape": self.runs[name].shape[1:]}
            else:
                outputs[name] = float(self.runs[name].values[row])
        return Record(
            key,
            self.run_inputs[row],
            str(status),
            str(message),
            float(seconds),
            int(attempts),
            finished.astype("datetime64[us]").astype(int) / 1e6,
            outputs=outputs,
            fields=fields,
        )


def load(path: Path, name: str) -> StoredRuns:
    """The runs in `path`; raises `StudyError` when it is missing or no runs dataset."""
    try:
        runs = rundata.load(
            path,
            missing="`surrogate store` writes such a file",
            damaged="write it again with `surrogate store`",
        )
    except ResultsError as error:
        raise StudyError(f"stored runs '{name}': {error}") from None
    lacking = [
        f"the attribute '{word}'"
        for word in ("identity", "fixed_inputs", "deterministic")
        if word not in runs.attrs
    ]
    lacking += [f"the variable '{word}'" for word in ("parameter", *_NEEDED) if word not in runs]
    if lacking:
        raise StudyError(
            f"stored runs '{name}': {path} is not a dataset of runs: it lacks "
            f"{', '.join(lacking)}; write it with `surrogate store`"
        )
    return StoredRuns(name, runs)


@dataclass(frozen=True)
class StoredMatches:
    """Stored runs that are points of a study, by their identity in that study."""

    records: dict[str, Record] = field(default_factory=dict)
    places: dict[str, tuple[StoredRuns, int]] = field(default_factory=dict)

    def values(self, record: Record, name: str) -> float | np.ndarray:
        """Output `name` of a record: a float, or an array of doubles."""
        if name in record.outputs:
            return record.outputs[name]
        file, row = self.places[record.key]
        return np.asarray(file.runs[name].values[row], dtype=float)


def match(
    files: Iterable[StoredRuns],
    spec: SolverSpec,
    calls: Sequence[RunInputs],
    keys: Sequence[str],
    wanted: Mapping[str, Output],
) -> StoredMatches:
    """The stored runs that are points of a study, of several the first with an answer.

    calls, keys: the study's points. Good runs must have all outputs `wanted`.
    """
    given = StoredMatches()
    solvers = list(spec.parts(calls))
    for file, (own, numbers, asked) in product(chain(*(f.parts for f in files)), solvers):
        if file.context != own.context:
            continue
        rows = _rows_of(file, own, dict(zip((keys[n] for n in numbers), asked, strict=True)))
        for key, row in rows.items():
            record = file.record(key, row)
            first = given.records.get(key)
            if record.answers(wanted) and (first is None or first.status != "ok" == record.status):
                given.records[key], given.places[key] = record, (file, row)
    return given


def _rows_of(file: StoredRuns, spec: SolverSpec, calls: Mapping[str, RunInputs]) -> dict[str, int]:
    """Row of the file for each key of the study that it has."""
    rows = {key: file.rows[key] for key in calls if key in file.rows}
    left = [key for key in calls if key not in rows]
    if not left or not spec.deterministic or not file.rows:
        return rows
    candidates = np.array(list(file.rows.values()))
    numbers, words = _split([file.run_inputs[row] for row in candidates], spec)
    tolerance = SAME * np.abs(numbers).max(axis=0, initial=0.0)
    for key in left:
        number, word = _split([calls[key]], spec)
        close = (np.abs(numbers - number) <= tolerance).all(axis=1)
        found = np.flatnonzero(close & (words == word).all(axis=1))
        if len(found):
            rows[key] = int(candidates[found[0]])
    return rows


def _split(calls: Sequence[RunInputs], spec: SolverSpec) -> tuple[np.ndarray, np.ndarray]:
    """Numbers and level names of the calls, (run, input) each; what is not given is NaN or ''."""
    inputs = spec.solver.inputs
    numbers = [
        [call.get(name, np.nan) for name, one in inputs.items() if not one.levels] for call in calls
    ]
    words = [[call.get(name, "") for name, one in inputs.items() if one.levels] for call in calls]
    return np.array(numbers, dtype=float), np.array(words, dtype=str)


@dataclass(frozen=True)
class KnownRuns:
    """A journal, and stored runs where it has no answer."""

    journal: JournalContents
    given: StoredMatches
    wanted: Mapping[str, Output]

    @cached_property
    def records(self) -> dict[str, Record]:
        """Records by key."""
        return {
            **self.journal.records,
            **{key: record for key, record in self.given.records.items() if self._gives(key)},
        }

    def ended(self, key: str) -> Record | None:
        """The record of a run that has ended for good; None while there is none."""
        for records in (self.journal.records, self.given.records):
            record = records.get(key)
            if record is not None and record.answers(self.wanted) and not record.lost:
                return record
        return None

    def _gives(self, key: str) -> bool:
        own = self.journal.records.get(key)
        return own is None or not own.answers(self.wanted)

    def values(self, record: Record, name: str) -> float | np.ndarray:
        """Output `name` of a record."""
        source = self.given if self.given.records.get(record.key) is record else self.journal
        return source.values(record, name)

    def origin(self, key: str) -> str:
        """File and row that a run comes from, of a table; "" for others."""
        if key not in self.given.places or not self._gives(key):
            return ""
        file, row = self.given.places[key]
        return str(file.runs["origin"].values[row]) if "origin" in file.runs else ""

    def origins(self, keys: Iterable[str]) -> dict[str, int]:
        """Number of these runs that come from each stored file, by its name."""
        counts: dict[str, int] = {}
        for key in keys:
            if key in self.given.records and self._gives(key):
                name = self.given.places[key][0].name
                counts[name] = counts.get(name, 0) + 1
        return counts


def first_difference(
    file: StoredRuns, spec: SolverSpec, calls: Sequence[RunInputs], wanted: Iterable[str]
) -> str:
    """Why no run of the file is a point of the study: what differs first, then -> now."""
    file = file.parts[-1]
    then, now = json.loads(file.context), json.loads(spec.context)
    for word in ("solver", "version"):
        if then.get(word) != now[word]:
            return f"other {word} {then.get(word)} -> {now[word]}"
    then, now = then.get("options", {}), now["options"]
    for name in {**then, **now}:
        if then.get(name) != now.get(name):
            return f"other option {name}: {then.get(name, 'none')} -> {now.get(name, 'none')}"
    for name, one in spec.solver.inputs.items():
        before, after = ({call.get(name) for call in some} for some in (file.run_inputs, calls))
        if not _meet(before, after):
            unit = f" {one.unit}".rstrip()
            return f"other {name}: {_said(before)} -> {_said(after)}{unit}"
    lacking = [name for name in wanted if name not in rundata.output_names(file.runs)]
    if lacking:
        return f"it has no output {', '.join(lacking)}"
    return "each of its points differs from all points of the designs"


def _meet(before: set[Any], after: set[Any]) -> bool:
    if before & after:
        return True
    numbers = [np.array([v for v in some if isinstance(v, float)]) for some in (before, after)]
    return bool((np.abs(numbers[0][:, None] - numbers[1]) <= SAME * np.abs(numbers[1])).any())


def _said(values: set[Any]) -> str:
    """A few values one by one, more as a range."""
    if any(not isinstance(value, float) for value in values):
        return ", ".join(sorted("none" if value is None else str(value) for value in values))
    if len(values) <= 2:
        return ", ".join(f"{value:g}" for value in sorted(values))
    return f"{min(values):g} to {max(values):g}"


def write(runs: xr.Dataset, path: str | Path) -> None:
    """Write the finished ones of `runs` into a small file, whole or not at all.

    Everything is compressed without loss, except that fields are kept in single
    precision when that moves no value by more than `FIELD_ROUNDING` of the field's range
    over all runs. Inputs and scalar outputs keep every digit. Raises `ResultsError` when
    no run is finished.
    """
    finished = runs.isel(run=np.flatnonzero(runs["status"].values != "missing"))
    if not finished.sizes["run"]:
        raise ResultsError(
            "no run is finished, so there is nothing to store; do `surrogate run` first"
        )
    single = {
        name: finished[name].astype("float32")
        for name in rundata.output_names(finished)
        if _fits_single(finished[name])
    }
    finished = finished.assign(single)
    for of_the_journal in ("stored", "damaged", JOURNAL):
        finished.attrs.pop(of_the_journal, None)
    rundata.save(finished, path, compressed=True)


def _fits_single(values: xr.DataArray) -> bool:
    finite = values.values[np.isfinite(values.values)]
    if values.ndim < 2 or not finite.size or np.abs(finite).max() > np.finfo("float32").max:
        return False
    moved = np.abs(finite.astype("float32").astype(float) - finite).max()
    return bool(moved <= FIELD_ROUNDING * np.ptp(finite))
