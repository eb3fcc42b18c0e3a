"""What is read off a solved model: pressures on the skin, stretch, slip, layers.

The bandage is one sheet in (theta, z) when theta is counted on from turn to turn, so the
place of every element midpoint on the skin is a smooth map of the strip's own coordinates.
It is inverted at each point where a pressure is asked, for every turn that comes by, and
the turns' pressures are added (only the lowest one touches the skin). Pressure is force
per deformed area of skin. Units: mm, MPa inside, mmHg outside.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from surrogate.errors import SolverError
from surrogate.solver import Output

from ..equilibrium.model import Model, midpoints, skin_parameters
from ..geometry.landmarks import MEDIAL, RULES, Disc, b1_height, extreme_girths
from ..geometry.leg import Leg
from ..surfaces.projection import project, solve2
from ..surfaces.surfaces import Skin, Strip, interpolate_strip

MMHG = 1.33322e-4
"""MPa in one millimetre of mercury."""

ANGLES = np.arange(0.0, 360.0, 5.0)
HEIGHTS = np.round(np.arange(0.0, 1.001, 0.02), 2)


def _mmhg(description: str, gaps: bool = False) -> Output:
    return Output(unit="mmHg", description=description, gaps=gaps)


OUTPUTS: Mapping[str, Output] = {
    "pressure_b1": _mmhg(
        "mean over the 50 mm sensor: on the medial side at B1, or as far from it "
        "as sensor_around and sensor_up say"
    ),
    "pressure_field": Output(
        unit="mmHg",
        dims=("theta", "height"),
        coordinates={"theta": ANGLES, "height": HEIGHTS},
        description="interface pressure on the skin; theta in degrees from lateral (0) by "
        "anterior (90) to medial (180), height over leg length",
    ),
    "pressure_b1_girth": _mmhg("the sensor at B1 itself by the girth rule"),
    "pressure_b1_profile": _mmhg(
        "the sensor at B1 itself by the paper's profile rule; NaN "
        "where the profile has no such point",
        gaps=True,
    ),
    "pressure_ankle": _mmhg("the sensor with its lower rim at the narrowest girth"),
    "pressure_calf": _mmhg("the sensor at the widest girth, or as high as two layers reach"),
    "sensor_variation": _mmhg("mean change of pressure_b1 when the sensor moves by 10 mm"),
    "b1_height": Output(unit="mm", description="height of B1 above the ankle cut"),
    "stretch_midline": Output(description="mean warp stretch of the midline, end turns left out"),
    "stretch_top": Output(description="the same at the upper edge"),
    "stretch_bottom": Output(description="the same at the lower edge"),
    "slip_max": Output(unit="mm", description="farthest that the bandage slid on the skin"),
    "slip_mean": Output(unit="mm", description="how far it slid on the skin, mean over the strip"),
    "layers_b1": Output(description="layers of bandage over the sensor, mean"),
    "turns": Output(description="turns of the bandage around the leg"),
    "steps": Output(description="load steps taken"),
    "iterations": Output(description="Newton iterations taken, those of steps undone included"),
    "residual": Output(unit="MPa", description="traction that still moved the bandage at rest"),
}


def answers(
    leg: Leg, model: Model, u: np.ndarray, rule: str, around: float = 0.0, up: float = 0.0
) -> dict[str, float | np.ndarray]:
    """The outputs of a solved model; leg is the undeformed one.

    rule       for B1, where the sensor lies
    around, up how far from there its centre is, mm along the skin
    """
    found, cost = pressure_map(model, u), model.problem.cost
    z = b1_height(leg, rule)
    _, ankle, _, calf = extreme_girths(leg)
    highest = leg.length - model.wrap.pitch - 25.0
    sensor = Disc(MEDIAL, z).moved(leg, around, up)
    at_b1, layers = on_disc(found, leg, sensor)
    circle = [on_disc(found, leg, sensor.moved(leg, *shift))[0] for shift in _circle(10.0)]
    rows = inner_rows(model)

    def pressed(height):
        return on_disc(found, leg, Disc(MEDIAL, height))[0]

    return {
        "pressure_b1": at_b1,
        "pressure_field": field(found, leg, np.radians(ANGLES), HEIGHTS),
        **{f"pressure_b1_{name}": pressed(_height(leg, name)) for name in RULES},
        "pressure_ankle": pressed(ankle + 25.0),
        "pressure_calf": pressed(min(calf, highest)),
        "sensor_variation": float(np.mean(np.abs(np.array(circle) - at_b1))),
        "b1_height": z,
        **{
            f"stretch_{name}": float(values[rows].mean())
            for name, values in stretches(model, u).items()
        },
        "slip_max": float(found.slip.max()),
        "slip_mean": float(found.slip.mean()),
        "layers_b1": layers,
        "turns": (model.lay.theta[-1] - model.lay.theta[0]) / (2 * np.pi),
        "steps": float(cost.steps),
        "iterations": float(cost.iterations),
        "residual": cost.rest,
    }


def _height(leg, rule):
    try:
        return b1_height(leg, rule)
    except SolverError:
        return np.nan


def _circle(radius, places=8):
    """Places (around, up) on a circle of `radius` mm."""
    angle = 2 * np.pi * np.arange(places) / places
    return list(zip(radius * np.cos(angle), radius * np.sin(angle), strict=True))


@dataclass(frozen=True)
class PressureMap:
    """The bandage on the skin it has come to lie on.

    strip     the bandage's parameters, without the leg
    place     control values (n, 3): theta (unwrapped) and z of the skin beneath, unused
    pressure  control values (n, 3): pressure on the skin in MPa, unused, unused
    slip      (ns, nw) how far each element slid on the skin, mm
    """

    strip: Strip
    place: np.ndarray
    pressure: np.ndarray
    slip: np.ndarray

    def at(self, theta, z):
        """Pressure (mmHg) and number of layers at angles and heights, each (n,)."""
        theta = theta % (2 * np.pi)
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
    """Where the bandage lies at displacements u and how it presses the skin."""
    strip, laid = Strip(model.strip.ns, model.strip.nw), model.lay
    shape = (strip.ns, strip.nw)
    x = model.X + u.reshape(-1, 3)
    skin = Skin(model.mesh.skin)
    seeds = skin_parameters(model.mesh, laid.skin[:, 1:-1]).reshape(-1, 2)
    where = model.strip.at(midpoints(strip), x)[:, 0]
    xi = project(skin, where, x, seeds)
    jet = skin.at(xi, x)
    slip = np.linalg.norm(np.einsum("pac,pa->pc", jet[:, 1:3], xi - seeds), axis=1)

    grid = _spline(xi.reshape(*shape, 2))
    turn = strip.at(midpoints(strip), grid)[:, 1:3, :2]
    stretch = np.abs(turn[:, 0, 0] * turn[:, 1, 1] - turn[:, 0, 1] * turn[:, 1, 0])
    area = stretch * np.linalg.norm(np.cross(jet[:, 1], jet[:, 2]), axis=1)
    pressure = np.zeros(laid.cover.size)
    pressure[model.points["skin"]] = model.skin.report(u)["p"]
    pressure = _on_elements(pressure.reshape(laid.cover.shape) * (1 - laid.cover), laid.area)
    pressure = pressure * laid.density / area.reshape(shape)

    turns = 2 * np.pi / len(model.mesh.theta)
    height = model.mesh.z[1] - model.mesh.z[0]
    place = np.column_stack([xi[:, 0] * turns, model.mesh.z[0] + xi[:, 1] * height])
    places = _spline(place.reshape(*shape, 2))
    return PressureMap(strip, places, _spline(pressure[..., None]), slip.reshape(shape))


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


def stretches(model: Model, u: np.ndarray) -> dict[str, np.ndarray]:
    """Warp stretch along the strip at the midline and both edges, {name: (ns,)}."""
    ns, nw = model.strip.ns, model.strip.nw
    rows = np.arange(ns) + 0.5
    lines = {"bottom": 0.0, "midline": nw / 2, "top": float(nw)}
    return {
        name: model.shell.at(u, np.column_stack([rows, np.full(ns, w)])).warp_stretch
        for name, w in lines.items()
    }


def inner_rows(model: Model) -> slice:
    """Element rows that are at least half a turn away from both ends."""
    angles = (model.lay.theta[1:] + model.lay.theta[:-1]) / 2
    inside = np.flatnonzero(
        (angles > model.lay.theta[0] + np.pi) & (angles < model.lay.theta[-1] - np.pi)
    )
    if not len(inside):
        return slice(0, len(angles))
    return slice(int(inside[0]), int(inside[-1]) + 1)
