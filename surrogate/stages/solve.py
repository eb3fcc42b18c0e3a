"""Solutions beside what the solver said where it was asked to verify them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import xarray as xr

from surrogate.solving.promise import Verified, met
from surrogate.solving.solution import Candidate, Solution
from surrogate.stages.summary import json_data
from surrogate.stages.verified import verifying

Solutions = Mapping[str, Solution]

#: Inputs of a run are those of a candidate when they differ by less than this share.
SAME = 1e-7


def solve(runs: xr.Dataset, candidates: Solutions) -> dict[str, Solution]:
    """The solutions, each candidate with its verifying runs, if there are any."""
    return {name: verified(solution, runs) for name, solution in candidates.items()}


def verified(solution: Solution, runs: xr.Dataset) -> Solution:
    """A solution with what the runs of its verifying design say."""
    rows = np.flatnonzero(verifying(runs, solution.problem.name))
    return replace(
        solution,
        candidates=tuple(
            replace(one, verified=_verified(solution, one, runs, rows))
            for one in solution.candidates
        ),
    )


def _verified(
    solution: Solution, candidate: Candidate, runs: xr.Dataset, rows: np.ndarray
) -> Verified | None:
    """What the runs at a candidate say; None when there are none."""
    own = runs.isel(run=[row for row in rows if _is_at(candidate, runs, row)])
    if not own.sizes["run"]:
        return None
    done = own.isel(run=np.flatnonzero(own["status"].values.astype(str) == "ok"))
    values = {name: np.asarray(done[name].values, dtype=float) for name in solution.surrogates}
    names = {name for limit in solution.problem.limits for name in limit.names} - set(values)
    columns = {name: done[name].values for name in names if name in done}
    kept = met(solution.problem, solution.ends, columns, values)
    return Verified(
        {name: tuple(column.tolist()) for name, column in values.items()},
        int(kept.sum()),
        own.sizes["run"] - done.sizes["run"],
    )


def _is_at(candidate: Candidate, runs: xr.Dataset, row: int) -> bool:
    for name, value in candidate.inputs.items():
        there = runs[name].values[row]
        if isinstance(value, str):
            if str(there) != value:
                return False
        elif abs(float(there) - value) > SAME * max(abs(value), abs(float(there)), 1e-300):
            return False
    return True


def figures(solutions: Solutions) -> dict[str, Any] | None:
    """JSON data of the solutions, by the name of their problem."""
    return {name: figures_of(one) for name, one in solutions.items()} or None


def figures_of(solution: Solution) -> dict[str, Any]:
    """JSON data of one solution."""
    problem = solution.problem
    return {
        "goal": solution.goal,
        "free": list(problem.free),
        "uncertain": list(problem.uncertain),
        "held": dict(problem.held),
        "surrogates": dict(solution.surrogates),
        "probability_asked": problem.sure,
        "sentence": str(solution),
        "candidates": [_candidate(one) for one in solution.candidates],
    }


def _candidate(one: Candidate) -> dict[str, Any]:
    found: dict[str, Any] = {
        "inputs": dict(one.inputs),
        "predicted": {name: vars(at) for name, at in one.predicted.items()},
        "probability": one.probability,
    }
    if one.promised:
        found["promised"] = dict(one.promised)
    if one.desirability is not None:
        found["desirability"] = one.desirability
    if one.verified is not None:
        found["verified"] = {
            name: float(np.mean(values)) if values else None
            for name, values in one.verified.values.items()
        }
        found["kept"] = {
            "runs": one.verified.runs,
            "met": one.verified.met,
            "failed": one.verified.failed,
        }
    data: dict[str, Any] = json_data(found)
    return data


def tree(solutions: Solutions) -> xr.DataTree | None:
    """A group a problem, with a row a candidate."""
    groups = {f"/{name}": dataset(one) for name, one in solutions.items()}
    return xr.DataTree.from_dict(groups) if groups else None


def dataset(solution: Solution) -> xr.Dataset:
    """A solution over (candidate): inputs, predictions with their ends, probability."""
    rows = solution.candidates
    columns: dict[str, Any] = {
        name: ("candidate", [one.inputs[name] for one in rows]) for name in rows[0].inputs
    }
    for name in rows[0].predicted:
        columns[name] = ("candidate", [one.predicted[name].value for one in rows])
        columns[f"{name}_low"] = ("candidate", [one.predicted[name].low for one in rows])
        columns[f"{name}_high"] = ("candidate", [one.predicted[name].high for one in rows])
    columns["probability"] = ("candidate", [one.probability for one in rows])
    return xr.Dataset(columns, {"candidate": np.arange(len(rows))}, {"goal": str(solution.problem)})
