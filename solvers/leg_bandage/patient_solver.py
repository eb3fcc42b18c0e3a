"""Legs with sections of their own, one after the other: the cases of a validation.

A reduced model sees a leg as a length and four coordinates of a basis. Here the contact model
is solved on the leg's own sections, and what a reduced model would be told of that leg comes
out beside the pressure, so that the outputs of a study over patients are the cases on which
reduced models are judged.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from surrogate.solver import Input, Output

from ..laplace import laplace_b1
from .bandage.products import BANDAGES, STRETCH, bandage
from .geometry.basis import reconstruction_errors
from .geometry.cohort import Cohort, load_cohort
from .geometry.leg import Leg
from .outputs.answers import OUTPUTS
from .parameters import INPUTS, MODES, complete, legs_in
from .plugin import LegBandage

SOLVED = (
    "pressure_b1",
    "pressure_field",
    "b1_height",
    "stretch_midline",
    "slip_max",
    "layers_b1",
    "iterations",
)
"""Outputs of the contact model that are passed on."""

TOLD: Mapping[str, Output] = {
    "tension": Output(
        unit="N/mm", description="K1 (stretch - 1), Chassagne et al. 2018, equation 10"
    ),
    "leg_length": Output(unit="mm", description="length of the leg"),
    **{
        f"alpha{k + 1}": Output(description=f"coordinate of the leg on shape mode {k + 1}")
        for k in range(MODES)
    },
    "shape_error": Output(
        unit="mm",
        description="root mean square distance between the leg's skin and that of its "
        "coordinates, points at the same angle",
    ),
    "pressure_laplace": Output(
        unit="mmHg",
        description="Laplace's law on the leg's own sections, 2 layers, mean over the sensor at B1",
    ),
}


class LegBandagePatient:
    """Pressure under a named bandage on a leg's own sections, and that leg's coordinates.

    legs      a file of `leg-bandage build-cohort`: the legs; default: the 38 validation legs
              that ship
    cohort    another such file: the legs that the basis of the coordinates is learnt from;
              default: the 35 that ship. Both are relative to the study file, from Python to
              the current folder

    mesh, end, leg_ends, b1_rule, linear_solver  as those of `leg_bandage`
    """

    version = LegBandage.version
    outputs: Mapping[str, Output] = {**{name: OUTPUTS[name] for name in SOLVED}, **TOLD}

    def __init__(
        self,
        mesh: str = "medium",
        end: str = "clipped",
        leg_ends: str = "free",
        b1_rule: str = "girth",
        legs: str | None = None,
        cohort: str | None = None,
        linear_solver: str = "auto",
        folder: Path | None = None,
    ):
        self.solvers = {
            name: LegBandage(mesh, end, leg_ends, b1_rule, name, cohort, linear_solver, folder)
            for name in BANDAGES
        }
        self.legs = load_cohort("val") if legs is None else legs_in("legs", legs, folder)
        first = next(iter(self.solvers.values()))
        self.basis, self.b1_rule = first.basis, b1_rule
        digits = max(2, len(str(len(self.legs))))
        self.names = tuple(f"patient_{i + 1:0{digits}d}" for i in range(len(self.legs)))
        self.inputs = {
            **_inputs(self.names, legs),
            **{name: INPUTS[name] for name in ("mu_skin", "stretch")},
        }
        self.identity_options = {
            **first.identity_options,
            "legs": None if legs is None else self.legs.identity,
            "curve": None,
        }

    def __call__(self, **inputs: float | str) -> dict[str, float | np.ndarray]:
        """The outputs for one leg and bandage; raises SolverError like `leg_bandage`."""
        q = complete(self.inputs, inputs)
        one = self._one(self.names.index(q["leg"]))
        leg = Leg.from_sections(one.length[0], one.coefficients[0], one.centre[0])
        given = {name: q[name] for name in ("mu_skin", "stretch")}
        solved = self.solvers[q["bandage"]].run(leg, **given).values
        tension = bandage(q["bandage"]).fabric.K1 * (q["stretch"] - 1)
        alphas = self.basis.project(one.snapshots().T)[0]
        _, away = reconstruction_errors(self.basis, one)
        return {
            **{name: solved[name] for name in SOLVED},
            "tension": tension,
            "leg_length": leg.length,
            **{f"alpha{k + 1}": float(alpha) for k, alpha in enumerate(alphas)},
            "shape_error": float(np.sqrt(np.mean(away**2))),
            "pressure_laplace": laplace_b1(leg, tension, rule=self.b1_rule)[0],
        }

    def _one(self, index: int) -> Cohort:
        part = slice(index, index + 1)
        return replace(
            self.legs,
            coefficients=self.legs.coefficients[part],
            centre=self.legs.centre[part],
            length=self.legs.length[part],
            facts={},
        )


def _inputs(names: tuple[str, ...], legs: str | None) -> dict[str, Input]:
    source = (
        "the validation legs that ship; not one of them shaped the basis"
        if legs is None
        else Path(legs).name
    )
    return {
        "leg": Input(nominal=names[0], levels=names, description="the leg", source=source),
        "bandage": Input(
            nominal="biflex_16",
            levels=tuple(BANDAGES),
            description=f"its constants; its tension is that at stretch {STRETCH}",
            source="; ".join(f"{name}: {bandage(name).sources['K1']}" for name in BANDAGES),
        ),
    }
