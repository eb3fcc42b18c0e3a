"""The finite element contact model of a bandaged leg, as a solver for studies.

Chassagne et al. 2018 with its weak points mended: see README.md of this package for the
boundary value problem, its checks and what it does not know. User units at this door
(mm, N/mm, kPa, mmHg), N, mm and MPa inside.
"""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from solvers.leg_bandage import outputs as read
from solvers.leg_bandage.bandages import ASSUMED, NOMINAL, STRETCH, at_tension, bandage
from solvers.leg_bandage.bone import bone_of
from solvers.leg_bandage.direct import ENGINES
from solvers.leg_bandage.feasibility import check_leg
from solvers.leg_bandage.landmarks import MEDIAL, RULES, Disc, b1_height, extreme_girths
from solvers.leg_bandage.leg import Leg
from solvers.leg_bandage.loading import solve
from solvers.leg_bandage.model import ABOVE, BELOW, MESHES, Ends, Material, Model, build, mesh_leg
from solvers.leg_bandage.parameters import SHAPE, TENSION, check_ranges
from solvers.leg_bandage.progressive import wrap_and_solve
from solvers.leg_bandage.wrapping import Wrap, element_rows, lay, wrap_for
from surrogate.errors import SolverError, StudyError, nearest
from surrogate.solver import Input, Output

ANGLES = np.arange(0.0, 360.0, 5.0)
HEIGHTS = np.round(np.arange(0.0, 1.001, 0.02), 2)
PAPER = "Chassagne et al. 2018"

INPUTS: Mapping[str, Input] = {
    "mu_skin": Input(
        nominal=0.2, range=(0.05, 1.0), description="friction between skin and bandage",
        source=f"{PAPER}, Table II: 0.10..0.30"),
    "mu_bandage": Input(
        nominal=0.6, range=(0.1, 1.5), description="friction between turns of the bandage",
        source=f"{PAPER}, Table I: 0.5..0.7"),
    "tension": replace(TENSION, range=(0.02, 0.25)),
    "c10": Input(
        unit="kPa", nominal=5.0, range=(1.0, 50.0),
        description="neo-Hookean constant of the soft tissue; its shear modulus is 2 c10",
        source=f"{PAPER}, Table I: 2..8"),
    **SHAPE,
    "kappa": Input(
        unit="MPa", nominal=14.3, range=(0.1, 100.0), description="bulk modulus of the tissue",
        source=f"{PAPER}, below equation 4"),
    "stretch": Input(
        nominal=STRETCH, range=(1.05, 1.6), description="stretch of the midline as laid",
        source=f"{PAPER}: 1.3"),
    "overlap": Input(
        nominal=0.5, range=(0.2, 0.75),
        description="share of the width that lies on the turn before",
        source=f"{PAPER}: 0.5, two layers"),
    "width": Input(
        unit="mm", nominal=100.0, range=(50.0, 120.0), description="width of the bandage",
        source=f"{PAPER}: 100 mm"),
    "K2": Input(
        unit="N/mm", nominal=NOMINAL.K2, range=(0.01, 5.0),
        description="membrane stiffness across the bandage", source=ASSUMED["K2"]),
    "nu12": Input(
        nominal=NOMINAL.nu12, range=(0.0, 0.45),
        description="weft contraction over warp extension", source=ASSUMED["nu12"]),
    "G": Input(
        unit="N/mm", nominal=NOMINAL.G, range=(0.005, 2.0),
        description="membrane shear stiffness", source=ASSUMED["G"]),
    "bending": Input(
        unit="N*mm", nominal=NOMINAL.F1, range=(0.005, 5.0),
        description="bending stiffness along warp and weft; torsion is 0.4 of it",
        source=ASSUMED["F1"]),
    "thickness": Input(
        unit="mm", nominal=NOMINAL.thickness, range=(0.1, 2.0),
        description="thickness of one layer", source=ASSUMED["thickness"]),
}


WRINKLED = 0.05
"""Share of the warp stiffness left where the bandage is compressed: assumed."""


def _mmhg(description: str, gaps: bool = False) -> Output:
    return Output(unit="mmHg", description=description, gaps=gaps)


