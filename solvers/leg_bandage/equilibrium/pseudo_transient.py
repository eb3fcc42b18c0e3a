"""Pseudo-transient continuation: the motion of the bandage until it rests.

Sliding is a motion, not a load step. Each step is an implicit Euler step of
c A dx/dt = force with a small viscosity c on bandage and skin, so that a bandage that has
let go, and the skin that slips under it, move until friction and geometry hold them again
(Kelley and Keyes 1998). c falls while Newton converges and rises when it does not; no step
starts from a state that has not converged. Units: N, mm, MPa; c in MPa/mm.
"""

from __future__ import annotations

import numpy as np

from .newton import NotConverged, Problem

FALL = 4.0
"""By how much the viscosity falls from step to step at most, and rises after a failure by."""
LONG_MOVE = 1.0
"""mm; the viscosity falls only as long as steps stay shorter; less after failures."""
EASY = 5
"""Newton iterations of a step after which the viscosity may fall fully."""


def pseudo_transient(problem: Problem, u, viscosity: float, until: float = 0.0, watch=None):
    """Follow the bandage until it rests, or until the viscosity is small.

    Returns u and the last viscous traction, MPa. Ends when the viscosity has come down to
    `until`, or, without it, when the bandage rests. From the third on a step starts from
    where the last one was heading; after a failure the viscosity rises and steps are kept
    shorter. watch(step, viscosity, move, iterations) is told about each accepted step.
    Raises NotConverged when the largest viscosity does not help or the steps run out.
    """
    limits, damper, cost = problem.tolerances, problem.viscosity, problem.cost
    smallest, largest = max(until, limits.viscosity[0]), limits.viscosity[1]
    moving, reach, heading = damper.area > 0, LONG_MOVE, np.zeros_like(u)
    left, accepted = (np.inf, 0), 0
    for step in range(limits.steps):
        damper.coefficient, damper.origin = viscosity, u
        state, final = problem.state(), viscosity <= smallest
        try:
            new, iterations = problem.newton(u + heading, limits.force if final else limits.passing)
        except NotConverged as trouble:
            problem.restore(state)
            cost.cut_backs += 1
            left, heading = (trouble.residual, trouble.dof), np.zeros_like(u)
            viscosity, reach = viscosity * FALL, max(0.7 * reach, LONG_MOVE / 4)
            if viscosity > largest:
                break
            continue
        cost.steps += 1
        accepted += 1
        for contact in problem.contacts:
            contact.accept(new)
        change, u = new - u, new
        move = float(np.abs(change[moving]).max())
        if watch:
            watch(step, viscosity, move, iterations)
        handed_over = problem.hand_over(u)
        if final and not handed_over and (until or viscosity * move < limits.rest):
            return u, viscosity * move
        heading = change if accepted > 1 else heading
        fall = np.clip((reach / move) ** 2, 1.0, FALL if iterations <= EASY else FALL / 2)
        viscosity = max(viscosity / fall, smallest)
    raise NotConverged(*left)  # a kept exception would keep its frames, and with them all factors
