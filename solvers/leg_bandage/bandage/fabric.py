"""The bandage's fabric: orthotropic, with tension nominal in the warp.

Membrane energy per undeformed area, with l1, l2 the stretches along warp and weft and
gamma the change of their angle:

    W = Q11/2 (l1 - 1)^2 + Q12 (l1 - 1)(l2 - 1) + Q22/2 (l2 - 1)^2 + G/2 sin^2(gamma)

which is the compliance of Chassagne et al. 2018, equation 5, in nominal (Biot) strains:
with the weft free the warp tension is T = K1 (l1 - 1), their equation 10. Bending:
M = [[F1, F12, 0], [F12, F2, 0], [0, 0, tau12]] (k11, k22, 2 k12), their equation 6 when
F12 = 0. Units: N, mm.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.interpolate import PchipInterpolator

from surrogate.errors import SolverError

WRINKLING = 0.02
"""Half the compressive strain at which a fabric has wrinkled fully."""


@dataclass(frozen=True)
class Fabric:
    """Elastic constants of a bandage; nothing in it depends on the mesh.

    K1, K2     membrane stiffness along warp (the bandage's length) and weft, N/mm
    nu12       weft contraction over warp extension under warp tension
    G          membrane shear stiffness, N/mm
    F1, F2     bending stiffness along warp and weft, N mm
    tau12      torsion stiffness on the engineering twist 2 k12, N mm
    F12        coupling of the two bendings, N mm
    thickness  mm
    curve      measured (stretch, tension N/mm) pairs of warp tension with the weft free,
               rising from (1, 0); empty: T = K1 (stretch - 1)
    wrinkled   share of the warp stiffness that is left in compression, where a fabric
               wrinkles; reached at a strain of -2 WRINKLING, 1: all of it
    """

    K1: float
    K2: float
    nu12: float
    G: float
    F1: float
    F2: float
    tau12: float
    F12: float = 0.0
    thickness: float = 0.7
    curve: tuple[tuple[float, float], ...] = ()
    wrinkled: float = 1.0

    def __post_init__(self):
        for name in ("K1", "K2", "G", "F1", "F2", "tau12", "thickness"):
            if not getattr(self, name) > 0:
                raise SolverError(f"fabric: {name} = {getattr(self, name)!r} must be above 0")
        if not self.nu12**2 * self.K2 < self.K1:
            limit = np.sqrt(self.K1 / self.K2)
            raise SolverError(
                f"fabric: nu12 = {self.nu12!r} must lie between -{limit:.3g} and {limit:.3g} "
                "(square root of K1 / K2), or the energy has no minimum"
            )
        if not self.F12**2 < self.F1 * self.F2:
            raise SolverError(f"fabric: F12 = {self.F12!r} must be below the root of F1 F2")
        if self.curve:
            _check_curve(self.curve)

    @cached_property
    def membrane(self) -> tuple[float, float, float]:
        """Q11, Q12, Q22 in N/mm."""
        scale = 1 - self.nu12**2 * self.K2 / self.K1
        return self.K1 / scale, self.nu12 * self.K2 / scale, self.K2 / scale

    @cached_property
    def bending(self) -> np.ndarray:
        """Moments per (k11, k22, 2 k12), (3, 3), N mm."""
        return np.array([[self.F1, self.F12, 0], [self.F12, self.F2, 0], [0, 0, self.tau12]])

    def tension(self, stretch: np.ndarray) -> np.ndarray:
        """Warp tension with the weft free, N/mm."""
        return self._tension_and_slope(np.asarray(stretch, dtype=float))[0]

    def warp_energy(self, stretch: np.ndarray) -> np.ndarray:
        """W at l2 = 1 without shear, N/mm: the integral of `warp_force` from 1."""
        _, Q12, Q22 = self.membrane
        held = (self.K1 * (not self.curve) + Q12**2 / Q22) / 2 * (stretch - 1) ** 2
        spared = self._first_slope * self._spared(np.minimum(stretch - 1, 0))[0]
        if not self.curve:
            return held - spared
        inside = np.clip(stretch, self.curve[0][0], self.curve[-1][0])
        tension, slope = self._curve
        beyond = stretch - inside
        work = tension.antiderivative()(inside)
        return held + work + tension(inside) * beyond + slope(inside) / 2 * beyond**2 - spared

    def warp_force(self, stretch: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """dW/dl1 at l2 = 1 and its slope, N/mm: the tension plus what holds the weft."""
        tension, slope = self._tension_and_slope(stretch)
        _, Q12, Q22 = self.membrane
        held = Q12**2 / Q22
        return tension + held * (stretch - 1), slope + held

    def _tension_and_slope(self, stretch):
        tension, slope = self._unwrinkled(stretch)
        if self.wrinkled == 1:
            return tension, slope
        _, spared, softer = self._spared(np.minimum(stretch - 1, 0))
        return tension + self._first_slope * spared, slope - self._first_slope * softer

    @property
    def _first_slope(self):
        return float(self._curve[1](1.0)) if self.curve else self.K1

    def _spared(self, e):
        """What wrinkling takes off at strains e <= 0, for a stiffness of 1.

        Stiffness (1 - wrinkled) min(-e / (2 d), 1) with d = WRINKLING, and its integrals:
        energy taken off, compressive force taken off, stiffness taken off.
        """
        d, lost = WRINKLING, 1 - self.wrinkled
        near, far = np.maximum(e, -2 * d), np.minimum(e + 2 * d, 0)
        energy = -(near**3) / (12 * d) - d * far + far**2 / 2
        force = near**2 / (4 * d) - far
        return lost * energy, lost * force, lost * np.minimum(-e / (2 * d), 1)

    def _unwrinkled(self, stretch):
        if not self.curve:
            return self.K1 * (stretch - 1), np.full_like(stretch, self.K1)
        inside = np.clip(stretch, self.curve[0][0], self.curve[-1][0])
        tension, slope = self._curve
        gradient = slope(inside)
        return tension(inside) + gradient * (stretch - inside), gradient

    @cached_property
    def _curve(self):
        """Monotone C1 interpolant of the tension (Fritsch and Butland 1984) and its slope."""
        stretch, tension = np.array(self.curve).T
        interpolant = PchipInterpolator(stretch, tension)
        return interpolant, interpolant.derivative()


def _check_curve(curve: Sequence[tuple[float, float]]) -> None:
    stretch, tension = np.array(curve, dtype=float).T
    if stretch[0] != 1 or tension[0] != 0:
        raise SolverError(
            f"fabric: the tension curve starts at {curve[0]}; it must start at (1, 0)"
        )
    if len(curve) < 3 or np.any(np.diff(stretch) <= 0) or np.any(np.diff(tension) <= 0):
        raise SolverError(
            "fabric: the tension curve must have three points or more, with stretch and tension "
            "rising from each to the next"
        )
