"""What happens to a bandage that rests: the leg changes its posture, time goes by.

Each change is followed to rest again under contact and friction, from the state that was
there, so that what has slid stays slid. Times are in minutes, from when the bandage rests.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from surrogate.errors import SolverError

from ..bandage.relaxation import Relaxation
from ..bandage.shell import Shell
from ..tissue.posture import POSTURES, Posture, muscle_share
from .loading import no_equilibrium
from .model import Model
from .newton import NotConverged
from .pseudo_transient import pseudo_transient

FIRST_VISCOSITY = 1e-4
"""MPa/mm, of a change that moves skin and bandage by a millimetre or two."""
FLUID_MINUTES = 37.0
"""Time of the slow fall of the calf's fluid in bed rest (Berg, Tedner, Tesch 1993)."""
STEPS = (2.0, 10.0, 30.0, 90.0, 240.0, 720.0, 1440.0)
"""Ends of the steps in time, minutes; a held stretch relaxes exactly whatever they are."""

Array = NDArray[np.float64]


@dataclass
class Worn:
    """A bandage on a leg as it is worn, at the moment.

    u          (ndof,) displacements at rest
    minutes    since the bandage came to rest
    posture    of the leg
    fluid_loss share of the tissue's volume that is lost in the end
    """

    model: Model
    u: Array
    minutes: float = 0.0
    posture: Posture = POSTURES["lying"]
    fluid_loss: float = 0.0

    def relaxing(self, series: Relaxation) -> None:
        """Let the fabric relax from now on."""
        for shell in self._shells():
            shell.relaxing(self.u, series)

    def take(self, posture: Posture) -> None:
        """Change the posture at once; raises SolverError."""
        self.posture = posture
        self._rest(0.0, "changing the posture")

    def wait_until(self, minutes: float) -> None:
        """Let the time go by in `STEPS`; raises SolverError."""
        for end in (*(step for step in STEPS if self.minutes < step < minutes), minutes):
            step, self.minutes = end - self.minutes, end
            self._rest(step, f"{end:g} minutes after it was laid")

    def aside(self, look: Callable[[], Any]) -> Any:
        """What `look` answers, with everything that it did undone."""
        shells, problem = self._shells(), self.model.problem
        kept = self.u, self.minutes, self.posture, problem.state()
        cost = replace(problem.cost, seconds=dict(problem.cost.seconds))
        memories = [shell.memory for shell in shells]
        try:
            return look()
        finally:
            self.u, self.minutes, self.posture, state = kept
            problem.restore(state)
            problem.cost = cost
            for shell, memory in zip(shells, memories, strict=True):
                shell.memory = memory
            self._grow()

    def _shells(self) -> list[Shell]:
        return [part for part in self.model.problem.others if isinstance(part, Shell)]

    def _grow(self) -> None:
        share, posture = muscle_share(self.model.mesh), self.posture
        left = 1 + self.fluid_loss * np.expm1(-self.minutes / FLUID_MINUTES)
        volume = posture.elsewhere + share * (posture.muscle - posture.elsewhere)
        self.model.tissue.grow(left * volume, 1 + share * (posture.stiffening - 1))

    def _rest(self, step: float, stage: str) -> None:
        self._grow()
        for shell in self._shells():
            shell.wait(step)
        problem = self.model.problem
        try:
            self.u, _ = pseudo_transient(problem, self.u, FIRST_VISCOSITY)
        except NotConverged as failure:
            raise no_equilibrium(self.model, stage, failure) from failure
        for shell in self._shells():
            shell.accept(self.u)


def worn(model: Model, u: Array, fluid_loss: float = 0.0) -> Worn:
    """A bandage that has come to rest on a leg that lies; raises SolverError for a loss of all."""
    if not 0 <= fluid_loss < 1:
        raise SolverError(f"fluid_loss: {fluid_loss:g} is a share of the tissue, below 1")
    return Worn(model, u, fluid_loss=fluid_loss)
