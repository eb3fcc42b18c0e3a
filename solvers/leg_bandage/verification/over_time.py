"""A hoop band that relaxes, and a tube that grows under one: problems with exact answers.

On a rigid cylinder the pressure falls as the fabric's own g(t). On a soft tube the band shortens
as it relaxes. Its radius b(t) solves the Volterra equation ::

    int_0^t g(t - s) dT(b(s)) = b p(b),      T(b) = n K1 (b / rest - 1)

with p(b) the outside pressure that presses the tube to the radius b. Linear about b(0), with
K = n K1 / rest, k = -d(b p)/db and a single term (g1, tau), Laplace's transform gives ::

    b(t) - b(0) = T(0) g1 / (k + K (1 - g1)) [1 - exp(-t / t*)]
    t* = tau (k + K) / (k + K (1 - g1))

A tube of incompressible tissue that grows to J times its volume, its hole free, in plane strain,
has r^2 = a^2 + J (R^2 - A^2), and with d = J B^2 - b^2 (`grown_pressure`) ::

    p = -2 c10 J^(1/3) [ln(B / b) - ln(A / a) + d / 2 (1 / b^2 - 1 / a^2)]

Units: N, mm, MPa, minutes.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq
from scipy.sparse import csr_array, eye_array, kron

from ..bandage.fabric import Fabric
from ..bandage.relaxation import Relaxation
from ..bandage.shell import Shell
from ..contact.law import ContactLaw
from ..equilibrium.pseudo_transient import pseudo_transient
from ..outputs.pressure_map import MMHG
from ..surfaces.rigid import Mandrel
from ..surfaces.strip import Strip
from ..tissue.neo_hooke import Tissue
from .bands import limp
from .mandrel import ring_wrap, wrap_mandrel
from .newton import held, newton
from .thick_cylinder import (
    HEIGHT,
    INNER,
    OUTER,
    Hoop,
    annulus,
    bonded,
    plane_strain_dofs,
)

Array = NDArray[np.float64]
FINE = 400
"""Steps of the Volterra equation, evenly in the square root of time."""


def relaxing_on_cylinder(series: Relaxation, minutes: Sequence[float], r: float = 45.0) -> Array:
    """Mean pressure of one layer on a rigid cylinder at 0 and at these times, mmHg."""
    ring = wrap_mandrel(
        Mandrel(r, r), ring_wrap(20.0), limp(0.098), ContactLaw(0.0), 48, 4, ring=True
    )
    u, now, found = ring.slide_to_rest(), 0.0, []
    ring.shell.relaxing(u, series)
    for end in (0.0, *minutes):
        ring.shell.wait(end - now)
        u, _ = pseudo_transient(ring.problem, u, 1e-4)
        ring.shell.accept(u)
        now = end
        p = ring.skin.report(u)["p"]
        found.append(float(np.sum(p * ring.skin.points.area)) / (2 * np.pi * r * 20.0) / MMHG)
    return np.array(found)


def grown_pressure(b: float, c10: float, growth: float = 1.0) -> float:
    """Outside pressure of the tube at the outer radius b, its volume grown to `growth` times."""
    a = np.sqrt(b**2 - growth * (OUTER**2 - INNER**2))
    d = growth * OUTER**2 - b**2
    rise = np.log(OUTER / b) - np.log(INNER / a) + d / 2 * (1 / b**2 - 1 / a**2)
    return float(-2 * c10 * growth ** (1 / 3) * rise)


def grown_exactly(K1: float, layers: int, rest: float, c10: float, growth: float) -> Hoop:
    """A hoop band on the grown tube: p = layers K1 (b / rest - 1) / b."""

    def unbalanced(b: float) -> float:
        return grown_pressure(b, c10, growth) * b - layers * K1 * (b / rest - 1)

    smallest = np.sqrt(growth * (OUTER**2 - INNER**2))
    largest = np.sqrt(growth * OUTER**2 + (1 - growth) * INNER**2) + 5.0
    b = brentq(unbalanced, smallest + 1e-2, largest, xtol=1e-13)
    return Hoop(b, b / rest, layers * K1 * (b / rest - 1) / b)


def relaxing_exactly(
    K1: float, layers: int, rest: float, c10: float, series: Relaxation, minutes: Array
) -> Array:
    """Pressure of the relaxing band on the soft tube at times, MPa, by the Volterra equation.

    Straight in the tension between FINE times, evenly in the square root of time.
    """
    shares, tau = np.array(series.shares), np.array(series.times)
    start = grown_exactly(K1, layers, rest, c10, 1.0)
    times = np.unique(np.append(minutes, minutes.max() * np.linspace(0, 1, FINE) ** 2))
    tension = layers * K1 * (start.stretch - 1)
    terms, b, found = shares * tension, start.radius, [start.pressure]
    for step in np.diff(times):
        decay = np.exp(-step / tau)
        taken = shares * tau / step * (1 - decay)
        share = 1 - shares.sum() + taken.sum()
        carried = float(decay @ terms) - taken.sum() * tension

        def unbalanced(b: float, share: float = share, carried: float = carried) -> float:
            return grown_pressure(b, c10) * b - share * layers * K1 * (b / rest - 1) - carried

        b = brentq(unbalanced, b - 1e-9, b + 1.0, xtol=1e-13)
        now = layers * K1 * (b / rest - 1)
        terms, tension = decay * terms + taken * (now - tension), now
        found.append(grown_pressure(b, c10))
    return np.asarray(np.interp(minutes, times, found))


def linear_exactly(
    K1: float, layers: int, rest: float, c10: float, share: float, tau: float, minutes: Array
) -> Array:
    """Radius (mm) of a band with a single term on the tube made linear, by Laplace's transform."""
    start = grown_exactly(K1, layers, rest, c10, 1.0)
    h = 1e-4
    ends = [(start.radius + s) * grown_pressure(start.radius + s, c10) for s in (-h, h)]
    k, K = (ends[0] - ends[1]) / (2 * h), layers * K1 / rest
    soft = k + K * (1 - share)
    rise = layers * K1 * (start.stretch - 1) * share / soft
    return np.asarray(start.radius - rise * np.expm1(-minutes * soft / (tau * (k + K))))


