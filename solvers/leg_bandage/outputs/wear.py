"""The pressure at B1 as the bandage is worn: in other postures, and after hours."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from surrogate.solver import Output

from ..bandage.relaxation import RELAXATIONS
from ..equilibrium.afterwards import Worn, worn
from ..equilibrium.model import Model
from ..geometry.landmarks import Disc
from ..geometry.leg import Leg
from ..tissue.posture import POSTURES
from .pressure_map import on_disc, pressure_map

MINUTES = np.array([0.0, 10.0, 90.0, 240.0, 1440.0])
FOUR_HOURS = 240.0
Array = NDArray[np.float64]
Values = dict[str, "float | Array"]

IN_TIME: Mapping[str, Output] = {
    "pressure_b1_over_time": Output(
        unit="mmHg",
        dims=("minutes",),
        coordinates={"minutes": MINUTES},
        description="the sensor of pressure_b1, minutes after the bandage came to rest, lying",
    ),
    "pressure_b1_4h": Output(unit="mmHg", description="the same after four hours"),
    "kept_4h": Output(description="pressure_b1_4h over pressure_b1"),
}
STANDING: Mapping[str, Output] = {
    "pressure_supine": Output(unit="mmHg", description="pressure_b1: the leg lies"),
    "pressure_standing": Output(unit="mmHg", description="the same sensor once the leg stands"),
    "static_stiffness_index": Output(
        unit="mmHg", description="pressure_standing less pressure_supine"
    ),
    "girth_rise": Output(unit="mm", description="of the bandaged leg at B1 on standing up"),
}
DORSIFLEXION: Mapping[str, Output] = {
    "pressure_dorsiflexion": Output(
        unit="mmHg", description="the same sensor with the foot pulled up, standing"
    ),
    "walking_amplitude": Output(
        unit="mmHg", description="pressure_dorsiflexion less pressure_standing"
    ),
}
STANDING_LATER: Mapping[str, Output] = {
    "pressure_standing_4h": Output(unit="mmHg", description="standing up after four hours"),
    "standing_kept_4h": Output(description="pressure_standing_4h over pressure_standing"),
}


@dataclass(frozen=True)
class Wear:
    """Which of it is asked for: a kind of relaxation, the last posture, or neither."""

    relaxation: str | None = None
    posture: str | None = None

    @cached_property
    def outputs(self) -> Mapping[str, Output]:
        """Outputs besides those of the bandage as laid."""
        later = STANDING_LATER if self.relaxation and self.posture else {}
        return {
            **(IN_TIME if self.relaxation else {}),
            **(STANDING if self.posture else {}),
            **(DORSIFLEXION if self.posture == "dorsiflexion" else {}),
            **later,
        }

    @property
    def options(self) -> dict[str, str]:
        """What the identity of runs hangs on; nothing where nothing is asked for."""
        asked = {"relaxation": self.relaxation, "posture": self.posture}
        return {name: value for name, value in asked.items() if value is not None}

    def answers(
        self, leg: Leg, model: Model, u: Array, sensor: Disc, fluid_loss: float
    ) -> tuple[Values, dict[str, Array]]:
        """The outputs, and the displacements at rest that they were read from, by name.

        The model is left as it was.
        """
        if not self.options:
            return {}, {}
        read = _Reader(leg, worn(model, u, fluid_loss), sensor)
        return read.state.aside(lambda: self._told(read)), read.states

    def _told(self, read: _Reader) -> Values:
        if self.relaxation:
            read.state.relaxing(RELAXATIONS[self.relaxation])
        supine, girth = read("lying"), read.girth()
        values: Values = {}
        if self.posture:
            values |= read.state.aside(lambda: self._upright(read, girth))
            rise = read.pressures["standing"] - supine
            values |= {"pressure_supine": supine, "static_stiffness_index": rise}
        if self.relaxation:
            values |= self._later(read, supine)
        return values

    def _upright(self, read: _Reader, girth: float) -> Values:
        read.state.take(POSTURES["standing"])
        standing = read("standing")
        values: Values = {"pressure_standing": standing, "girth_rise": read.girth() - girth}
        if self.posture == "dorsiflexion":
            read.state.take(POSTURES["dorsiflexion"])
            flexed = read("dorsiflexion")
            values |= {"pressure_dorsiflexion": flexed, "walking_amplitude": flexed - standing}
        return values

    def _later(self, read: _Reader, first: float) -> Values:
        values: Values = {}
        pressures = [first]
        for minutes in MINUTES[1:]:
            read.state.wait_until(float(minutes))
            pressures.append(read(f"{minutes:g} minutes"))
            if minutes == FOUR_HOURS:
                values |= {"pressure_b1_4h": pressures[-1], "kept_4h": pressures[-1] / first}
                if self.posture:
                    values |= read.state.aside(lambda: self._standing_later(read))
        return values | {"pressure_b1_over_time": np.array(pressures)}

    def _standing_later(self, read: _Reader) -> Values:
        read.state.take(POSTURES["standing"])
        standing = read("standing after 4 h")
        return {
            "pressure_standing_4h": standing,
            "standing_kept_4h": standing / read.pressures["standing"],
        }


class _Reader:
    """Reads the sensor of a worn bandage and keeps the states that it has seen."""

    def __init__(self, leg: Leg, state: Worn, sensor: Disc):
        self.leg, self.state, self.sensor = leg, state, sensor
        self.states: dict[str, Array] = {}
        self.pressures: dict[str, float] = {}

    def __call__(self, name: str) -> float:
        """mmHg, now."""
        found = pressure_map(self.state.model, self.state.u)
        self.states[name] = self.state.u
        self.pressures[name] = on_disc(found, self.leg, self.sensor)[0]
        return self.pressures[name]

    def girth(self) -> float:
        """mm, at the height of the sensor, now."""
        mesh, z = self.state.model.mesh, self.sensor.z
        first = mesh.mesh.p.T
        moved = first + self.state.u.reshape(-1, 3)[: len(first)]
        rings = [_lengths(x[mesh.skin]) for x in (moved, first)]
        ratio = float(np.interp(z, mesh.z, rings[0] / rings[1]))
        return ratio * float(self.leg.girth(np.array(z)))


def _lengths(rings: Array) -> Array:
    """(n_z,) lengths of closed polygons (n_theta, n_z, 3)."""
    return np.asarray(np.linalg.norm(np.roll(rings, -1, axis=0) - rings, axis=2).sum(axis=0))
