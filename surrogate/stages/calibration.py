"""What measurements say about inputs, by the surrogates, and what the solver says to that."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any

import xarray as xr

from surrogate.calibration.calibrate import calibrate, fits_for
from surrogate.calibration.posterior import Posterior
from surrogate.calibration.problem import Problem
from surrogate.calibration.tested import sentence
from surrogate.calibration.verification import tested
from surrogate.fitting import comparison as comparing
from surrogate.stages.fits import Fits
from surrogate.stages.stage import Job, Result
from surrogate.stages.summary import json_data
from surrogate.stages.verified import CALIBRATION, verifying


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


def calibration(
    runs: xr.Dataset, posterior: Posterior | None, fits: Fits, comparison: xr.Dataset | None
) -> Posterior | None:
    """The posterior with what runs of the solver at its draws say, if there are any."""
    if posterior is None:
        return None
    own = runs.isel(run=verifying(runs, CALIBRATION))
    if not own.sizes["run"]:
        return posterior
    best = comparing.best(comparison) if comparison is not None else {}
    by = fits_for(posterior.problem, best, fits)
    return replace(posterior, tested=tested(posterior, by, own))


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
            "convergence": found.convergence,
            "verification": sentence(found.tested) or None,
            "free": list(problem.free),
            "outputs": [one.output for one in problem.measured],
            "cases": len(problem.labels),
            "discrepancy": problem.discrepancy,
            "surrogates": found.surrogates,
            "unknowns": by_name,
            "sampler": table.attrs,
            "verified": {one.output: one.figures for one in found.tested},
            "notes": list(found.notes),
        }
    )
    return whole
