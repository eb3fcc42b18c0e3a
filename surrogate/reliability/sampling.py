"""The method that sees enough failures, and a probability by it."""

from __future__ import annotations

from surrogate.reliability.crude import crude, of_count
from surrogate.reliability.estimate import Estimate
from surrogate.reliability.limit_state import Function, state_of
from surrogate.reliability.problem import AUTO, Failure
from surrogate.reliability.subset import subset
from surrogate.space.space import Space

#: Points by which the size of a probability is seen; failures among them that suffice.
PILOT, FREQUENT = 2**14, 100
#: Points of crude sampling; of a space with constraints.
POINTS, CONSTRAINED = 2**18, 2**17
#: Points of a level of subset simulation, and its repeats.
LEVEL, REPEATS = 5000, 10


def fitting_method(problem: Failure, space: Space, function: Function, seed: int = 0) -> str:
    """Crude sampling where it sees enough failures, else subset simulation.

    Constraints leave only crude sampling.
    """
    if space.region is not None or problem.method == "crude":
        return "crude"
    if problem.method == AUTO:
        seen = crude(state_of(problem, space, function), samples=PILOT, seed=seed)
        return "crude" if seen.probability * PILOT >= FREQUENT else "subset"
    return "subset"


def sampled(
    method: str,
    problem: Failure,
    space: Space,
    function: Function,
    *,
    seed: int = 0,
    confidence: float = 0.95,
    level: int = LEVEL,
    repeats: int = REPEATS,
) -> Estimate:
    """The probability for a function of coded points, by crude sampling or subset simulation.

    level  points of a level of subset simulation, repeats of it
    """
    if space.region is not None:
        values = function(space.sample(CONSTRAINED, seed=seed))
        failures = int((problem.margin(values) <= 0.0).sum())
        return of_count(failures, CONSTRAINED, confidence)
    state = state_of(problem, space, function)
    if method == "crude":
        return crude(state, samples=POINTS, seed=seed, confidence=confidence)
    return subset(state, samples=level, repeats=repeats, seed=seed, confidence=confidence)
