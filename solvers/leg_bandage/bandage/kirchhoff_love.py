"""Strains of a Kirchhoff-Love surface, and first and second derivatives of its energy.

All is pointwise in Z = (a1, a2, x,11, x,22, x,12), the first and second derivatives of the
surface x(s, w); arrays are (5, ..., 3). Derivations: README.md, after Kiendl, Bletzinger,
Linhard and Wuchner 2009. Units: N, mm.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .fabric import Fabric
from .memory import Memory

TWIST = np.array([1.0, 1.0, 2.0])  # (k11, k22, 2 k12) over (k11, k22, k12)


class Frame(NamedTuple):
    """The deformed surface at its points; `...` stands for the points.

    strains  (6, ...): l1, l2, sin(gamma), k11, k22, 2 k12
    units    (2, ..., 3): a1 / l1, a2 / l2
    normal   (..., 3)
    dual     (2, ..., 3): a^1, a^2 with a^i . a_j = 1 or 0
    bent     (3, 2, ...): Gamma_r^i = x_r . a^i, rows (11, 22, twice 12)
    """

    strains: np.ndarray
    units: np.ndarray
    normal: np.ndarray
    dual: np.ndarray
    bent: np.ndarray


def frame(Z: np.ndarray) -> Frame:
    """Strains and directions at the points of Z (5, ..., 3)."""
    a1, a2 = Z[:2]
    cross = np.cross(a1, a2)
    area = np.sqrt(_dot(cross, cross))[..., None]
    normal = cross / area
    dual = np.stack([np.cross(a2, normal), np.cross(normal, a1)]) / area
    lengths = np.sqrt(_dot(Z[:2], Z[:2]))
    units = Z[:2] / lengths[..., None]
    bent = np.stack([[_dot(x, d) for d in dual] for x in Z[2:]])
    curvatures = [_dot(x, normal) for x in Z[2:]]
    strains = np.stack([*lengths, _dot(*units), *curvatures])
    strains[3:] = (strains[3:].T * TWIST).T
    return Frame(strains, units, normal, dual, (bent.T * TWIST).T)


def energy(Z: np.ndarray, natural: np.ndarray, fabric: Fabric) -> np.ndarray:
    """Energy per undeformed area, (...); natural (6, ...) are the strains that cost none."""
    (e1, e2, shear), curvature = np.split(frame(Z).strains - natural, 2)
    _, Q12, Q22 = fabric.membrane
    stretching = fabric.warp_energy(1 + e1) + Q12 * e1 * e2 + Q22 / 2 * e2**2
    stretching += fabric.G / 2 * shear**2
    return stretching + np.einsum("r...,rs,s...->...", curvature, fabric.bending, curvature) / 2


def membrane_forces(
    strains: np.ndarray, natural: np.ndarray, fabric: Fabric
) -> tuple[np.ndarray, np.ndarray]:
    """Elastic N1, N2, S (3, ...) at strains (6, ...), N/mm, and dN1/dl1 (...)."""
    e1, e2, shear = strains[:3] - natural[:3]
    _, Q12, Q22 = fabric.membrane
    N1, Q11 = fabric.warp_force(1 + e1)
    return np.stack([N1 + Q12 * e2, Q12 * e1 + Q22 * e2, fabric.G * shear]), Q11


def gradient_and_hessian(
    Z: np.ndarray, natural: np.ndarray, fabric: Fabric, slack: bool, memory: Memory | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """dW/dZ (5, ..., 3) and the 17 blocks (17, ..., 3, 3) of d2W/dZ2.

    Blocks: a1 a1, a1 a2, a2 a1, a2 a2; then for r in (11, 22, 12) and i in (1, 2) the block
    x_r a_i at 4 + 2 r + i and its transpose at 10 + 2 r + i; last n n, to be multiplied by the
    bending stiffness for the blocks x_r x_s. `slack` leaves out negative geometric stiffness.
    With a memory the membrane's forces are those of a step in time; bending has none.
    """
    at = frame(Z)
    gradient, hessian = np.empty_like(Z), np.zeros((17, *Z.shape[1:], 3))
    _stretching(at, natural, fabric, slack, memory, gradient, hessian)
    _bending(at, natural, fabric, gradient, hessian)
    return gradient, hessian


def _stretching(
    at: Frame, natural, fabric: Fabric, slack: bool, memory: Memory | None, gradient, hessian
) -> None:
    """Write the membrane's share: dW = N1 dl1 + N2 dl2 + S dc, with c = sin(gamma)."""
    l1, l2, c = at.strains[:3]
    t1, t2 = at.units
    (_, Q12, Q22), G = fabric.membrane, fabric.G
    forces, Q11 = membrane_forces(at.strains, natural, fabric)
    if memory is not None:
        forces = memory.share * forces + memory.carried
        Q11, Q12, Q22, G = (memory.share * stiffness for stiffness in (Q11, Q12, Q22, G))
    N1, N2, S = forces
    p1, p2 = (t2 - _times(c, t1)) / l1[..., None], (t1 - _times(c, t2)) / l2[..., None]
    gradient[0] = _times(N1, t1) + _times(S, p1)
    gradient[1] = _times(N2, t2) + _times(S, p2)

    if slack:
        N1, N2 = np.maximum(N1, 0), np.maximum(N2, 0)
    t11, t22, t12, eye = _outer(t1, t1), _outer(t2, t2), _outer(t1, t2), np.eye(3)
    tension1, tension2, twist = N1 / l1 - S * c / l1**2, N2 / l2 - S * c / l2**2, S / (l1 * l2)
    hessian[0] = _scale(Q11, t11) + _scale(tension1, eye - t11)
    hessian[0] += G * _outer(p1, p1) - _both(_outer(_times(S / l1, t1), p1))
    hessian[3] = Q22 * t22 + _scale(tension2, eye - t22)
    hessian[3] += G * _outer(p2, p2) - _both(_outer(_times(S / l2, t2), p2))
    hessian[1] = Q12 * t12 + G * _outer(p1, p2)
    hessian[1] += _scale(twist, eye - t11 - t22 + _scale(c, t12))
    if slack:
        lift = _negative_part(tension1, tension2, twist)
        for block, value in zip((0, 3, 1), lift, strict=True):
            hessian[block] -= _outer(_times(value, at.normal), at.normal)
    hessian[2] = hessian[1].swapaxes(-1, -2)