class SoftTube:
    """The tube with a band bonded to it, by finite elements; kappa high: incompressible."""

    def __init__(self, K1: float, layers: int, rest: float, c10: float, kappa: float = 1430.0):
        leg = annulus(48, 12)
        strip = Strip(48, 1, offset=leg.mesh.nvertices)
        follow = csr_array(kron(bonded(leg, strip), eye_array(3)))
        self.start = (follow @ leg.mesh.p.T.ravel()).reshape(-1, 3)
        self.K = layers * K1
        fabric = Fabric(self.K, self.K, 0.0, self.K, 1e-9, 1e-9, 1e-9)
        self.band = Shell(strip, (2 * np.pi * rest, HEIGHT), fabric, self.start)
        self.tissue = Tissue(leg.mesh, c10, kappa, self.start.size)
        self.basis = csr_array(follow @ held(leg.n_dofs, plane_strain_dofs(leg, False)))
        self.skin, self.c10 = leg.skin.ravel(), c10

    def rest(self) -> tuple[float, float]:
        """Outer radius (mm) and stretch of the band in equilibrium."""
        self.u, _ = newton([self.tissue, self.band], self.basis)
        places = (self.start + self.u.reshape(-1, 3))[self.skin]
        radius = float(np.hypot(*places[:, :2].T).mean())
        return radius, float(self.band.strains(self.u)[0].mean())


def relaxing_on_tube(
    K1: float, layers: int, rest: float, c10: float, series: Relaxation, minutes: Sequence[float]
) -> Array:
    """Pressure (MPa) of the relaxing band on the tube by finite elements at these times."""
    tube = SoftTube(K1, layers, rest, c10)
    tube.rest()
    tube.band.relaxing(tube.u, series)
    now, found = 0.0, []
    for end in minutes:
        tube.band.wait(end - now)
        radius, _ = tube.rest()
        tube.band.accept(tube.u)
        now = end
        memory = tube.band.memory
        assert memory is not None
        warp = 1 - sum(series.shares)
        force = float((warp * memory.elastic[0] + memory.terms[:, 0].sum(axis=0)).mean())
        found.append(force / radius)
    return np.array(found)


def grown(K1: float, layers: int, rest: float, c10: float, growth: float) -> Hoop:
    """A hoop band on the grown tube, by finite elements."""
    tube = SoftTube(K1, layers, rest, c10)
    tube.tissue.grow(growth)
    radius, stretch = tube.rest()
    return Hoop(radius, stretch, tube.K * (stretch - 1) / radius)
