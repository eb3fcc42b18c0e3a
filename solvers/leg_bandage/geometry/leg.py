"""One leg: a smooth skin over its sections, from the shape basis or from anybody's sections.

Along the height the 13 numbers of a section are quintic splines on 12 equal spans,
fitted by least squares to the sections (C4; off the shipped sections by 0.05 mm at
most, which is their facet noise). Beyond both cuts the leg goes on as the second-order
Taylor polynomial of the cut in a squashed height q = d tanh(s / d): C2 at the cut,
constant 15 mm further.

Axes: z up from the ankle (z = 0) to the upper cut (z = length), x lateral of a right
leg, y anterior, theta from x towards y: the medial side is theta = pi. Millimetres.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache, cached_property

import numpy as np
from scipy.interpolate import BSpline

from surrogate.errors import SolverError

from . import section
from .basis import Basis, shipped_basis
from .cohort import sections_of

DEGREE, SPANS = 5, 12
KNOTS = np.concatenate([np.zeros(DEGREE), np.linspace(0, 1, SPANS + 1), np.ones(DEGREE)])


@cache
def _fit_matrix(sections: int) -> np.ndarray:
    """Least-squares spline coefficients (17, S) of equally spaced sections."""
    heights = np.linspace(0, 1, sections)
    return np.linalg.pinv(BSpline.design_matrix(heights, KNOTS, DEGREE).toarray())


@dataclass(frozen=True)
class Leg:
    """A leg and its skin.

    length        mm between the two cuts
    coefficients  (S, 11) series r0, a1..a5, b1..b5 of S equally spaced sections, ankle first, mm
    centre        (S, 2) their centres, lateral and anterior, mm
    alphas        coordinates in the shape basis when the leg was made from them
    below, above  mm by which the leg is taken beyond its two cuts
    trend         d, mm: how far the trend of a cut is followed beyond it (much further, and
                  the skin meets the bone under the ankle)
    """

    length: float
    coefficients: np.ndarray
    centre: np.ndarray
    alphas: tuple[float, ...] | None = None
    below: float = 0.0
    above: float = 0.0
    trend: float = 2.0

    @classmethod
    def from_alphas(cls, length: float, alphas, basis: Basis | None = None) -> Leg:
        """The leg of this length (mm) and these shape coordinates; basis: the shipped one."""
        basis = shipped_basis() if basis is None else basis
        known = basis.modes.shape[1]
        if len(alphas) > known:
            raise SolverError(
                f"{len(alphas)} alphas for a basis of {known} modes: give at most "
                f"{known}, or a basis with more modes"
            )
        sections = sections_of(basis.reconstruct(np.asarray(alphas, float)), length)
        return cls(float(length), *sections, alphas=tuple(map(float, alphas)))

    @classmethod
    def from_sections(cls, length: float, coefficients, centre) -> Leg:
        """The leg through equally spaced sections; raises SolverError for too few of them."""
        coefficients, centre = np.asarray(coefficients, float), np.asarray(centre, float)
        expected = [(len(coefficients), 11), (len(coefficients), 2)]
        if [coefficients.shape, centre.shape] != expected:
            raise SolverError(
                f"sections of shape {coefficients.shape} and centres of shape "
                f"{centre.shape}: give (S, 11) and (S, 2)"
            )
        if len(coefficients) < len(KNOTS) - DEGREE - 1:
            raise SolverError(
                f"{len(coefficients)} sections are too few for a smooth leg: "
                f"give at least {len(KNOTS) - DEGREE - 1}, best 100"
            )
        return cls(float(length), coefficients, centre)

    def extended(self, below: float, above: float) -> Leg:
        """The same leg taken `below` mm under the ankle cut and `above` mm over the upper cut."""
        return replace(self, below=float(below), above=float(above))

    @property
    def z(self) -> np.ndarray:
        """(S,) heights of the given sections, mm."""
        return np.linspace(0, self.length, len(self.coefficients))

    @property
    def span(self) -> tuple[float, float]:
        """Lowest and highest z of the leg with its extensions, mm."""
        return -self.below, self.length + self.above

    @cached_property
    def _spline(self) -> BSpline:
        numbers = np.concatenate([self.coefficients, self.centre], axis=1)
        return BSpline(KNOTS * self.length, _fit_matrix(len(numbers)) @ numbers, DEGREE)

    @cached_property
    def _ends(self) -> np.ndarray:
        """(2, 3, 13): the numbers at both cuts with their first two derivatives along z."""
        cuts = np.array([0.0, self.length])
        return np.stack([self._spline(cuts, order) for order in range(3)], axis=1)

    def numbers(self, z, derivative: int = 0) -> np.ndarray:
        """The 13 numbers of the section at z, or their first or second derivative: (..., 13)."""
        z = np.asarray(z, float)
        inside = np.clip(z, 0, self.length)
        values = self._spline(inside, derivative)
        outside = z != inside
        if outside.any():
            end = self._ends[(z[outside] > 0).astype(int)]
            values[outside] = _taylor(end, (z - inside)[outside], derivative, self.trend)
        return values

    def radius(self, theta, z, d_theta: int = 0, d_z: int = 0) -> np.ndarray:
        """r(theta, z) about the centre of the section, mm, or a derivative; arguments broadcast."""
        return section.radius(self.numbers(z, d_z)[..., :11], theta, d_theta)

    def centre_line(self, z, d_z: int = 0) -> np.ndarray:
        """Centre x0, y0 of the section at z, mm, or its derivative along z: (..., 2)."""
        return self.numbers(z, d_z)[..., 11:]

    def surface(self, theta, z, d_theta: int = 0, d_z: int = 0) -> np.ndarray:
        """Points x, y, z of the skin, or their derivatives along theta and z: (..., 3), mm."""
        numbers = self.numbers(z, d_z)
        w = section.curve(numbers[..., :11], theta, d_theta)
        if d_theta == 0:
            w = w + numbers[..., 11] + 1j * numbers[..., 12]
        up = np.asarray(z, float) if d_z == 0 else np.full(np.shape(z), float(d_z == 1))
        up = np.zeros(w.shape) if d_theta else np.broadcast_to(up, w.shape)
        return np.stack([w.real, w.imag, up], axis=-1)

    def curvature(self, theta, z) -> np.ndarray:
        """Curvature of the horizontal section, 1/mm, positive where it is convex."""
        return section.curvature(self.numbers(z)[..., :11], theta)

    def girth(self, z) -> np.ndarray:
        """Length of the horizontal section, mm."""
        return section.girth(self.numbers(z)[..., :11])


def _taylor(end: np.ndarray, beyond: np.ndarray, derivative: int, d: float) -> np.ndarray:
    """f + f' q + f'' q^2 / 2 at `beyond` mm outside a cut, q = d tanh(beyond / d), or along z.

    end (point, 3, 13) holds f, f', f''; beyond (point,) is negative under the ankle.
    """
    value, slope, bend = np.moveaxis(end, 1, 0)
    tanh = np.tanh(beyond / d)[:, None]
    q, q1 = d * tanh, 1 - tanh**2
    if derivative == 0:
        return value + slope * q + bend * q**2 / 2
    if derivative == 1:
        return (slope + bend * q) * q1
    return bend * q1**2 - (slope + bend * q) * 2 * tanh * q1 / d