OUTPUTS: Mapping[str, Output] = {
    "pressure_b1": _mmhg("mean over the 50 mm sensor on the medial side at B1"),
    "pressure_field": Output(
        unit="mmHg", dims=("theta", "height"), coordinates={"theta": ANGLES, "height": HEIGHTS},
        description="interface pressure on the skin; theta in degrees from lateral (0) by "
                    "anterior (90) to medial (180), height over leg length"),
    "pressure_b1_girth": _mmhg("the same sensor at B1 by the girth rule"),
    "pressure_b1_profile": _mmhg("the same sensor at B1 by the paper's profile rule; NaN "
                                 "where the profile has no such point", gaps=True),
    "pressure_ankle": _mmhg("the sensor with its lower rim at the narrowest girth"),
    "pressure_calf": _mmhg("the sensor at the widest girth, or as high as two layers reach"),
    "sensor_variation": _mmhg("mean change of pressure_b1 when the sensor moves by 10 mm"),
    "b1_height": Output(unit="mm", description="height of B1 above the ankle cut"),
    "stretch_midline": Output(description="mean warp stretch of the midline, end turns left out"),
    "stretch_top": Output(description="the same at the upper edge"),
    "stretch_bottom": Output(description="the same at the lower edge"),
    "slip_max": Output(unit="mm", description="farthest that the bandage slid on the skin"),
    "slip_mean": Output(unit="mm", description="how far it slid on the skin, mean over the strip"),
    "layers_b1": Output(description="layers of bandage over B1, mean over the sensor"),
    "turns": Output(description="turns of the bandage around the leg"),
    "steps": Output(description="load steps taken"),
    "iterations": Output(description="Newton iterations taken, those of steps undone included"),
    "seconds": Output(unit="s", description="wall time of the run"),
    "residual": Output(unit="MPa", description="traction that still moved the bandage at rest"),
}


@dataclass(frozen=True)
class Result:
    """A solved run: the model, its displacements (ndof,), the undeformed leg and the outputs."""

    leg: Leg
    model: Model
    u: np.ndarray
    values: dict[str, float | np.ndarray]


