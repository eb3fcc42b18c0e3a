"""Laplace's law on the real leg: P = n T / r_c (Chassagne et al. 2018, equation 1).

The cheapest estimate of the pressure under a bandage, and the one the finite element
model is compared with. r_c is the radius of curvature of the horizontal section; the
pressure is averaged over the sensor, a 50 mm disc on the medial side at point B1.
The law knows no friction, no tissue and no loss of tension.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from surrogate.errors import SolverError, StudyError, nearest
from surrogate.scene import Scene
from surrogate.solver import Input, Output

from .leg_bandage.geometry.feasibility import check_leg
from .leg_bandage.geometry.landmarks import RULES, Disc, sensor
from .leg_bandage.geometry.leg import Leg
from .leg_bandage.outputs.scene import leg_scene
from .leg_bandage.parameters import TENSION, check_ranges, shapes_in

MMHG = 1.33322e-4
"""MPa in 1 mmHg."""

ANGLES = np.arange(0.0, 360.0, 5.0)

MU_SKIN = Input(
    nominal=0.2,
    range=(0.0, 1.0),
    description="friction between skin and bandage; Laplace's law has none, so it has "
    "no effect here, and is an input because a study varies it",
    source="Chassagne et al. 2018, Table II: 0.10..0.30",
)


def laplace_pressure(tension: float, curvature, layers: int = 2) -> np.ndarray:
    """n T kappa, mmHg, of a tension in N/mm and curvatures in 1/mm.

    Zero where the section is hollow: a bandage cannot pull on the skin, it bridges.
    """
    return layers * tension * np.maximum(curvature, 0.0) / MMHG


def laplace_b1(
    leg: Leg, tension: float, layers: int = 2, rule: str = "girth"
) -> tuple[float, float, Disc]:
    """Mean pressure (mmHg) and mean curvature (1/mm, hollows as 0) over the sensor, and it.

    Raises SolverError for a leg without B1, or hollow under the whole sensor.
    """
    disc = sensor(leg, rule)
    theta, z, weights = disc.points(leg)
    curvature = leg.curvature(theta, z)
    mean = float(weights @ np.maximum(curvature, 0.0))
    if not mean > 0:
        raise SolverError(
            f"the skin is hollow under the whole sensor at B1 (z = {disc.z:.0f} "
            "mm): Laplace's law has no radius of curvature there"
        )
    return float(weights @ laplace_pressure(tension, curvature, layers)), mean, disc


def laplace_tape(girth: float, tension: float, layers: int = 2) -> float:
    """n T 2 pi / girth, mmHg, as a tape measure gives it: the section taken for a circle.

    girth in mm, tension in N/mm. On the 73 shipped legs it is above `laplace_b1`, by a quarter
    in the median: the medial side at B1 is flatter than the circle.
    """
    return float(laplace_pressure(tension, 2 * np.pi / girth, layers))


class Laplace:
    """Pressure at B1 by Laplace's law on a leg of the shape basis.

    layers   layers of bandage over B1; 2 is a spiral with 50 % overlap
    b1_rule  "girth" (sturdy) or "profile" (the paper's); see leg_bandage/landmarks.py
    cohort   a file of `leg-bandage build-cohort`: length and alphas are then those of these
             legs; relative to the study file, from Python to the current folder
    """

    version = "1"
    outputs: Mapping[str, Output] = {
        "pressure_b1": Output(
            unit="mmHg", description="mean pressure over the 50 mm sensor on the medial side at B1"
        ),
        "curvature_radius": Output(
            unit="mm", description="1 / mean curvature of the horizontal section over the sensor"
        ),
        "b1_height": Output(unit="mm", description="height of B1 above the ankle cut"),
        "pressure_around_b1": Output(
            unit="mmHg",
            dims=("theta",),
            coordinates={"theta": ANGLES},
            description="pressure around the section at B1; theta in degrees from lateral (0) "
            "by anterior (90) to medial (180) and posterior (270)",
        ),
    }

    def __init__(
        self,
        layers: int = 2,
        b1_rule: str = "girth",
        cohort: str | None = None,
        folder: Path | None = None,
    ):
        if b1_rule not in RULES:
            raise StudyError(f"b1_rule: {b1_rule!r} is unknown: {nearest(b1_rule, RULES)}")
        if not 1 <= layers <= 10:
            raise StudyError(f"layers: {layers} is not a number of layers; use 1 to 10")
        shapes = shapes_in(cohort, folder)
        self.layers, self.b1_rule, self.basis = layers, b1_rule, shapes.basis
        self.inputs: Mapping[str, Input] = {"mu_skin": MU_SKIN, "tension": TENSION, **shapes.inputs}
        self.identity_options = {"layers": layers, "b1_rule": b1_rule, "cohort": shapes.identity}

    def __call__(
        self,
        mu_skin: float,
        tension: float,
        leg_length: float,
        alpha1: float,
        alpha2: float,
        alpha3: float,
        alpha4: float,
    ) -> dict[str, float | np.ndarray]:
        alphas = (alpha1, alpha2, alpha3, alpha4)
        check_ranges(
            self.inputs,
            dict(zip(self.inputs, (mu_skin, tension, leg_length, *alphas), strict=True)),
        )
        leg = Leg.from_alphas(leg_length, alphas, self.basis)
        check_leg(leg)
        pressure, curvature, disc = laplace_b1(leg, tension, self.layers, self.b1_rule)
        around = leg.curvature(np.radians(ANGLES), disc.z)
        return {
            "pressure_b1": pressure,
            "curvature_radius": 1 / curvature,
            "b1_height": disc.z,
            "pressure_around_b1": laplace_pressure(tension, around, self.layers),
        }

    def scene(
        self,
        mu_skin: float,
        tension: float,
        leg_length: float,
        alpha1: float,
        alpha2: float,
        alpha3: float,
        alpha4: float,
    ) -> Scene:
        """The leg with the sensor: see `surrogate.scene`."""
        leg = Leg.from_alphas(leg_length, (alpha1, alpha2, alpha3, alpha4), self.basis)
        return leg_scene(leg, rule=self.b1_rule)
