"""Candidates for a problem: inputs, what is predicted there, and how sure it is.

The probability of a candidate is that with which the solver, run there, meets goal and limits,
given the error of the surrogates and the law of the uncertain inputs. It is computed from draws
that took no part in the search.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from surrogate.errors import StudyError
from surrogate.fitting.extrapolation import cloud
from surrogate.fitting.fit import Fit
from surrogate.solving.front import front
from surrogate.solving.merit import Judgement, Merit
from surrogate.solving.outlook import Outlook
from surrogate.solving.problem import Problem
from surrogate.solving.search import POOL, Choice, apart, search
from surrogate.solving.solution import Candidate, Predicted, Solution
from surrogate.space.space import Space

Array = NDArray[np.float64]

#: Draws (of uncertain inputs, of errors for each) in the search and for the answer.
SEARCH, SEARCH_ALONE, ANSWER, ANSWER_ALONE = (64, 16), (1, 1024), (1024, 4), (1, 4096)
#: Candidates lie this far apart, in coded values, as a share of the cube's diagonal.
APART = 0.08
SEARCH_SEED, ANSWER_SEED = 20, 21


def solve(
    problem: Problem,
    space: Space,
    fits: Mapping[str, Fit],
    *,
    among: bool = False,
    seed: int = 0,
) -> Solution:
    """The candidates, from fits (output -> fit) of the outputs that goals and limits name.

    among: the runs are rows of a table, which do not fill the space; candidates lie among them.
    Raises `StudyError` where no inputs may be chosen or an output is no single number.
    """
    for name, fit in fits.items():
        if fit.values.ndim > 1:
            raise StudyError(f"output '{name}' is a field; a goal needs a single number")
    index = {name: j for j, name in enumerate(space.names)}
    uncertain = tuple(index[name] for name in problem.uncertain)
    free = tuple(index[name] for name in problem.free)
    clouds = tuple(cloud(space, fit.coded) for fit in fits.values()) if among else ()
    choice = Choice(space, free, _held(problem, space), clouds)
    drawn = SEARCH if uncertain else SEARCH_ALONE
    merit = Merit(problem, Outlook(space, fits, uncertain, *drawn, SEARCH_SEED + seed, exact=False))
    pool = choice.pool(POOL, seed)
    far = APART * 2.0 * np.sqrt(len(problem.free))
    if len(problem.objectives) > 1:
        found = front(merit, choice, pool, seed)
    else:
        starts = pool[apart(pool, merit.judge(pool).merit, 2 * problem.candidates, far)]
        found = search(choice, lambda X, _: merit.judge(X).merit, starts, seed=seed)
        found = found[
            apart(found, merit.judge(found).merit, problem.candidates, far, least=far / 4)
        ]
    drawn = ANSWER if uncertain else ANSWER_ALONE
    final = Outlook(space, fits, uncertain, *drawn, ANSWER_SEED + seed)
    answer = Merit(problem, final).judge(found)
    order = _order(problem, merit.judge(found), answer)
    return Solution(
        problem,
        tuple(_candidate(problem, space, fits, found[k], _row(answer, k)) for k in order),
        merit.ends,
        {name: fit.surrogate for name, fit in fits.items()},
    )


def _held(problem: Problem, space: Space) -> Array:
    """The coded point of the held values; 0 elsewhere."""
    return np.array(
        [
            p.encode(np.array([problem.held[p.name]]))[0] if p.name in problem.held else 0.0
            for p in space.parameters
        ]
    )


def _order(problem: Problem, searched: Judgement, answer: Judgement) -> NDArray[np.intp]:
    """The best first; a front by its first objective."""
    if len(problem.objectives) > 1:
        first = problem.objectives[0]
        return np.argsort(first.sign * answer.objectives[first.output], kind="stable")
    return np.argsort(-searched.merit, kind="stable")


def _row(answer: Judgement, k: int) -> dict[str, Any]:
    return {
        "probability": float(answer.probability[k]),
        "outcomes": {name: values[k] for name, values in answer.outcomes.items()},
        "objectives": {name: float(values[k]) for name, values in answer.objectives.items()},
        "desirability": None if answer.desirability is None else float(answer.desirability[k]),
    }


def _candidate(
    problem: Problem, space: Space, fits: Mapping[str, Fit], coded: Array, row: Mapping[str, Any]
) -> Candidate:
    physical = space.decode(coded[None, :])
    predicted = {
        name: Predicted(float(values.mean()), *np.quantile(values, (0.025, 0.975)).tolist())
        for name, values in row["outcomes"].items()
    }
    return Candidate(
        {name: physical[name][0].item() for name in problem.free},
        predicted,
        row["probability"],
        row["objectives"] if problem.probability is not None else {},
        row["desirability"],
    )
