"""Pressure that follows a deforming surface: the load of the verification problems.

A pressure p pushes against the normal n of the deformed surface, with the virtual work
-p int v . n da = -p int v . (x_1 x x_2) d(xi) for tangents x_1, x_2 along the surface's
parameters (Simo, Taylor and Wriggers 1991). Units: N, mm, MPa.
"""

from __future__ import annotations

import numpy as np

from ..algebra.system import Tangent
from ..bandage.shell import Shell
from ..tissue.mesh import LegMesh


class FollowerPressure:
    """A mechanical part: uniform pressure on a surface of interpolated points.

    points    (n_elements, n_local) numbers of the points that shape each element;
              dof = 3 * point + component
    rest      (n_points, 3) what is added to u to get the points' places
    shapes    (3, n_quadrature, n_local): value and both parameter derivatives of the shape
              functions, the same in each element
    weights   (n_quadrature,) quadrature weights in parameter space
    pressure  MPa, positive against the normal x_1 x x_2
    n_dofs    length of the whole vector of unknowns
    """

    def __init__(self, points, rest, shapes, weights, pressure: float, n_dofs: int):
        self.points, self.shapes, self.weights = points, shapes, weights
        self.rest, self.pressure, self.n_dofs = rest, pressure, n_dofs
        self.dofs = 3 * points[:, :, None] + np.arange(3)
        shape = (*points.shape, 3, points.shape[1], 3)
        self.rows = np.broadcast_to(self.dofs[:, :, :, None, None], shape).ravel().astype(np.int32)
        self.cols = np.broadcast_to(self.dofs[:, None, None], shape).ravel().astype(np.int32)

    def linearise(self, u: np.ndarray) -> tuple[np.ndarray, Tangent]:
        """Minus the load (n_dofs,) and its tangent, which is not symmetric."""
        places = self.rest[self.points] + u[self.dofs]
        value, *slopes = self.shapes
        first, second = (np.einsum("qa,eai->eqi", slope, places) for slope in slopes)
        scale = self.pressure * self.weights
        force = np.einsum("q,qa,eqi->eai", scale, value, np.cross(first, second))
        residual = np.bincount(self.dofs.ravel(), force.ravel(), minlength=self.n_dofs)

        def tangent():
            values = np.einsum("q,qa,qb,eqij->eaibj", scale, value, slopes[1], _skew(first))
            values -= np.einsum("q,qa,qb,eqij->eaibj", scale, value, slopes[0], _skew(second))
            return values.ravel()

        return residual, tangent


def skin_pressure(leg: LegMesh, pressure: float) -> FollowerPressure:
    """Uniform pressure (MPa) on the skin of a leg, pushing inwards."""
    skin = leg.skin
    around = np.roll(skin, -1, axis=0)
    points = np.stack([skin[:, :-1], around[:, :-1], skin[:, 1:], around[:, 1:]], axis=-1)
    gauss = 0.5 + np.array([-1, 1]) / np.sqrt(12)
    x, y = (axis.ravel() for axis in np.meshgrid(gauss, gauss))
    shapes = np.array(
        [
            [(1 - x) * (1 - y), x * (1 - y), (1 - x) * y, x * y],
            [y - 1, 1 - y, -y, y],
            [x - 1, -x, 1 - x, x],
        ]
    ).swapaxes(1, 2)
    return FollowerPressure(
        points.reshape(-1, 4), leg.mesh.p.T, shapes, np.full(4, 0.25), pressure, leg.n_dofs
    )


def bandage_pressure(shell: Shell, pressure: float) -> FollowerPressure:
    """Uniform pressure (MPa) on a bandage, against its normal a1 x a2."""
    shapes = np.concatenate([shell.values[None], shell.slopes[:2]])
    return FollowerPressure(
        shell.points, shell.start, shapes, shell.weights, pressure, shell.n_dofs
    )


def _skew(a: np.ndarray) -> np.ndarray:
    """Matrices (..., 3, 3) that take b to a x b."""
    return np.cross(a[..., None, :], np.eye(3)).swapaxes(-1, -2)
