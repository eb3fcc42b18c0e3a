"""Probabilities of failure by the surrogates of a study: a job a failure."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr

from surrogate.errors import StudyError
from surrogate.fitting import comparison as comparing
from surrogate.fitting.fit import Fit
from surrogate.reliability.problem import Failure
from surrogate.reliability.solution import Reliability
from surrogate.space.space import Space
from surrogate.stages.fits import Fits
from surrogate.stages.stage import Job
from surrogate.stages.summary import json_data

Reliabilities = Mapping[str, Reliability]


def jobs(
    limits: Mapping[str, Failure], space: Space, fits: Fits, comparison: xr.Dataset | None
) -> list[Job]:
    """An analysis for each failure."""
    best = comparing.best(comparison) if comparison is not None else {}
    return [
        Job(
            f"reliability {problem.name}",
            probability,
            {
                "problem": problem,
                "space": space,
                "fit": comparing.chosen(problem.surrogate, best, fits).get(problem.output),
            },
        )
        for problem in limits.values()
    ]


def probability(problem: Failure, space: Space, fit: Fit | None) -> Reliability:
    """The answer to one; raises `StudyError` where the output could not be fitted."""
    if fit is None:
        raise StudyError(f"reliability {problem.name}: no surrogate of {problem.output}")
    from surrogate.reliability.analyse import analyse  # scipy.optimize: not for other studies

    return analyse(problem, space, fit)


def figures(found: Reliabilities) -> dict[str, Any] | None:
    """JSON data of the answers, by the name of their failure."""
    return {name: _figures(one) for name, one in found.items()} or None


def _figures(one: Reliability) -> dict[str, Any]:
    point = one.design_point
    data: dict[str, Any] = json_data(
        {
            "event": str(one.problem),
            "surrogate": one.surrogate,
            "method": one.estimate.method,
            "probability": one.probability,
            "low": one.low,
            "high": one.high,
            "sampling": {"low": one.sampling[0], "high": one.sampling[1]},
            "surrogate_error": {"low": one.error[0], "high": one.error[1], "how": one.how},
            "reliability_index": one.estimate.beta if one.probability > 0.0 else None,
            "evaluations": one.estimate.evaluations,
            "form": None if point is None else vars(point),
            "sentence": str(one),
        }
    )
    return data


def tree(found: Reliabilities) -> xr.DataTree | None:
    """A group a failure, with the probability of passing each of some values of the output."""
    groups = {f"/{name}": dataset(one) for name, one in found.items()}
    return xr.DataTree.from_dict(groups) if groups else None


def dataset(one: Reliability) -> xr.Dataset:
    """An answer: the probability with its interval, and exceedance over (level)."""
    numbers = {
        "probability": one.probability,
        "low": one.low,
        "high": one.high,
        "sampling_low": one.sampling[0],
        "sampling_high": one.sampling[1],
        "surrogate_low": one.error[0],
        "surrogate_high": one.error[1],
    }
    columns: dict[str, Any] = {name: ((), value) for name, value in numbers.items()}
    columns["exceedance"] = ("level", one.exceedance)
    level = ("level", one.levels, {"units": one.problem.unit})
    found = xr.Dataset(
        columns, {"level": level}, {"event": str(one.problem), "method": one.estimate.method}
    )
    point = one.design_point
    if point is not None:
        found["beta"] = ((), point.beta)
        found = found.assign_coords(parameter=np.array(list(point.inputs)))
        found["design_point"] = ("parameter", list(point.inputs.values()))
        found["importance"] = ("parameter", list(point.factors.values()))
    return found
