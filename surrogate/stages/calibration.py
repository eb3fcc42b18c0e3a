"""What measurements say about inputs, by the surrogates: one job."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import xarray as xr

from surrogate.calibration.calibrate import calibrate, fits_for
from surrogate.calibration.posterior import Posterior
from surrogate.calibration.problem import Problem
from surrogate.fitting import comparison as comparing
from surrogate.stages.fits import Fits
from surrogate.stages.stage import Job, Result
from surrogate.stages.summary import json_data


def jobs(measured: Problem | None, fits: Fits, comparison: xr.Dataset | None) -> list[Job]:
    """The calibration, where the study asks for one."""
    if measured is None:
        return []
    best = comparing.best(comparison) if comparison is not None else {}
    return [Job("calibration", posterior, {"problem": measured, "best": best, "fits": fits})]


def posterior(problem: Problem, best: Mapping[str, str], fits: Fits) -> Posterior:
    """The posterior; raises `StudyError` where it cannot be had."""
    return calibrate(problem, fits_for(problem, best, fits))


def gather(done: Iterable[tuple[Job, Result]]) -> Result:
    """The posterior, or why it could not be had."""
    for _, result in done:
        return result
    return Result(None)


def figures(found: Posterior | None) -> dict[str, Any] | None:
    """JSON data of a posterior."""
    if found is None:
        return None
    problem, table = found.problem, found.figures
    by_name = {
        name: {key: column.sel(unknown=name).values for key, column in table.data_vars.items()}
        for name in table["unknown"].values
    }
    whole: dict[str, Any] = json_data(
        {
            "sentence": str(found),
            "free": list(problem.free),
            "outputs": [one.output for one in problem.measured],
            "cases": len(problem.labels),
            "discrepancy": problem.discrepancy,
            "surrogates": found.surrogates,
            "unknowns": by_name,
            "sampler": table.attrs,
            "notes": list(found.notes),
        }
    )
    return whole