class LegBandage:
    """Interface pressure under a bandage wrapped on a leg, by finite element contact.

    mesh           "coarse", "medium" or "fine"
    wrapping       "prescribed": laid on the undeformed leg (the paper);
                   "progressive": turn by turn on the leg as it deforms
    end            the free end: "clipped" to what lies beneath, or "held" in place
    leg_ends       cut faces of the leg: "free", "no_axial" or "pinned"
    b1_rule        which B1 `pressure_b1` is read at: "girth" or "profile"
    fabric         a named bandage whose constants become the nominal inputs, or none
    start_height   height of the midline at the first end, mm above the ankle
    linear_solver  "auto", "superlu" or "pardiso"
    """

    version = "1"
    outputs = OUTPUTS

    def __init__(self, mesh: str = "medium", wrapping: str = "prescribed", end: str = "clipped",
                 leg_ends: str = "free", b1_rule: str = "girth", fabric: str | None = None,
                 start_height: float = -10.0, linear_solver: str = "auto"):
        for name, value, allowed in (
            ("mesh", mesh, MESHES), ("wrapping", wrapping, ("prescribed", "progressive")),
            ("end", end, ("clipped", "held")), ("b1_rule", b1_rule, RULES),
            ("leg_ends", leg_ends, ("free", "no_axial", "pinned")),
            ("linear_solver", linear_solver, (*ENGINES, "auto")),
        ):
            if value not in allowed:
                raise StudyError(f"{name}: {value!r} is unknown: {nearest(value, allowed)}")
        if not -30 <= start_height <= 60:
            raise StudyError(f"start_height: {start_height} mm is not between -30 and 60 mm")
        self.mesh, self.wrapping, self.b1_rule = MESHES[mesh], wrapping, b1_rule
        self.ends, self.solver = Ends(free=end, leg=leg_ends), linear_solver
        self.start_height, self.fabric = start_height, NOMINAL
        self.inputs = dict(INPUTS)
        if fabric is not None:
            self._take_fabric(fabric)

    def __call__(self, **inputs: float) -> dict[str, float | np.ndarray]:
        """The outputs at these inputs; what is not given has its nominal value."""
        return self.run(**inputs).values

    def run(self, **inputs: float) -> Result:
        """The same with the model and its displacements, for export and pictures.

        Raises SolverError for inputs out of range, impossible legs, and runs that do not
        converge, with the last step, the residual and where.
        """
        start = time.perf_counter()
        q = self._complete(inputs)
        leg = Leg.from_alphas(q["leg_length"], [q[f"alpha{i}"] for i in range(1, 5)])
        check_leg(leg)
        leg = leg.extended(BELOW, ABOVE)
        wrap = wrap_for(
            leg.length, overlap=q["overlap"], width=q["width"], stretch=q["stretch"],
            thickness=q["thickness"], start_height=self.start_height)
        model, u = self._solve(leg, wrap, self._material(q))
        values = self._read(leg, model, u)
        values["seconds"] = time.perf_counter() - start
        return Result(leg, model, u, values)

    def _solve(self, leg: Leg, wrap: Wrap, material: Material) -> tuple[Model, np.ndarray]:
        laid = lay(leg.surface, wrap, element_rows(leg.surface, wrap, self.mesh.row),
                   self.mesh.across)
        mesh = mesh_leg(leg, bone_of(leg), self.mesh)
        given = {"material": material, "ends": self.ends, "solver": self.solver}
        if self.wrapping == "progressive":
            return wrap_and_solve(mesh, laid, wrap, **given)
        model = build(mesh, laid, wrap, **given)
        return model, solve(model)

    def _take_fabric(self, name: str) -> None:
        try:
            chosen = bandage(name)
        except SolverError as error:
            raise StudyError(f"fabric: {error}") from error
        self.fabric = chosen.fabric
        nominal = {name: getattr(chosen.fabric, name) for name in ("K2", "nu12", "G", "thickness")}
        nominal |= {"bending": chosen.fabric.F1, "width": chosen.width,
                    "tension": float(chosen.fabric.tension(np.array(STRETCH)))}
        for key, value in nominal.items():
            self.inputs[key] = replace(self.inputs[key], nominal=value)

    def _complete(self, inputs):
        unknown = [name for name in inputs if name not in self.inputs]
        if unknown:
            raise SolverError(f"{unknown[0]}: no such input; {nearest(unknown[0], self.inputs)}")
        values = {name: float(inputs.get(name, one.nominal)) for name, one in self.inputs.items()}
        check_ranges(self.inputs, values)
        return values

    def _material(self, q) -> Material:
        fabric = replace(
            self.fabric, K2=q["K2"], nu12=q["nu12"], G=q["G"], F1=q["bending"], F2=q["bending"],
            tau12=0.4 * q["bending"], thickness=q["thickness"], wrinkled=WRINKLED)
        return Material(
            fabric=at_tension(q["tension"], fabric), c10=q["c10"] / 1000, kappa=q["kappa"],
            mu_skin=q["mu_skin"], mu_bandage=q["mu_bandage"])

    def _read(self, leg: Leg, model: Model, u) -> dict[str, float | np.ndarray]:
        found, cost = read.imprint(model, u), model.problem.cost
        heights = {rule: _height(leg, rule) for rule in RULES}
        z = heights[self.b1_rule]
        if not np.isfinite(z):
            b1_height(leg, self.b1_rule)
        _, ankle, _, calf = extreme_girths(leg)
        highest = leg.length - model.wrap.pitch - 25.0

        def pressed(height, theta=MEDIAL):
            return read.on_disc(found, leg, Disc(theta, height))

        at_b1, layers = pressed(z)
        moved = [pressed(z + dz, MEDIAL + dt)[0] for dt, dz in _circle(leg, z, 10.0)]
        rows = read.inner_rows(model)
        return {
            "pressure_b1": at_b1,
            "pressure_field": read.field(found, leg, np.radians(ANGLES), HEIGHTS),
            "pressure_b1_girth": pressed(heights["girth"])[0],
            "pressure_b1_profile": pressed(heights["profile"])[0],
            "pressure_ankle": pressed(ankle + 25.0)[0],
            "pressure_calf": pressed(min(calf, highest))[0],
            "sensor_variation": float(np.mean(np.abs(np.array(moved) - at_b1))),
            "b1_height": z,
            **{f"stretch_{name}": float(values[rows].mean())
               for name, values in read.stretches(model, u).items()},
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


def _circle(leg, z, radius, places=8):
    """Shifts (theta, z) of a sensor to places on a circle of `radius` mm around B1."""
    angle = 2 * np.pi * np.arange(places) / places
    turn = np.linalg.norm(leg.surface(MEDIAL, z, d_theta=1))
    return list(zip(radius * np.cos(angle) / turn, radius * np.sin(angle), strict=True))
