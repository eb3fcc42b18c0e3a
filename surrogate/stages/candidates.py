"""Inputs that reach the goals of a study, by its surrogates: a job a goal."""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr

from surrogate.errors import StudyError
from surrogate.fitting import comparison as comparing
from surrogate.fitting.fit import Fit
from surrogate.solving.problem import Problem
from surrogate.solving.solution import Solution
from surrogate.space.space import Space
from surrogate.stages.fits import Fits
from surrogate.stages.stage import Job


def jobs(
    problems: Mapping[str, Problem],
    space: Space,
    recorded: bool,
    fits: Fits,
    comparison: xr.Dataset | None,
) -> list[Job]:
    """A search for each goal; recorded: the runs are rows of a table."""
    return [
        Job(
            f"solve {problem.name}",
            candidates,
            {
                "problem": problem,
                "space": space,
                "recorded": recorded,
                "fits": fits_for(problem, fits, comparison),
            },
        )
        for problem in problems.values()
    ]


def candidates(problem: Problem, space: Space, recorded: bool, fits: Mapping[str, Fit]) -> Solution:
    """The solution of one problem; raises `StudyError` where an output could not be fitted."""
    named = [one.output for one in problem.goals]
    named += [name for limit in problem.limits for name in limit.names]
    lacking = [
        name
        for name in dict.fromkeys(named)
        if name not in fits and name not in space.names and name not in problem.fixed
    ]
    if lacking:
        raise StudyError(f"solve {problem.name}: no surrogate of {', '.join(lacking)}")
    from surrogate.solving.solve import solve  # scipy.stats: not for studies without goals

    return solve(problem, space, fits, among=recorded)


def fits_for(problem: Problem, fits: Fits, comparison: xr.Dataset | None) -> dict[str, Fit]:
    """The fit of each output that the problem names, as far as there is one."""
    best = comparing.best(comparison) if comparison is not None else {}
    offered = dict.fromkeys(output for by_output in fits.values() for output in by_output)
    found = comparing.chosen(problem.surrogate, best, fits)
    return {output: found[output] for output in problem.outputs(offered) if output in found}
