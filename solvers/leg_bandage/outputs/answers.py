"""The outputs that a study sees, and their values on a solved model."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from surrogate.errors import SolverError
from surrogate.solver import Output

from ..equilibrium.model import Model, Wrapped
from ..geometry.landmarks import MEDIAL, RULES, Disc, b1_height, extreme_girths
from ..geometry.leg import Leg
from ..wrapping.lay import Lay
from .pressure_map import field, on_disc, pressure_map

ANGLES = np.arange(0.0, 360.0, 5.0)
HEIGHTS = np.round(np.arange(0.0, 1.001, 0.02), 2)


def _mmhg(description: str, gaps: bool = False) -> Output:
    return Output(unit="mmHg", description=description, gaps=gaps)


OUTPUTS: dict[str, Output] = {
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
    "pressure_gradient": Output(
        gaps=True, description="pressure_calf over pressure_ankle; NaN where the ankle has none"
    ),
    "pressure_profile": Output(
        unit="mmHg",
        dims=("height",),
        coordinates={"height": HEIGHTS},
        description="mean pressure around the leg; height over leg length",
    ),
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


def outputs_of(bandages: int) -> Mapping[str, Output]:
    """The outputs of a model of so many bandages."""
    return OUTPUTS | {
        f"stretch_midline_{number}": Output(
            description=f"mean warp stretch of the midline of bandage {number}, end turns left out"
        )
        for number in range(2, bandages + 1)
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
    rows = inner_rows(model.lay)
    slip = np.concatenate([sheet.slip.ravel() for sheet in found.sheets])

    def pressed(height):
        return on_disc(found, leg, Disc(MEDIAL, height))[0]

    skin = field(found, leg, np.radians(ANGLES), HEIGHTS)
    at_ankle, at_calf = pressed(ankle + 25.0), pressed(min(calf, highest))
    return {
        "pressure_b1": at_b1,
        "pressure_field": skin,
        **{f"pressure_b1_{name}": pressed(_height(leg, name)) for name in RULES},
        "pressure_ankle": at_ankle,
        "pressure_calf": at_calf,
        "pressure_gradient": at_calf / at_ankle if at_ankle > 0 else np.nan,
        "pressure_profile": skin.mean(axis=0),
        "sensor_variation": float(np.mean(np.abs(np.array(circle) - at_b1))),
        "b1_height": z,
        **{
            f"stretch_{name}": float(values[rows].mean())
            for name, values in stretches(model.bandages[0], u).items()
        },
        **_of_further(model, u),
        "slip_max": float(slip.max()),
        "slip_mean": float(slip.mean()),
        "layers_b1": layers,
        "turns": abs(model.lay.theta[-1] - model.lay.theta[0]) / (2 * np.pi),
        "steps": float(cost.steps),
        "iterations": float(cost.iterations),
        "residual": cost.rest,
    }


def _of_further(model, u):
    """Stretch of the midline of the second bandage and of those after it."""
    return {
        f"stretch_midline_{number}": float(
            stretches(bandage, u)["midline"][inner_rows(bandage.lay)].mean()
        )
        for number, bandage in enumerate(model.bandages[1:], start=2)
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


def stretches(bandage: Wrapped, u: np.ndarray) -> dict[str, np.ndarray]:
    """Warp stretch along a bandage at the midline and both edges, {name: (ns,)}."""
    ns, nw = bandage.strip.ns, bandage.strip.nw
    rows = np.arange(ns) + 0.5
    lines = {"bottom": 0.0, "midline": nw / 2, "top": float(nw)}
    return {
        name: bandage.shell.at(u, np.column_stack([rows, np.full(ns, w)])).warp_stretch
        for name, w in lines.items()
    }


def inner_rows(laid: Lay) -> slice:
    """Element rows that are at least half a turn away from both ends."""
    along = np.abs(laid.theta - laid.theta[0])
    angles = (along[1:] + along[:-1]) / 2
    inside = np.flatnonzero((angles > np.pi) & (angles < along[-1] - np.pi))
    if not len(inside):
        return slice(0, len(angles))
    return slice(int(inside[0]), int(inside[-1]) + 1)