def _bending(at: Frame, natural, fabric: Fabric, gradient, hessian) -> None:
    """Add the bending's share: dk_r = n . dx_r - Gamma_r^i n . da_i."""
    D, n = fabric.bending, at.normal
    moment = np.tensordot(D, at.strains[3:] - natural[3:], 1)
    total = np.sum(moment * at.strains[3:], axis=0)
    pull = np.sum(moment[:, None] * at.bent, axis=0)
    gradient[:2] -= _times(pull, n)
    gradient[2:] = _times((moment.T * TWIST).T, n)

    D_bent = np.tensordot(D, at.bent, 1)
    nn = _outer(n, n)
    metric = np.stack([[_dot(a, b) for b in at.dual] for a in at.dual])
    stiffness = np.sum(at.bent[:, :, None] * D_bent[:, None], axis=0) - total * metric
    for i in range(2):
        for j in range(2):
            block = _scale(stiffness[i, j], nn) + _outer(n, _times(pull[j], at.dual[i]))
            hessian[2 * i + j] += block + _outer(_times(pull[i], at.dual[j]), n)
    for r in range(3):
        for i in range(2):
            lever = _times(D_bent[r, i], n) + _times(moment[r], at.dual[i])
            hessian[4 + 2 * r + i] = -TWIST[r] * _outer(lever, n)
            hessian[10 + 2 * r + i] = hessian[4 + 2 * r + i].swapaxes(-1, -2)
    hessian[16] = nn


def _negative_part(a, b, c):
    """Entries (11, 22, 12) of the negative part of the symmetric matrices [[a, c], [c, b]]."""
    mean, spread = (a + b) / 2, np.hypot((a - b) / 2, c)
    high, low = np.minimum(mean + spread, 0), np.minimum(mean - spread, 0)
    slope = np.divide(high - low, 2 * spread, where=spread > 0, out=np.zeros_like(spread))
    centre = (high + low) / 2
    return centre + slope * (a - b) / 2, centre - slope * (a - b) / 2, slope * c


def _dot(a, b):
    return np.einsum("...i,...i->...", a, b)


def _outer(a, b):
    return a[..., :, None] * b[..., None, :]


def _times(scale, vector):
    return scale[..., None] * vector


def _scale(scale, matrix):
    return scale[..., None, None] * matrix


def _both(matrix):
    return matrix + matrix.swapaxes(-1, -2)
