"""The posterior put to the test: what the solver says at some of its draws.

A run is made at a draw of the free inputs and at the known inputs of a case, the cases in turn. The
solver there is compared with the surrogate, and with the measurements of the case: their mean
square difference is that of error of measurement and discrepancy when the posterior is right.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from surrogate.calibration.posterior import Posterior
from surrogate.calibration.priors import discrepancy_name, error_name
from surrogate.calibration.problem import Measured
from surrogate.calibration.tested import Tested, rms
from surrogate.fitting.fit import Fit

Array = NDArray[np.float64]

#: Draws of the posterior at which the solver is run.
RUNS, SEED = 20, 22
#: Inputs of a run are those of a draw or case when they differ by less than this, in coded values.
SAME = 1e-10


def points(posterior: Posterior, runs: int | None = None) -> dict[str, NDArray[Any]]:
    """Physical inputs of verifying runs, name -> (run,); more runs begin with those of fewer."""
    problem = posterior.problem
    order = np.random.default_rng(SEED).permutation(posterior.draws(problem.free[0]).size)
    chosen = order[: RUNS if runs is None else runs]
    _, first = np.unique(np.round(problem.known_coded, 9), axis=0, return_index=True)
    places = np.resize(np.sort(first), len(chosen))
    known = problem.space.decode(problem.coded[places])
    return {
        name: posterior.draws(name)[chosen] if name in problem.free else known[name]
        for name in problem.space.names
    }


def tested(posterior: Posterior, fits: Mapping[str, Fit], runs: xr.Dataset) -> tuple[Tested, ...]:
    """What runs at draws of this posterior say; others, of an earlier posterior, are left out."""
    problem, done = posterior.problem, runs.isel(run=runs["status"].values.astype(str) == "ok")
    done = done.isel(run=_drawn(posterior, done))
    if not done.sizes["run"]:
        return ()
    coded = problem.space.encode({name: done[name].values for name in problem.space.names})
    known = coded[:, [name not in problem.priors for name in problem.space.names]]
    at = np.all(np.abs(known[:, None] - problem.known_coded[None]) < SAME, axis=2)
    return tuple(
        _tested(posterior, one, fits[one.output], coded, np.asarray(done[one.output].values), at)
        for one in problem.measured
    )


def _tested(
    posterior: Posterior,
    one: Measured,
    fit: Fit,
    coded: Array,
    solver: Array,
    at: NDArray[np.bool_],
) -> Tested:
    low, high = fit.interval(coded)
    rows, cases = np.nonzero(at & one.known)
    differences = one.values[cases] - solver[rows]
    expected = rms(_errors(posterior, one)[cases])
    return Tested(
        one.output,
        one.unit,
        solver,
        fit.predict(coded),
        low,
        high,
        cases,
        rows,
        differences,
        expected,
        posterior.problem.discrepancy,
    )


def _errors(posterior: Posterior, one: Measured) -> Array:
    """(case,) root mean square of error of measurement and discrepancy, by the posterior."""
    squares = one.errors**2
    if one.estimated:
        estimated = np.square(posterior.draws(error_name(one.output))).mean()
        squares = np.where(np.isfinite(squares), squares, estimated)
    if posterior.problem.discrepancy:
        squares = squares + np.square(posterior.draws(discrepancy_name(one.output))).mean()
    return np.asarray(np.sqrt(squares))


def _drawn(posterior: Posterior, runs: xr.Dataset) -> NDArray[np.bool_]:
    """(run,) whose free inputs are a draw of the posterior."""
    problem, space = posterior.problem, posterior.problem.space
    same = np.ones((runs.sizes["run"], posterior.draws(problem.free[0]).size), dtype=bool)
    for name in problem.free:
        there, drawn = (
            np.asarray(space[name].encode(values), dtype=float)
            for values in (runs[name].values, posterior.draws(name))
        )
        same &= np.abs(there[:, None] - drawn[None]) < SAME
    return np.asarray(same.any(axis=1))
