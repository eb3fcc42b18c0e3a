"""What is found for a problem: candidates, and what is told of each."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from surrogate.solving.problem import Problem
from surrogate.solving.promise import Verified


@dataclass(frozen=True)
class Predicted:
    """Expectation of an output at a candidate, and the ends of its 95 % interval.

    The interval holds the surrogate's error and the uncertain inputs.
    """

    value: float
    low: float
    high: float


@dataclass(frozen=True)
class Candidate:
    """Inputs that were found.

    inputs        of the free parameters, in their units
    predicted     output -> what the surrogates expect
    probability   that the solver meets goal and limits here
    promised      output -> value that an objective keeps with the problem's probability
    desirability  of the predicted values, from 0 to 1; None without desires
    verified      what the solver says there; None before it was asked
    """

    inputs: Mapping[str, float | str]
    predicted: Mapping[str, Predicted]
    probability: float
    promised: Mapping[str, float]
    desirability: float | None
    verified: Verified | None = None


@dataclass(frozen=True)
class Solution:
    """What was found for a problem.

    candidates  the best first; of several objectives the Pareto front, by the first of them
    ends        output -> where its target ends
    surrogates  output -> the surrogate whose word it is
    """

    problem: Problem
    candidates: tuple[Candidate, ...]
    ends: Mapping[str, tuple[float, float]]
    surrogates: Mapping[str, str]

    @property
    def goal(self) -> str:
        """What was wanted, with the ends of targets that the study left open."""
        open_ends = [
            f"{one.output} counts as hit from {low:.4g} to {high:.4g}"
            for one in self.problem.targets
            if one.low is None
            for low, high in [self.ends[one.output]]
        ]
        return "; ".join([str(self.problem), *open_ends])

    @property
    def sure(self) -> bool:
        """Whether the best candidate meets goal and limits as surely as was asked."""
        return self.candidates[0].probability >= self.problem.sure

    @property
    def tested(self) -> str:
        """How the solver's own runs agree with the probabilities; "" before there are any."""
        checked = [(one.probability, one.verified) for one in self.candidates if one.verified]
        runs, failed = (sum(getattr(v, part) for _, v in checked) for part in ("runs", "failed"))
        lost = f"{failed} of the solver's runs at the candidates failed."
        if not runs:
            return lost if failed else ""
        said = (
            f"The solver was run at {runs} point{'s' * (runs > 1)}: "
            f"{sum(v.met for _, v in checked)} met the goal; the probabilities promise "
            f"{sum(p * v.runs for p, v in checked):.3g}."
        )
        return f"{said} {lost}" if failed else said

    def __str__(self) -> str:
        """What was found, in one sentence."""
        best, asked = self.candidates[0], f"{100 * self.problem.sure:.3g} %"
        if len(self.problem.objectives) > 1:
            return f"{len(self.candidates)} inputs of which none is better in all objectives."
        at = ", ".join(
            f"{n} {v:.4g}" if isinstance(v, float | int) else f"{n} {v}"
            for n, v in best.inputs.items()
        )
        if not self.sure:
            return (
                f"No inputs meet the goal with probability {asked}; the best have "
                f"{chance(best.probability)}: {at}."
            )
        return f"Met with probability {chance(best.probability)} at {at}."


def chance(probability: float) -> str:
    """A probability in words that claim no more than the draws can tell."""
    if probability > 0.995:
        return "> 99.5 %"
    return "< 0.5 %" if probability < 0.005 else f"{100 * probability:.3g} %"
