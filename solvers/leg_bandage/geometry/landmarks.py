"""Where on a leg the pressure is read: the level B1 and the sensor disc on its medial side.

B1 is the level at which the Achilles tendon turns into the calf muscles. Two rules:

`girth`    the level above the ankle whose girth is cB + 0.20 (cC - cB), with cB the
           smallest and cC the largest girth: sturdy, the default.
`profile`  the rule of Chassagne et al. 2018: down the posterior profile, from the top of
           a zone of interest, the first level where the derivative of the curvature
           vanishes. The paper does not print its zone; here it starts at 0.45 of the
           length, under the bulge of the calf. The level moves with noise on the
           profile: apply it to legs made from shape coordinates only.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from scipy.interpolate import CubicSpline

from surrogate.errors import SolverError, nearest

from .leg import Leg

MEDIAL, POSTERIOR = np.pi, 1.5 * np.pi
GIRTH_FRACTION = 0.20
ZONE_TOP = 0.45
"""Fractions: of the girth difference (girth rule), of the length (profile rule)."""


def b1_height(leg: Leg, rule: str = "girth") -> float:
    """Height of point B1, mm above the ankle cut; raises SolverError if the leg has none."""
    if rule not in RULES:
        raise SolverError(f"B1 rule {rule!r} is unknown: {nearest(rule, RULES)}")
    return RULES[rule](leg)


def extreme_girths(leg: Leg) -> tuple[float, float, float, float]:
    """Smallest girth and its height, largest girth and its height, mm."""
    spline, z, girths = _girths_and_turns(leg)
    low, high = girths.argmin(), girths.argmax()
    return float(girths[low]), float(z[low]), float(girths[high]), float(z[high])


def _girths_and_turns(leg: Leg) -> tuple[CubicSpline, np.ndarray, np.ndarray]:
    """Girth as a spline of z, the levels where it may be extreme, and the girths there."""
    z = np.linspace(0, leg.length, 49)
    spline = CubicSpline(z, leg.girth(z))
    turns = spline.derivative().roots(extrapolate=False)
    levels = np.concatenate([[0.0, leg.length], turns[np.isfinite(turns)]])
    return spline, levels, spline(levels)


def _by_girth(leg: Leg) -> float:
    spline, levels, girths = _girths_and_turns(leg)
    ankle, calf = girths.min(), girths.max()
    if calf - ankle < 0.05 * ankle:
        raise SolverError(
            f"the girth only grows from {ankle:.0f} to {calf:.0f} mm, so the leg has no calf "
            "and no point B1; a leg's calf is at least 5 % wider than its ankle"
        )
    target = ankle + GIRTH_FRACTION * (calf - ankle)
    crossings = spline.solve(target, extrapolate=False)
    above = crossings[crossings > levels[girths.argmin()]]
    if len(above) == 0:
        raise SolverError(
            f"the narrowest girth ({ankle:.0f} mm) lies above the widest "
            f"({calf:.0f} mm): the leg is upside down"
        )
    return float(above[0])


def _by_profile(leg: Leg) -> float:
    z = np.linspace(0, ZONE_TOP * leg.length, 181)
    slope = leg.surface(POSTERIOR, z, d_z=1)[:, 1]
    bend = leg.surface(POSTERIOR, z, d_z=2)[:, 1]
    change = CubicSpline(z, bend / (1 + slope**2) ** 1.5).derivative()
    levels = change.roots(extrapolate=False)
    if len(levels) == 0:
        raise SolverError(
            "the curvature of the posterior profile has no extremum under "
            f"{ZONE_TOP:g} of the length: use the B1 rule 'girth'"
        )
    return float(levels.max())


RULES: dict[str, Callable[[Leg], float]] = {"girth": _by_girth, "profile": _by_profile}


@dataclass(frozen=True)
class Disc:
    """A flexible round sensor lying on the skin: centre (theta, z) and diameter, mm."""

    theta: float
    z: float
    diameter: float = 50.0

    def points(
        self, leg: Leg, rings: int = 4, spokes: int = 12
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Quadrature over the disc: theta, z (mm) and weights that sum to 1, each (n,).

        Gauss points in the squared radius (exact for areas), equal angles. The disc is
        laid with true lengths along the skin: along sections by one Runge-Kutta step of
        d theta / ds = 1 / |dw / d theta|, along the height by the slant of the skin at
        the centre.
        """
        nodes, weights = _gauss(rings)
        ring = self.diameter / 2 * np.sqrt((nodes + 1) / 2)
        angle = 2 * np.pi * (np.arange(spokes) + 0.5) / spokes
        theta, z = self._laid(leg, np.outer(ring, np.cos(angle)), np.outer(ring, np.sin(angle)))
        return theta, z, np.repeat(weights / 2, spokes) / spokes

    def rim(self, leg: Leg, points: int = 32) -> tuple[np.ndarray, np.ndarray]:
        """theta and z (mm) of evenly spaced points of the rim, laid as `points` are, (n,)."""
        angle = 2 * np.pi * np.arange(points) / points
        return self._laid(leg, self.diameter / 2 * np.cos(angle), self.diameter / 2 * np.sin(angle))

    def _laid(self, leg: Leg, along: np.ndarray, up: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        slant = np.linalg.norm(leg.surface(self.theta, self.z, d_z=1))
        z = self.z + up.ravel() / slant
        return _walk(leg, self.theta, z, along.ravel()), z

    def moved(self, leg: Leg, around: float = 0.0, up: float = 0.0) -> Disc:
        """The disc with its centre moved along the skin, mm: around (to rising theta) and up."""
        z = self.z + up / np.linalg.norm(leg.surface(self.theta, self.z, d_z=1))
        theta = _walk(leg, self.theta, np.array([z]), np.array([around]))
        return replace(self, theta=float(theta[0]), z=float(z))

    def mask(self, leg: Leg, theta: np.ndarray, z: np.ndarray) -> np.ndarray:
        """Which points of the skin (theta, z broadcast) the disc covers; by straight distance."""
        away = leg.surface(theta, z) - leg.surface(self.theta, self.z)
        return np.linalg.norm(away, axis=-1) <= self.diameter / 2


@cache
def _gauss(n: int) -> tuple[np.ndarray, np.ndarray]:
    """Gauss-Legendre nodes and weights on [-1, 1]."""
    return np.polynomial.legendre.leggauss(n)


def _walk(leg: Leg, start: float, z: np.ndarray, along: np.ndarray) -> np.ndarray:
    """theta after `along` mm (signed) around the sections at z, from theta = start."""

    def speed(theta):
        return 1 / np.linalg.norm(leg.surface(theta, z, d_theta=1), axis=-1)

    k1 = speed(np.full_like(z, start))
    k2 = speed(start + along * k1 / 2)
    k3 = speed(start + along * k2 / 2)
    k4 = speed(start + along * k3)
    return start + along * (k1 + 2 * k2 + 2 * k3 + k4) / 6


def sensor(leg: Leg, rule: str = "girth") -> Disc:
    """The 50 mm disc on the medial side at point B1 (Chassagne et al. 2018)."""
    return Disc(MEDIAL, b1_height(leg, rule))
