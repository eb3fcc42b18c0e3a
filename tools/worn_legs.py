"""Standing and four hours on several legs: finite elements beside the reduced model of a hoop.

    python tools/worn_legs.py > solvers/leg_bandage/data/worn.json

Mesh coarse, elastic bandages, some 30 s of one core a run. Legs: the mean one, corners of the
shipped shapes, and validation legs that shaped nothing.
"""

from __future__ import annotations

import json
import sys
from typing import Any

from surrogate_solvers.leg_bandage.geometry.landmarks import b1_height
from surrogate_solvers.leg_bandage.geometry.leg import Leg
from surrogate_solvers.leg_bandage.plugin import LegBandage
from surrogate_solvers.leg_bandage.prediction.worn import hoop_on
from surrogate_solvers.leg_bandage.verification.legs import leg_of, named, validation_leg

MEAN = LegBandage(mesh="coarse").inputs
CASES: tuple[tuple[str, str, float], ...] = (
    ("mean", "biflex_16", 0.05),
    ("thin", "biflex_16", 0.05),
    ("thick", "biflex_17", 0.05),
    ("3", "biflex_17", 0.0),
    ("17", "biflex_16", 0.05),
)
"""Leg (a name of `verification.legs`, or a validation leg's number), bandage, fluid loss."""


def leg_named(name: str) -> Leg:
    """One of the legs."""
    if name.isdigit():
        return validation_leg(int(name))
    shape: dict[str, Any] = {key: one.nominal for key, one in MEAN.items()}
    return leg_of(shape | named(name))


def case(name: str, bandage: str, fluid_loss: float) -> dict[str, Any]:
    """What finite elements and the hoop say."""
    leg = leg_named(name)
    solver = LegBandage("coarse", fabric=bandage, relaxation="elastic", posture="standing")
    values = solver.run(leg, fluid_loss=fluid_loss).values
    hoop = hoop_on(leg, b1_height(leg), 1.3)
    lost = solver.inputs["fluid_loss"]
    assert lost.range[0] <= fluid_loss <= lost.range[1]
    return {
        "leg": name,
        "bandage": bandage,
        "fluid_loss": fluid_loss,
        "pressure": round(float(values["pressure_supine"]), 3),
        "standing": round(float(values["pressure_standing"] / values["pressure_supine"]), 4),
        "kept_4h": round(float(values["kept_4h"]), 4),
        "girth_rise": round(float(values["girth_rise"]), 2),
        "hoop_standing": round(hoop.standing(), 4),
        "hoop_kept_4h": round(hoop.kept(240.0, fluid_loss), 4),
    }


if __name__ == "__main__":
    cases = []
    for one in CASES:
        cases.append(case(*one))
        print(json.dumps(cases[-1]), file=sys.stderr, flush=True)
    json.dump({"mesh": "coarse", "cases": cases}, sys.stdout, indent=1)
