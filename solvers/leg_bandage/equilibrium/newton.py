"""One nonlinear system, solved by Newton's method at a fixed viscosity and contact law.

The parts are summed into one residual and tangent. Units: N, mm, MPa.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from surrogate.errors import SolverError

from ..algebra.system import System
from ..contact.point_to_surface import Contact
from ..contact.sparsity import PatternOutgrown
from .viscosity import Viscosity


@dataclass(frozen=True)
class Tolerances:
    """When a state counts as in equilibrium, and what a step may cost.

    force        largest unbalanced nodal force of a state, N
    passing      the same for a step on the way, N; `on_mesh` sets both
    rest         largest viscous traction at rest, MPa
    iterations   Newton iterations in a step
    longest      longest move of a node in one iteration, mm
    steps        load steps in all
    viscosity    (smallest, largest) viscosity, MPa/mm
    """

    force: float = 1e-5
    passing: float = 1e-2
    rest: float = 2e-6
    iterations: int = 16
    longest: float = 4.0
    steps: int = 160
    viscosity: tuple[float, float] = (1e-6, 0.5)

    @classmethod
    def on_mesh(cls, area: float) -> Tolerances:
        """Tolerances that are the same tractions on every mesh: area, mm2, is a node's."""
        return cls(force=UNBALANCED * area, passing=PASSING * area)


UNBALANCED, PASSING = 5e-7, 3e-4
"""MPa: unbalanced traction of a final state (0.004 mmHg), and of a state on the way."""
HOPELESS, PATIENCE = 1e2, 3
"""A step is given up when so many tolerances are unbalanced and for so many iterations the
unbalanced force has not come below what it was before."""


@dataclass
class Cost:
    """What a solution took."""

    steps: int = 0
    iterations: int = 0
    cut_backs: int = 0
    analyses: int = 0
    rest: float = 0.0
    seconds: dict[str, float] = field(default_factory=dict)

    def add(self, stage: str, start: float) -> None:
        """Book the time since `start` (perf_counter) under a stage."""
        self.seconds[stage] = self.seconds.get(stage, 0.0) + time.perf_counter() - start


class NotConverged(Exception):
    """A Newton iteration that did not reach its tolerance; carries residual and place."""

    def __init__(self, residual: float, dof: int):
        super().__init__(f"residual {residual:.2e} N at dof {dof}")
        self.residual, self.dof = residual, dof


@dataclass
class Problem:
    """All parts on one vector of displacements u (ndof,), with what Newton needs of them.

    inner     parts with unknowns of their own: `advance`, `state`, `restore`
    contacts  contact parts, whose pattern may have to grow
    others    further parts (shell)
    let_go    hands over contact points at displacements u that slid past what carried them
    """

    inner: list
    contacts: list[Contact]
    others: list
    viscosity: Viscosity
    fixed: np.ndarray
    ndof: int
    solver: str = "auto"
    tolerances: Tolerances = field(default_factory=Tolerances)
    cost: Cost = field(default_factory=Cost)
    system: System | None = None
    let_go: Callable[[np.ndarray], bool] | None = None

    def hand_over(self, u) -> bool:
        """Let contact points that slid past what carried them be carried anew; whether any were."""
        if self.let_go is None or not self.let_go(u):
            return False
        self.system = None
        return True

    def analyse(self) -> None:
        """Sum the patterns and find the order of elimination."""
        start = time.perf_counter()
        parts = [*self.inner, *self.others, *self.contacts, self.viscosity]
        self.system = System(parts, self.ndof, self.fixed, self.solver)
        self.cost.analyses += 1
        self.cost.add("analyse", start)

    def linearise(self, u):
        """Residual (ndof,) and tangent, a function as that of any part."""
        if self.system is None:
            self.analyse()
        start = time.perf_counter()
        answer = self.system.linearise(u)
        self.cost.add("assemble", start)
        return answer

    def _packed(self, u, tangent):
        """Values of the tangent at u; lays contact's pattern out anew when points left it."""
        for _ in range(3):
            start = time.perf_counter()
            try:
                packed = self.system.pack(tangent())
                self.cost.add("assemble", start)
                return packed
            except PatternOutgrown:
                for contact in self.contacts:
                    contact.follow(u)
                self.system = None
                _, tangent = self.linearise(u)
        raise NotConverged(np.inf, 0)

    def state(self):
        """Everything a cut-back has to bring back."""
        return [part.state() for part in (*self.inner, *self.contacts)]

    def restore(self, state) -> None:
        """Undo since `state`."""
        patterns = [contact.pattern for contact in self.contacts]
        for part, old in zip((*self.inner, *self.contacts), state, strict=True):
            part.restore(old)
        if any(one.pattern is not old for one, old in zip(self.contacts, patterns, strict=True)):
            self.system = None

    def newton(self, u, force: float | None = None):
        """Equilibrium at the present laws and viscosity from u; returns u and iterations.

        force is the largest unbalanced nodal force, N; default: that of a final state.

        Steps are capped in length, not forced to lower the residual: contact that closes
        raises it for an iteration or two (non-monotone). Raises NotConverged.
        """
        limits = self.tolerances
        force = limits.force if force is None else force
        residual, tangent = self._linearised(u)
        sizes: list[float] = []
        for iteration in range(1, limits.iterations + 1):
            du = self._increment(residual, self._packed(u, tangent))
            du, step = self._capped(du)
            u, residual, tangent, step = self._moved(u, du, step)
            size = self._size(residual)
            self.cost.iterations += 1
            if size < force and step > 0.99:
                return u, iteration
            sizes.append(size)
            stuck = min(sizes[-PATIENCE:]) >= min(sizes[:-PATIENCE], default=np.inf)
            if not np.isfinite(size) or (stuck and size > HOPELESS * limits.passing):
                break
        free = self.system.free
        raise NotConverged(size, int(free[np.argmax(np.abs(residual[free]))]))

    def _linearised(self, u):
        try:
            return self.linearise(u)
        except SolverError as error:
            raise NotConverged(np.inf, 0) from error

    def _size(self, residual):
        return float(np.abs(residual[self.system.free]).max())

    def _increment(self, residual, packed):
        start = time.perf_counter()
        try:
            du = self.system.solve(packed, -residual)
        except SolverError as error:
            raise NotConverged(np.inf, 0) from error
        self.cost.add("solve", start)
        if not np.isfinite(du).all():
            raise NotConverged(np.inf, int(np.argmin(np.isfinite(du))))
        return du

    def _capped(self, du):
        longest = np.abs(du).max()
        step = min(1.0, self.tolerances.longest / max(longest, 1e-300))
        return step * du, step

    def _moved(self, u, du, step):
        """Take du, or less of it while an element turns inside out."""
        for _ in range(6):
            state = self.state()
            for part in (*self.inner, *self.contacts):
                part.advance(du / step, step)
            try:
                return u + du, *self.linearise(u + du), step
            except SolverError:
                self.restore(state)
                du, step = du / 2, step / 2
        raise NotConverged(np.inf, 0)
