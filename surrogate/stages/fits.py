"""Every surrogate fitted to every output: surrogate -> output -> Fit."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np
import xarray as xr
from sklearn.base import clone

from surrogate.errors import FitError
from surrogate.estimator import Regressor
from surrogate.fitting import fit as fitting
from surrogate.fitting.fit import Fit
from surrogate.regressors.level_process import LevelRuns
from surrogate.runs import dataset as rundata
from surrogate.space.space import Space
from surrogate.stages.digest import digest, of_object
from surrogate.stages.labour import do
from surrogate.stages.plugin import call
from surrogate.stages.stage import Job, Result

Fits = Mapping[str, Mapping[str, Fit]]


@dataclass(frozen=True)
class Surrogate:
    """One entry of `surrogates:`: an unfitted estimator and the designs it learns from."""

    name: str
    method: str
    estimator: Regressor
    train: tuple[str, ...] = ("train",)


def jobs(
    space: Space, surrogates: Mapping[str, Surrogate], outputs: Iterable[str], runs: xr.Dataset
) -> list[Job]:
    """A fit of each surrogate to each output."""
    return [
        _job(space, surrogate, output, runs)
        for surrogate in surrogates.values()
        for output in outputs
    ]


def _job(space: Space, surrogate: Surrogate, output: str, runs: xr.Dataset) -> Job:
    begun = np.intersect1d(surrogate.train, runs["design"].values.astype(str)).tolist()
    coded, values = rundata.training(runs, output, begun)
    lower = lower_runs(surrogate, output, runs)
    return Job(
        f"{surrogate.name} of {output}",
        fit,
        {
            "space": space,
            "surrogate": surrogate.name,
            "output": output,
            "estimator": surrogate.estimator,
            "coded": coded,
            "values": values,
            "lower": lower,
        },
        digest(
            of_object(surrogate.estimator),
            coded,
            values,
            *(part for one in lower for part in (one.coded, one.values, one.inputs)),
        ),
    )


def learns_from_levels(estimator: Regressor) -> bool:
    """True when the estimator takes the runs of cheaper levels of fidelity, as `lower`."""
    return "lower" in estimator.get_params(deep=False)


def lower_runs(surrogate: Surrogate, output: str, runs: xr.Dataset) -> tuple[LevelRuns, ...]:
    """Good runs of the levels below the truth, cheapest first, for one that learns from them."""
    if not learns_from_levels(surrogate.estimator):
        return ()
    designs = np.intersect1d(surrogate.train, runs["design"].values.astype(str)).tolist()
    names = runs["parameter"].values.tolist()
    told = rundata.described(runs, rundata.LEVELS) if rundata.level_names(runs) else []
    return tuple(
        LevelRuns(
            *rundata.training(runs, output, designs, one["name"]),
            inputs=tuple(names.index(p) for p in one["parameters"]),
        )
        for one in told[:-1]
    )


def with_lower(estimator: Regressor, lower: tuple[LevelRuns, ...]) -> Regressor:
    """The estimator with the runs of cheaper levels; itself without any."""
    return clone(estimator).set_params(lower=lower) if lower else estimator


def fit(
    space: Space,
    surrogate: str,
    output: str,
    estimator: Regressor,
    coded: np.ndarray,
    values: np.ndarray,
    lower: tuple[LevelRuns, ...] = (),
) -> Fit:
    """One fit; raises `FitError` or `PluginError` when it cannot be had.

    lower: runs of cheaper levels of fidelity
    """
    if lower and values.ndim > 1:
        raise FitError(
            f"surrogate '{surrogate}' cannot be fitted to '{output}': co-kriging is for single "
            "numbers; use another surrogate for fields"
        )
    found: Fit = call(
        f"surrogate '{surrogate}' cannot be fitted to '{output}'",
        fitting.fit,
        space,
        coded,
        values,
        with_lower(estimator, lower),
        surrogate=surrogate,
        output=output,
    )
    return found


def gather(done: Iterable[tuple[Job, Result]]) -> Result:
    """The fits that could be had, by surrogate and output, and why others could not."""
    fits: dict[str, dict[str, Fit]] = {}
    lost: list[str] = []
    for job, result in done:
        by_output = fits.setdefault(job.arguments["surrogate"], {})
        if result.value is not None:
            by_output[job.arguments["output"]] = result.value
        lost += result.not_done
    return Result(fits, tuple(lost))


def all_fits(
    space: Space, surrogates: Mapping[str, Surrogate], outputs: Iterable[str], runs: xr.Dataset
) -> dict[str, dict[str, Fit]]:
    """Every fit that can be had, one after the other."""
    found: dict[str, dict[str, Fit]] = gather(
        (job, do(job)) for job in jobs(space, surrogates, outputs, runs)
    ).value
    return found


def unfitted(
    space: Space,
    surrogates: Mapping[str, Surrogate],
    outputs: Iterable[str],
    runs: xr.Dataset,
    fits: Fits,
) -> Iterator[str]:
    """A sentence for each surrogate and output without a fit."""
    for surrogate in surrogates.values():
        for output in outputs:
            if output not in fits.get(surrogate.name, {}):
                yield from do(_job(space, surrogate, output, runs)).not_done
