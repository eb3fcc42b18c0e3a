"""The finite element contact model of a bandaged leg, as a solver for studies.

Chassagne et al. 2018 with its weak points mended: see README.md of this package for the
boundary value problem, its checks and what it does not know. User units at this door
(mm, N/mm, kPa, mmHg), N, mm and MPa inside.
"""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from surrogate.errors import SolverError, StudyError, nearest
from surrogate.scene import Scene
from surrogate.solver import Input, Output

from .algebra.direct import ENGINES
from .bandage.fabric import Fabric
from .bandage.products import (
    CURVED,
    NOMINAL,
    STRETCH,
    Bandage,
    Curve,
    at_tension,
    bandage,
    power_law,
)
from .bandage.relaxation import RELAXATIONS
from .equilibrium.loading import solve
from .equilibrium.model import (
    ABOVE,
    BELOW,
    MESHES,
    Ends,
    Material,
    Model,
    Over,
    build,
    mesh_leg,
)
from .equilibrium.progressive import wrap_and_solve
from .geometry.bone import bone_envelope
from .geometry.feasibility import check_leg
from .geometry.landmarks import MEDIAL, RULES, Disc, b1_height
from .geometry.leg import Leg
from .layers import read_layers
from .outputs.answers import OUTPUTS, answers, outputs_of
from .outputs.result import Result
from .outputs.scene import leg_scene
from .outputs.wear import Wear
from .parameters import (
    CONSTRAINTS,
    FLUID_LOSS,
    INPUTS,
    LAWS,
    SHAPE,
    complete,
    inputs_of,
    shapes_in,
)
from .skin_friction import SKINS, mu_of
from .tissue.posture import POSTURES
from .wrapping.lay import Lay, element_rows, lay
from .wrapping.spiral import Wrap, wrap_for

WRINKLED = 0.05
"""Share of the warp stiffness left where the bandage is compressed: assumed."""


class Further(NamedTuple):
    """A bandage over the first: how it is put on, and its fabric."""

    wrap: Wrap
    fabric: Fabric


