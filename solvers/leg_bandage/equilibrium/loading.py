"""The way to equilibrium: lay, bond, slide.

BOND   contacts bilateral and sticking, the whole tension at once
SLIDE  unilateral contact and Coulomb friction; the bandage moves until it rests

In mode `progressive` the bandage is bonded turn by turn, each turn laid on the leg as the
turns before have deformed it.
"""

from __future__ import annotations

import numpy as np

from surrogate.errors import SolverError

from .model import Model
from .newton import NotConverged
from .pseudo_transient import pseudo_transient

FIRST_VISCOSITY = 2e-3
BONDED_VISCOSITY = 2e-2, 1e-3
"""MPa/mm, of sliding, and first and last while bonded, should one step not do."""


def bond(model: Model, u: np.ndarray) -> np.ndarray:
    """Equilibrium with all contacts stuck, from u; raises SolverError.

    When that is too far for one step the bandage moves towards it; what is then left of
    the way is left to sliding.
    """
    problem = model.problem
    for contact in problem.contacts:
        contact.bond()
    problem.viscosity.coefficient = 0.0
    state = problem.state()
    try:
        u, _ = problem.newton(u, problem.tolerances.passing)
        problem.cost.steps += 1
        return u
    except NotConverged:
        problem.restore(state)
        problem.cost.cut_backs += 1
    try:
        return pseudo_transient(problem, u, BONDED_VISCOSITY[0], until=BONDED_VISCOSITY[1])[0]
    except NotConverged as failure:
        raise no_equilibrium(model, "bonding the bandage as laid", failure) from failure


def slide(model: Model, u: np.ndarray, watch=None) -> np.ndarray:
    """Let the bonded bandage slide and follow it to rest; raises SolverError."""
    for contact in model.problem.contacts:
        contact.slide(u)
    try:
        u, model.problem.cost.rest = pseudo_transient(
            model.problem, u, FIRST_VISCOSITY, watch=watch
        )
    except NotConverged as failure:
        raise no_equilibrium(model, "sliding to rest", failure) from failure
    return u


def solve(model: Model, watch=None) -> np.ndarray:
    """Displacements (ndof,) of the bandaged leg at rest."""
    return slide(model, bond(model, np.zeros(model.ndof)), watch)


def no_equilibrium(model: Model, stage: str, failure: NotConverged) -> SolverError:
    """The error that says how far the solution came, what was left and where."""
    problem = model.problem
    node, component = divmod(failure.dof, 3)
    place = model.X[node]
    what = "bandage" if node >= model.strip.offset else "leg"
    return SolverError(
        f"no equilibrium: {stage} stopped after {problem.cost.steps} steps and "
        f"{problem.cost.iterations} Newton iterations at viscosity "
        f"{problem.viscosity.coefficient:.1e} MPa/mm with {failure.residual:.1e} N unbalanced "
        f"({'xyz'[component]} of a point of the {what} at x, y, z = "
        f"{place[0]:.0f}, {place[1]:.0f}, {place[2]:.0f} mm)"
    )
