"""Wrapping turn by turn on the leg as the turns before have deformed it.

Each turn is laid on the deformed skin, on top of the turns before, bonded, and brought to
equilibrium; only the whole bandage then slides. The rows of elements keep their
rest length, so on a leg that has given way the same bandage goes a little farther round.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from scipy.interpolate import CubicSpline

from ..surfaces.skin import Skin
from ..tissue.mesh import LegMesh
from ..wrapping.lay import Lay, lay_rows
from ..wrapping.spiral import Wrap, midline_arc
from ..wrapping.turns import Turn
from .loading import bond, slide
from .model import Model, build, skin_parameters


def deformed_skin(mesh: LegMesh, u: np.ndarray):
    """The skin at displacements u as a surface (theta, z, d_theta, d_z) to wrap."""
    skin, count = Skin(mesh.skin), mesh.mesh.nvertices
    x = mesh.mesh.p.T + u.reshape(-1, 3)[:count]
    rates = len(mesh.theta) / (2 * np.pi), 1 / (mesh.z[1] - mesh.z[0])

    def surface(theta, z, d_theta=0, d_z=0):
        theta, z = np.broadcast_arrays(theta, z)
        xi = skin_parameters(mesh, np.stack([theta, z], -1)).reshape(-1, 2)
        jet = skin.at(xi, x)[:, d_theta + 2 * d_z]
        scale = rates[0] ** d_theta * rates[1] ** d_z
        return (scale * jet).reshape(*theta.shape, 3)

    return surface


def wrap_and_solve(
    mesh: LegMesh, laid: Lay, wrap: Wrap, watch=None, **more
) -> tuple[Model, np.ndarray]:
    """Wrap on the deforming leg and let slide; returns the model and u (ndof,).

    laid is the lay on the undeformed leg: it gives the rows and their rest length.
    more is what `build` takes besides mesh, lay and wrap. Raises SolverError.
    """
    surface = deformed_skin(mesh, np.zeros(mesh.n_dofs))
    steps = np.diff(_arc(surface, wrap)(laid.theta))
    model, u = None, np.zeros(mesh.n_dofs)
    for rows in _rows_after_each_turn(laid):
        now = _lay_on(surface, laid, wrap, steps[:rows], model)
        before, model = model, build(mesh, now, wrap, **more)
        start = np.zeros(model.ndof)
        if before is None:
            start[: mesh.n_dofs] = u
        else:
            kept = mesh.n_dofs + 3 * (_kept_rows(before) + 2) * (laid.strip.nw + 2)
            start[:kept] = u[:kept]
            _carry_on(model, before, start)
        u = bond(model, start)
        surface = deformed_skin(mesh, u[: mesh.n_dofs])
    return model, slide(model, u, watch)


def _rows_after_each_turn(laid: Lay) -> list[int]:
    """Number of rows when each turn is complete; what is left of a turn joins the last."""
    angle = laid.theta - laid.theta[0]
    whole = math.ceil(angle[-1] / (2 * np.pi) - 0.25)
    inner = [int(np.searchsorted(angle, 2 * np.pi * turn)) for turn in range(1, whole)]
    return [*inner, len(angle) - 1]


def _kept_rows(model: Model) -> int:
    """Rows that stay where they were laid: all but the loose end, which is laid again."""
    return max(model.strip.ns - 2, 0)


def _arc(surface, wrap: Wrap) -> CubicSpline:
    """Running length of the midline on a bare surface as a function of its angle."""
    return CubicSpline(*midline_arc(surface, wrap))


def _lay_on(surface, laid: Lay, wrap: Wrap, steps, model: Model | None) -> Lay:
    """The rows of the model so far as they were laid, and the next ones on `surface`.

    steps (rows,) are lengths of the rows on the bare surface.
    """
    arc = _arc(surface, wrap)
    angles, lengths = midline_arc(surface, wrap)
    back = CubicSpline(lengths, angles)
    kept = laid.theta[:1] if model is None else model.lay.theta
    done = len(kept) - 1
    ends = arc(kept[-1]) + np.cumsum(np.append(steps[done:], steps[-1]))
    knots = np.concatenate([[2 * kept[0] - back(arc(kept[0]) + steps[0])], kept, back(ends)])
    now = lay_rows(surface, wrap, knots, laid.strip.nw)
    now = replace(now, lengths=np.full(len(steps), laid.lengths.mean()))
    if model is None:
        return now
    rows, old = _kept_rows(model), model.lay

    def join(before, after):
        return np.concatenate([before[:rows], after[rows:]])

    joined = {
        name: join(getattr(old, name), getattr(now, name))
        for name in ("area", "density", "skin", "layers")
    }
    beneath = tuple(
        Turn(ours.bandage, join(ours.xi, theirs.xi), join(ours.share, theirs.share))
        for ours, theirs in zip(old.beneath, now.beneath, strict=True)
    )
    points = (rows + 2) * (laid.strip.nw + 2)
    X = np.concatenate([old.X[:points], now.X[points:]])
    return replace(now, X=X, beneath=beneath, **joined)


def _carry_on(model: Model, before: Model, u: np.ndarray) -> None:
    """Take over what has happened to the rows before, and close the new ones at u."""
    model.problem.cost = before.problem.cost
    model.tissue.restore(before.tissue.state())
    last = _kept_rows(before) * (before.strip.nw + 2)
    for name in ("skin", "layers"):
        part, old = getattr(model, name), getattr(before, name)
        part.close(u)
        part.take_over(old, int(np.searchsorted(before.points[name], last)))