class LegBandage:
    """Interface pressure under a bandage wrapped on a leg, by finite element contact.

    mesh           "coarse", "medium" or "fine"
    end            the free end: "clipped" to what lies beneath, or "held" in place
    leg_ends       cut faces of the leg: "free", "no_axial" or "pinned"
    b1_rule        which B1 the sensor lies at: "girth" or "profile"
    fabric         a named bandage whose constants become the nominal inputs, or none
    cohort         a file of `leg-bandage build-cohort`: length and alphas are then those of
                   these legs; relative to the study file, from Python to the current folder
    relaxation     "elastic", "minimal_stretch" or "inelastic": the fabric relaxes, with input
                   `fluid_loss` and outputs over time; default: it does not
    posture        "standing" or "dorsiflexion": the pressure in these postures as well; the
                   bandage is laid, and everything else answered, on a leg that lies
    skin           "dry", "moist" or "moist_hairy": whose friction is the nominal one
    law            "power": input `exponent` in place of `tension_law`, so that the tension law
                   can be learnt from pressures
    layers         several bandages over each other, with padding or without: see `layers`
    linear_solver  "auto", "superlu" or "pardiso"; no answer hangs on it
    folder         where `cohort` is looked for
    """

    version = "3"
    outputs: Mapping[str, Output] = OUTPUTS
    constraints = CONSTRAINTS

    def __init__(
        self,
        mesh: str = "medium",
        end: str = "clipped",
        leg_ends: str = "free",
        b1_rule: str = "girth",
        fabric: str | None = None,
        cohort: str | None = None,
        linear_solver: str = "auto",
        folder: Path | None = None,
        law: str | None = None,
        relaxation: str | None = None,
        posture: str | None = None,
        skin: str | None = None,
        layers: Sequence[Mapping[str, Any]] | None = None,
    ):
        for name, value, allowed in (
            ("mesh", mesh, MESHES),
            ("end", end, ("clipped", "held")),
            ("b1_rule", b1_rule, RULES),
            ("leg_ends", leg_ends, ("free", "no_axial", "pinned")),
            ("law", law or LAWS[0], LAWS),
            ("relaxation", relaxation or "elastic", RELAXATIONS),
            ("posture", posture or "lying", POSTURES),
            ("skin", skin or "dry", SKINS),
            ("linear_solver", linear_solver, (*ENGINES, "auto")),
        ):
            if value not in allowed:
                raise StudyError(f"{name}: {value!r} is unknown: {nearest(value, allowed)}")
        self.mesh, self.b1_rule, self.solver = MESHES[mesh], b1_rule, linear_solver
        self.ends = Ends(free=end, leg=leg_ends)
        if fabric is not None and layers is not None:
            raise StudyError("fabric: layers name their products; leave one of the two out")
        self.layers = None if layers is None else read_layers(layers)
        first = fabric if self.layers is None else self.layers.bandages[0].name
        chosen = None if first is None else _named(first)
        self.fabric, self.curve = (
            (NOMINAL, CURVED) if chosen is None else (chosen.fabric, chosen.curve)
        )
        shapes = shapes_in(cohort, folder)
        self.basis = shapes.basis
        own = {} if chosen is None else _nominal(chosen)
        if skin is not None:
            own = {**own, "mu_skin": mu_of(skin)}
        self.inputs = {**inputs_of(law), **shapes.inputs, **own}
        if relaxation is not None:
            self.inputs["fluid_loss"] = FLUID_LOSS
        self.wear = Wear(relaxation, None if posture == "lying" else posture)
        if self.layers is not None:
            self.inputs |= self.layers.inputs
        bandages = 1 if self.layers is None else len(self.layers.bandages)
        self.outputs = {**outputs_of(bandages), **self.wear.outputs}
        #: What answers hang on besides the inputs: runs with the same are the same runs.
        self.identity_options = {
            "mesh": mesh,
            "end": end,
            "leg_ends": leg_ends,
            "b1_rule": b1_rule,
            "curve": self.curve,
            "cohort": shapes.identity,
            **({} if law is None else {"law": law}),
            **self.wear.options,
            **({} if self.layers is None else {"layers": self.layers.identity}),
        }

    def __call__(self, **inputs: float | str) -> dict[str, float | np.ndarray]:
        """The outputs at these inputs; what is not given has its nominal value."""
        return self.run(None, **inputs).values

    def run(
        self, leg: Leg | None = None, stretch_free: float | None = None, **inputs: float | str
    ) -> Result:
        """The same with the model and its displacements, for export and pictures.

        leg           a leg with sections of its own, in place of leg_length and alpha1..alpha4
        stretch_free  stretch of the midline at the free end, if it changes evenly along the leg

        Raises SolverError for inputs out of range, impossible legs, and runs that do not
        converge, with the last step, the residual and where.
        """
        start = time.perf_counter()
        q = complete(self.inputs, inputs)
        if leg is None:
            leg = self._leg(q)
        elif twice := [name for name in inputs if name in SHAPE]:
            raise SolverError(
                f"{twice[0]}: the leg that is given has its own shape; leave {', '.join(twice)} out"
            )
        check_leg(leg)
        leg, wrap = _wrapped(leg, q)
        if stretch_free is not None:
            complete(self.inputs, {"stretch": stretch_free})
            wrap = replace(wrap, stretch_free=stretch_free)
        model, u = self._solve(leg, *self._put_on(leg, wrap, self._material(q), q))
        values = answers(leg, model, u, self.b1_rule, q["sensor_around"], q["sensor_up"])
        place = Disc(MEDIAL, b1_height(leg, self.b1_rule)).moved(
            leg, q["sensor_around"], q["sensor_up"]
        )
        more, states = self.wear.answers(leg, model, u, place, q.get("fluid_loss", 0.0))
        seconds = time.perf_counter() - start
        return Result(leg, model, u, {**values, **more}, seconds, states)

    def scene(self, **inputs: float | str) -> Scene:
        """The leg before it is pressed, with turns and sensor: see `surrogate.scene`."""
        q = complete(self.inputs, inputs)
        leg, wrap = _wrapped(self._leg(q), q)
        place = {"around": q["sensor_around"], "up": q["sensor_up"]}
        return leg_scene(leg, wrap, rule=self.b1_rule, **place, fields=("pressure_field",))

    def _leg(self, q: Mapping[str, Any]) -> Leg:
        alphas = [q[f"alpha{i}"] for i in range(1, 5)]
        return Leg.from_alphas(q["leg_length"], alphas, self.basis)

    def _put_on(
        self, leg: Leg, wrap: Wrap, material: Material, q: Mapping[str, Any]
    ) -> tuple[Wrap, Material, str, tuple[Further, ...]]:
        """What `_solve` takes: the first bandage with its padding, and those over it."""
        if self.layers is None:
            return wrap, material, q["wrapping"], ()
        padding = self.layers.padding(leg, q, material.fabric)
        first, *wraps = self.layers.wraps(leg, wrap, q, padding)
        fabrics = self.layers.fabrics(q, WRINKLED, q.get("tension_law") == "curved")
        further = tuple(Further(*one) for one in zip(wraps, fabrics, strict=True))
        return first, replace(material, padding=padding), q["wrapping"], further

    def _solve(
        self,
        leg: Leg,
        wrap: Wrap,
        material: Material,
        wrapping: str,
        further: tuple[Further, ...] = (),
    ) -> tuple[Model, np.ndarray]:
        laid = self._lay(leg, wrap)
        mesh = mesh_leg(leg, bone_envelope(leg), self.mesh)
        if wrapping == "progressive":
            return wrap_and_solve(
                mesh, laid, wrap, material=material, ends=self.ends, solver=self.solver
            )
        over: list[Over] = []
        for one in further:
            below = [laid, *(sheet.lay for sheet in over)]
            over.append(Over(self._lay(leg, one.wrap, below), one.wrap, one.fabric))
        model = build(mesh, laid, wrap, material, self.ends, self.solver, over=over)
        return model, solve(model)

    def _lay(self, leg: Leg, wrap: Wrap, below: Sequence[Lay] = ()) -> Lay:
        rows = element_rows(leg.surface, wrap, self.mesh.around)
        return lay(leg.surface, wrap, rows, self.mesh.across, below)

    def _curve(self, q: Mapping[str, Any]) -> Curve:
        """(stretch, tension over that at stretch 1.3); none: the secant."""
        if "exponent" in q:
            return power_law(q["exponent"])
        return self.curve if q["tension_law"] == "curved" else ()

    def _material(self, q: Mapping[str, Any]) -> Material:
        fabric = replace(
            self.fabric,
            K2=q["K2"],
            nu12=q["nu12"],
            G=q["G"],
            F1=q["bending"],
            F2=q["bending"],
            tau12=0.4 * q["bending"],
            thickness=q["thickness"],
            wrinkled=WRINKLED,
            curve=self._curve(q),
        )
        return Material(
            fabric=at_tension(q["tension"], fabric),
            c10=q["c10"] / 1000,
            kappa=q["kappa"],
            mu_skin=q["mu_skin"],
            mu_bandage=q["mu_bandage"],
        )


def _wrapped(leg: Leg, q: Mapping[str, Any]) -> tuple[Leg, Wrap]:
    """The leg taken beyond its cuts, and how the bandage is put on."""
    wrap = wrap_for(
        leg.length,
        overlap=q["overlap"],
        width=q["width"],
        stretch=q["stretch"],
        thickness=q["thickness"],
        start_height=q["start_height"],
    )
    return leg.extended(BELOW, ABOVE), wrap


def _named(fabric: str) -> Bandage:
    try:
        return bandage(fabric)
    except SolverError as error:
        raise StudyError(f"fabric: {error}") from error


def _nominal(chosen: Bandage) -> Mapping[str, Input]:
    """The inputs whose nominal values are a named bandage's."""
    values = {name: getattr(chosen.fabric, name) for name in ("K2", "nu12", "G", "thickness")}
    values |= {
        "bending": chosen.fabric.F1,
        "width": chosen.width,
        "tension": float(chosen.fabric.tension(np.array(STRETCH))),
    }
    if chosen.curved:
        values["tension_law"] = "curved"
    return {name: replace(INPUTS[name], nominal=value) for name, value in values.items()}
