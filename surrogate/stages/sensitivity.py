"""Indices of every output, read from the surrogate that the study names, or the best one."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import xarray as xr

from surrogate.fitting import comparison as comparing
from surrogate.fitting.best import BEST
from surrogate.fitting.fit import Fit
from surrogate.fitting.noise import q2_of_mean
from surrogate.runs import dataset as rundata
from surrogate.sensitivity.given_data import Runs
from surrogate.sensitivity.independence import needs_no_surrogate
from surrogate.sensitivity.table import combine
from surrogate.space.space import Space
from surrogate.stages.fits import Fits
from surrogate.stages.plugin import call, parameters_of
from surrogate.stages.stage import Job, Result


@dataclass(frozen=True)
class SensitivityMethod:
    """The entry `sensitivity:`: a function, its options, the surrogate it reads, groups."""

    name: str
    function: Any
    options: Mapping[str, Any]
    surrogate: str = BEST
    confidence: float = 0.95
    groups: Mapping[str, tuple[str, ...]] = field(default_factory=dict)


def jobs(
    sensitivity_method: SensitivityMethod | None,
    space: Space,
    outputs: Iterable[str],
    runs: xr.Dataset,
    fits: Fits,
    comparison: xr.Dataset | None,
) -> list[Job]:
    """The indices of each output; no job when none are asked for or nothing was fitted."""
    if sensitivity_method is None:
        return []
    read: dict[str, tuple[Fit | Runs, float]]
    if needs_no_surrogate(sensitivity_method.function):
        read = {output: (_table(runs, output), math.nan) for output in outputs}
    elif comparison is None:
        return []
    else:
        chosen = analysed(sensitivity_method, fits, comparison)
        read = {output: (fit, _q2(comparison, fit)) for output, fit in chosen.items()}
    return [
        Job(
            f"{sensitivity_method.name} of {output}",
            indices,
            {"method": sensitivity_method, "space": space, "fit": fit, "q2": q2},
        )
        for output, (fit, q2) in read.items()
    ]


def _table(runs: xr.Dataset, output: str) -> Runs:
    """All finished runs of one output, whatever their design.

    A run of a deterministic solver that several designs share counts once.
    """
    designs = dict.fromkeys(runs["design"].values.tolist())
    coded, values = rundata.training(runs, output, designs)
    if str(runs.attrs.get("deterministic", "true")).lower() != "false":
        once = np.sort(np.unique(np.round(coded, 9), axis=0, return_index=True)[1])
        coded, values = coded[once], values[once]
    return Runs(output, coded, values)


def analysed(method: SensitivityMethod, fits: Fits, comparison: xr.Dataset) -> dict[str, Fit]:
    """The fit of each output that sensitivity reads."""
    return comparing.chosen(method.surrogate, comparing.best(comparison), fits)


def indices(method: SensitivityMethod, space: Space, fit: Fit | Runs, q2: float) -> xr.Dataset:
    """Indices of one output; the method is told what it asks for besides its options."""
    taken = parameters_of(method.function)
    offered = {"seed": 0, "q2": q2, "groups": method.groups}
    told = {name: value for name, value in offered.items() if name in taken}
    found: xr.Dataset = call(
        f"output '{fit.output}'",
        method.function,
        fit,
        space,
        confidence=method.confidence,
        **told | dict(method.options),
    )
    return found


def _q2(comparison: xr.Dataset, fit: Fit) -> float:
    """Q2 that indices go by: of the mean answer where replicates show the noise.

    Else that of the test design where there is one, or of the left-out predictions.
    """
    of_mean = q2_of_mean(fit)
    if of_mean is not None:
        return of_mean
    row = comparison.sel(surrogate=fit.surrogate, output=fit.output)
    return float(row["q2_test"] if np.isfinite(row["q2_test"]) else row["q2_cv"])


def gather(done: Iterable[tuple[Job, Result]]) -> Result:
    """One dataset of all outputs; nothing when an output could not be analysed."""
    results = [result for _, result in done]
    lost = [sentence for result in results for sentence in result.not_done]
    if lost:
        return Result(None, (f"no sensitivity indices: {lost[0]}",))
    return Result(combine([result.value for result in results]) if results else None)


def all_indices(
    method: SensitivityMethod | None,
    space: Space,
    outputs: Iterable[str],
    runs: xr.Dataset,
    fits: Fits,
    comparison: xr.Dataset | None,
) -> xr.Dataset | None:
    """The indices of all outputs, one after the other; raises what keeps one from being had."""
    asked = jobs(method, space, outputs, runs, fits, comparison)
    found = [job.function(**job.arguments) for job in asked]
    return combine(found) if found else None
