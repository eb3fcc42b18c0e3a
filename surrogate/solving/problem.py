"""What is asked: goals, limits, and what each input is to the one who asks."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from surrogate.fitting.best import BEST
from surrogate.solving.goals import Desire, Goal, Objective, Target
from surrogate.space.constraints import Relation

#: How surely limits are to be kept unless the study says otherwise.
SURE = 0.9


@dataclass(frozen=True)
class Problem:
    """Inputs that reach a goal.

    goals        targets, objectives or desires, of one kind
    limits       inequalities between outputs and inputs that the answer must keep
    free         parameters to choose
    uncertain    parameters that nobody controls: they follow the study's law
    held         the other parameters, in their units
    fixed        constants that limits name, in their units
    probability  how surely goal and limits are to be met; None: limits with `SURE`, and
                 objectives by their mean
    candidates   how many answers at most
    surrogate    whose word counts: a name, or best
    """

    name: str
    goals: tuple[Goal, ...]
    limits: tuple[Relation, ...] = ()
    free: tuple[str, ...] = ()
    uncertain: tuple[str, ...] = ()
    held: Mapping[str, float | str] = field(default_factory=dict)
    fixed: Mapping[str, float] = field(default_factory=dict)
    probability: float | None = None
    candidates: int = 5
    surrogate: str = BEST

    @property
    def sure(self) -> float:
        """How surely goal and limits are to be met."""
        return SURE if self.probability is None else self.probability

    @property
    def targets(self) -> tuple[Target, ...]:
        """The goals that are targets."""
        return tuple(one for one in self.goals if isinstance(one, Target))

    @property
    def objectives(self) -> tuple[Objective, ...]:
        """The goals to push."""
        return tuple(one for one in self.goals if isinstance(one, Objective))

    @property
    def desires(self) -> tuple[Desire, ...]:
        """The goals with a desirability."""
        return tuple(one for one in self.goals if isinstance(one, Desire))

    def __str__(self) -> str:
        """The goal in words."""
        goals = ", ".join(map(str, self.goals))
        limits = " and ".join(one.text for one in self.limits)
        return " such that ".join(part for part in (goals, limits) if part)

    def outputs(self, offered: Mapping[str, object]) -> tuple[str, ...]:
        """The outputs that goals and limits name, among those `offered`."""
        named = [one.output for one in self.goals]
        named += [name for one in self.limits for name in one.names if name in offered]
        return tuple(dict.fromkeys(named))
