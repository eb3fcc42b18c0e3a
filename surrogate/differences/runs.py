"""What changed in the runs: how they ended, which are new, and answers that differ."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr

from surrogate.differences.folder import ResultsFolder
from surrogate.differences.part import SIDES, Part
from surrogate.runs.dataset import LEVEL, LEVELS, counts, output_names

#: Significant digits in which inputs must agree to be the same.
DIGITS = 12
#: Answers that differ by less than this share of their size are equal.
EQUAL = 1e-12

Key = tuple[tuple[str, Any], ...]


def counts_part(a: ResultsFolder, b: ResultsFolder) -> Part:
    """Rows by status, and points that only one side has."""
    title = "Runs"
    if a.runs is None or b.runs is None:
        return Part("runs", title, ("One of the runs datasets cannot be read.",))
    of_a, of_b = counts(a.runs), counts(b.runs)
    rows = [
        {"what": status.replace("_", " "), "a": of_a[status], "b": of_b[status]}
        for status in of_a
        if of_a[status] or of_b[status]
    ]
    keys_a, keys_b = set(_keys(a.runs)), set(_keys(b.runs))
    rows += [
        {"what": "different points", "a": len(keys_a), "b": len(keys_b)},
        {"what": "points only here", "a": len(keys_a - keys_b), "b": len(keys_b - keys_a)},
    ]
    shared = len(keys_a & keys_b)
    said = f"{shared} points, with all inputs equal, are on both sides."
    if shared == len(keys_a) == len(keys_b):
        said = f"The same {shared} points are on both sides."
    return Part("runs", title, (said,), {"what": "", **SIDES}, rows)


def answers_part(a: ResultsFolder, b: ResultsFolder) -> Part:
    """Outputs of equal inputs: how many differ, and by how much."""
    title = "Answers to equal inputs"
    if a.runs is None or b.runs is None:
        return Part("answers", title)
    at_a, at_b = _finished(a.runs), _finished(b.runs)
    both = [key for key in at_a if key in at_b]
    if not both:
        return Part("answers", title, ("No point is finished on both sides.",))
    outputs = [name for name in output_names(a.runs) if name in output_names(b.runs)]
    rows = [
        _row(a.runs, b.runs, name, [(at_a[key], at_b[key]) for key in both]) for name in outputs
    ]
    differing = [row["output"] for row in rows if row["differing"]]
    said = (
        f"Answers differ in {', '.join(differing)}."
        if differing
        else f"All answers at the {len(both)} points that both have finished are equal."
    )
    columns = {
        "output": "output",
        "unit": "unit",
        "points": "points",
        "differing": "differ",
        "largest": "largest difference",
        "rms": "RMS difference",
        "share": "RMS / spread of A",
    }
    return Part("answers", title, (said,), columns, rows)


def _keys(runs: xr.Dataset) -> list[Key]:
    """Every input of each row, by name, to `DIGITS` digits."""
    fixed = [
        (str(k), _value(v)) for k, v in json.loads(runs.attrs.get("fixed_inputs", "{}")).items()
    ]
    names = [str(name) for name in runs["parameter"].values]
    names += [LEVEL] if LEVELS in runs.attrs else []
    columns = [[_value(one) for one in runs[name].values.tolist()] for name in names]
    return [
        tuple(sorted([*fixed, *zip(names, row, strict=True)])) for row in zip(*columns, strict=True)
    ]


def _value(value: Any) -> Any:
    return float(f"{value:.{DIGITS}g}") if isinstance(value, int | float) else str(value)


def _finished(runs: xr.Dataset) -> dict[Key, list[int]]:
    """Rows with an answer, by their inputs; replicates have several."""
    found: dict[Key, list[int]] = {}
    for row, (key, status) in enumerate(zip(_keys(runs), runs["status"].values, strict=True)):
        if str(status) == "ok":
            found.setdefault(key, []).append(row)
    return found


def _row(
    a: xr.Dataset, b: xr.Dataset, output: str, pairs: list[tuple[list[int], list[int]]]
) -> Mapping[str, Any]:
    """Differences of means over replicates; of a field the largest at any place."""
    row = {"output": output, "unit": str(b[output].attrs.get("units", "")), **_NOTHING}
    if a[output].shape[1:] != b[output].shape[1:]:
        return row
    mine = np.array([a[output].values[rows].mean(axis=0) for rows, _ in pairs])
    other = np.array([b[output].values[rows].mean(axis=0) for _, rows in pairs])
    mine, other = (one.reshape(len(pairs), -1) for one in (mine, other))
    known = np.isfinite(mine - other).all(axis=1)
    if not known.any():
        return row
    mine, other = mine[known], other[known]
    apart, size = np.abs(other - mine), np.maximum(np.abs(mine), np.abs(other))
    spread, rms = float(np.sqrt(mine.var(axis=0).mean())), float(np.sqrt((apart**2).mean()))
    return row | {
        "points": len(apart),
        "differing": int((apart > EQUAL * size).any(axis=1).sum()),
        "largest": float(apart.max()),
        "rms": rms,
        "share": rms / spread if spread > 0.0 else None,
    }


_NOTHING = {"points": 0, "differing": 0, "largest": None, "rms": None, "share": None}
