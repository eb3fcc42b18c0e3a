"""Pressures on the skin, read from the contact forces between skin and bandages.

A bandage is one sheet in (theta, z) when theta is counted on from turn to turn, so the
place of every element midpoint on the skin is a smooth map of the strip's own coordinates.
It is inverted at each point where a pressure is asked, for every turn that comes by, and
the turns' pressures are added (only the lowest one touches the skin), and those of all
bandages. Pressure is force
per deformed area of skin. Units: mm, MPa inside, mmHg outside.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..equilibrium.model import Model, Wrapped, midpoints, skin_parameters
from ..geometry.landmarks import Disc
from ..geometry.leg import Leg
from ..surfaces.projection import project, solve2
from ..surfaces.skin import Skin
from ..surfaces.strip import Strip, interpolate_strip

MMHG = 1.33322e-4
"""MPa in one millimetre of mercury."""


@dataclass(frozen=True)
class PressureMap:
    """Where the bandages lie on the skin and how they press it; sheets: the first one first."""

    sheets: tuple[Sheet, ...]

    def at(self, theta, z):
        """Pressure (mmHg) and number of layers at angles and heights, each (n,)."""
        pressure, layers = self.sheets[0].at(theta, z)
        for sheet in self.sheets[1:]:
            more = sheet.at(theta, z)
            pressure, layers = pressure + more[0], layers + more[1]
        return pressure, layers


@dataclass(frozen=True)
class Sheet:
    """A bandage on the skin it has come to lie on.

    strip     the bandage's parameters, without the leg
    place     control values (n, 3): theta (unwrapped, along the bandage) and z of the skin
              beneath, unused
    pressure  control values (n, 3): pressure on the skin in MPa, unused, unused
    slip      (ns, nw) how far each element slid on the skin, mm
    sense     1, or -1 for one that goes round the other way, with theta falling
    """

    strip: Strip
    place: np.ndarray
    pressure: np.ndarray
    slip: np.ndarray
    sense: float = 1.0

    def at(self, theta, z):
        """Pressure (mmHg) and number of layers at angles and heights, each (n,)."""
        theta = self.sense * theta % (2 * np.pi)
        total = np.zeros(len(theta))
        layers = np.zeros(len(theta))
        first, last = self.place[:, 0].min(), self.place[:, 0].max()
        for turn in range(int(first // (2 * np.pi)) - 1, int(last // (2 * np.pi)) + 2):
            xi, share = self._find(theta + 2 * np.pi * turn, z)
            on = share > 0
            values = self.strip.at(xi[on], self.pressure)[:, 0]
            total[on] += share[on] * np.maximum(values[:, 0], 0.0)
            layers += share
        return total / MMHG, layers

    def _find(self, theta, z):
        """Strip parameters (n, 2) under skin points, and the share (n,) that is on the strip.

        The share falls from 1 to 0 over one element centred on the rim: its pressure ends
        there, and means over a sensor must not jump when a point crosses it.
        """
        strip = self.strip
        line = midpoints(strip).reshape(strip.ns, strip.nw, 2)
        middle = self.strip.at(line[:, strip.nw // 2], self.place)[:, 0]
        row = np.interp(theta, middle[:, 0], np.arange(strip.ns) + 0.5)
        above = z - np.interp(row, np.arange(strip.ns) + 0.5, middle[:, 1])
        step = np.abs(self.strip.at(line[:, strip.nw // 2], self.place)[:, 2, 1]).mean()
        xi = np.column_stack([row, strip.nw / 2 + above / step])
        inside = (xi[:, 1] > -4) & (xi[:, 1] < strip.nw + 4)
        inside &= (theta > middle[0, 0] - 0.5) & (theta < middle[-1, 0] + 0.5)
        target = np.column_stack([theta, z])
        for _ in range(8):
            jet = strip.at(xi[inside], self.place)[:, :3, :2]
            miss = target[inside] - jet[:, 0]
            step2 = solve2(jet[:, 1:].transpose(0, 2, 1), miss)
            xi[inside] += np.clip(step2, -3, 3)
        rim = np.minimum(xi, [strip.ns, strip.nw] - xi).min(axis=1)
        return xi, np.where(inside, np.clip(rim + 0.5, 0.0, 1.0), 0.0)


def pressure_map(model: Model, u: np.ndarray) -> PressureMap:
    """Where the bandages lie at displacements u and how they press the skin."""
    return PressureMap(tuple(_sheet(model, one, u) for one in model.bandages))


def _sheet(model: Model, bandage: Wrapped, u: np.ndarray) -> Sheet:
    """Where one bandage lies and how it presses the skin."""
    strip, laid = Strip(bandage.strip.ns, bandage.strip.nw), bandage.lay
    shape = (strip.ns, strip.nw)
    x = model.X + u.reshape(-1, 3)
    skin = Skin(model.mesh.skin)
    seeds = skin_parameters(model.mesh, laid.skin[:, 1:-1]).reshape(-1, 2)
    where = bandage.strip.at(midpoints(strip), x)[:, 0]
    xi = project(skin, where, x, seeds)
    jet = skin.at(xi, x)
    slip = np.linalg.norm(np.einsum("pac,pa->pc", jet[:, 1:3], xi - seeds), axis=1)

    grid = _spline(xi.reshape(*shape, 2))
    turn = strip.at(midpoints(strip), grid)[:, 1:3, :2]
    stretch = np.abs(turn[:, 0, 0] * turn[:, 1, 1] - turn[:, 0, 1] * turn[:, 1, 0])
    area = stretch * np.linalg.norm(np.cross(jet[:, 1], jet[:, 2]), axis=1)
    facing = bandage.facing
    pressure = _on_elements(facing.on_skin(facing.skin.report(u)["p"], laid), laid.area)
    pressure = pressure * laid.density / area.reshape(shape)

    turns = 2 * np.pi / len(model.mesh.theta)
    height = model.mesh.z[1] - model.mesh.z[0]
    sense = -1.0 if bandage.strip.flip else 1.0
    place = np.column_stack([sense * xi[:, 0] * turns, model.mesh.z[0] + xi[:, 1] * height])
    places = _spline(place.reshape(*shape, 2))
    return Sheet(strip, places, _spline(pressure[..., None]), slip.reshape(shape), sense)


def _on_elements(values, area):
    """Values (ns, nw) of elements from those at contact points (ns, nw + 2), by their area.

    An edge belongs to the element beside it: what it carries must not be lost.
    """
    inner, weight = (values * area)[:, 1:-1], area[:, 1:-1].copy()
    for element, edge in ((0, 0), (-1, -1)):
        inner[:, element] += (values * area)[:, edge]
        weight[:, element] += area[:, edge]
    return inner / weight


def on_disc(found: PressureMap, leg: Leg, disc: Disc) -> tuple[float, float]:
    """Mean pressure (mmHg) and mean number of layers over a sensor; NaN for a disc at NaN."""
    if not np.isfinite(disc.z):
        return np.nan, np.nan
    theta, z, weights = disc.points(leg, rings=8, spokes=32)
    pressure, layers = found.at(theta, z)
    return float(weights @ pressure), float(weights @ layers)


def field(found: PressureMap, leg: Leg, theta: np.ndarray, heights: np.ndarray) -> np.ndarray:
    """Pressure (theta, heights) in mmHg on angles and heights over the leg's length."""
    grid = np.meshgrid(theta, heights * leg.length, indexing="ij")
    return found.at(grid[0].ravel(), grid[1].ravel())[0].reshape(grid[0].shape)


def _spline(values):
    """Control values (n, 3) of midpoint values (ns, nw, m <= 3), continued straight outside."""
    padded = np.zeros((values.shape[0] + 2, values.shape[1] + 2, 3))
    padded[1:-1, 1:-1, : values.shape[2]] = values
    for edge, one, two in ((0, 1, 2), (-1, -2, -3)):
        padded[edge] = 2 * padded[one] - padded[two]
    for edge, one, two in ((0, 1, 2), (-1, -2, -3)):
        padded[:, edge] = 2 * padded[:, one] - padded[:, two]
    return interpolate_strip(padded).reshape(-1, 3)
