"""What the solvers on a leg take: names, units, nominal values, ranges, and their sources.

Ranges are what the solvers accept: wider than both the shipped legs and Table II of
Chassagne et al. 2018. A point inside them may still be no possible leg; the solver
then says so. Length and alphas belong to a shape basis: that of the shipped legs, or that
of the user's own in a file that `leg-bandage build-cohort` wrote.
"""

from __future__ import annotations

import zipfile
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from surrogate.errors import SolverError, StudyError, nearest
from surrogate.solver import Constraint, Input

from .bandage.products import ASSUMED, NOMINAL, STRETCH
from .geometry.basis import Basis, fit_basis, shipped_basis
from .geometry.cohort import Cohort, load_cohort, read_cohort

PAPER = "Chassagne et al. 2018"
MODES = 4
"""Shape coordinates a leg has, as in the paper."""

ACCEPTED = {
    "leg_length": (140.0, 360.0),
    "alpha1": (-1.2, -0.35),
    "alpha2": (-0.25, 0.25),
    "alpha3": (-0.25, 0.25),
    "alpha4": (-0.20, 0.20),
}
TABLE_2 = {
    "leg_length": "184.86..290.43",
    "alpha1": "-0.920..-0.503",
    "alpha2": "-0.109..0.119",
    "alpha3": "-0.092..0.068",
    "alpha4": "-0.081..0.095",
}


@dataclass(frozen=True)
class Shapes:
    """A shape basis with the inputs that are measured in it.

    basis     of MODES modes
    inputs    leg_length and alpha1..alpha4
    identity  of the legs it was learnt from; None for those that ship
    """

    basis: Basis
    inputs: Mapping[str, Input]
    identity: str | None = None


def shapes_in(cohort: str | None, folder: Path | None = None) -> Shapes:
    """Basis and inputs of the legs in a file of `leg-bandage build-cohort`; None: the shipped.

    The file is looked for relative to `folder` (the study's; default the current one).
    Raises StudyError when it cannot be used.
    """
    if cohort is None:
        basis = shipped_basis(MODES)
        return Shapes(basis, _shape_inputs(basis, load_cohort(), "shipped legs", shipped=True))
    legs = legs_in("cohort", cohort, folder)
    if len(legs) <= MODES:
        raise StudyError(
            f"cohort: {cohort} holds {len(legs)} legs; {MODES} modes need at least {MODES + 1}"
        )
    basis = fit_basis(legs.snapshots(), MODES)
    return Shapes(basis, _shape_inputs(basis, legs, f"legs in {Path(cohort).name}"), legs.identity)


def legs_in(option: str, name: str, folder: Path | None = None) -> Cohort:
    """The legs in the file that an option names; raises StudyError."""
    path = Path(folder or ".") / name
    try:
        return read_cohort(path)
    except (OSError, ValueError, KeyError, zipfile.BadZipFile) as error:
        raise StudyError(
            f"{option}: {path} is not a file of legs ({type(error).__name__}: "
            f"{error}); make one with `leg-bandage build-cohort FOLDER`"
        ) from None


def _shape_inputs(basis: Basis, legs: Cohort, name: str, shipped: bool = False) -> dict[str, Input]:
    columns = {
        "leg_length": legs.length,
        **{f"alpha{k + 1}": basis.training[:, k] for k in range(MODES)},
    }
    inputs = {}
    for key, values in columns.items():
        low, high, digits = values.min(), values.max(), 1 if key == "leg_length" else 3
        source = (
            f"nominal: mean of the {len(legs)} {name}, which span {low:.{digits}f}.."
            f"{high:.{digits}f}"
        )
        inputs[key] = Input(
            unit="mm" if key == "leg_length" else "",
            nominal=round(float(values.mean()), 1 if key == "leg_length" else 4),
            range=ACCEPTED[key] if shipped else (float(2 * low - high), float(2 * high - low)),
            description="height of the bandaged leg, from the ankle to the upper cut"
            if key == "leg_length"
            else f"coordinate of the leg on shape mode {key[-1]} of the {name}",
            source=source
            + (
                f"; {PAPER}, Table II: {TABLE_2[key]}"
                if shipped
                else "; accepted: their span and as much again on both sides"
            ),
        )
    return inputs


SHAPE: Mapping[str, Input] = shapes_in(None).inputs

TENSION = Input(
    unit="N/mm",
    nominal=0.098,
    range=(0.0, 0.25),
    description="tension of the bandage per unit of its width, at the nominal stretch",
    source=f"{PAPER}, Table II: 0.059..0.137; nominal: its centre",
)

INPUTS: Mapping[str, Input] = {
    "mu_skin": Input(
        nominal=0.2,
        range=(0.05, 1.0),
        description="friction between skin and bandage",
        source=f"{PAPER}, Table II: 0.10..0.30",
    ),
    "mu_bandage": Input(
        nominal=0.6,
        range=(0.1, 1.5),
        description="friction between turns of the bandage",
        source=f"{PAPER}, Table I: 0.5..0.7",
    ),
    "tension": replace(TENSION, range=(0.02, 0.25)),
    "c10": Input(
        unit="kPa",
        nominal=5.0,
        range=(1.0, 50.0),
        description="neo-Hookean constant of the soft tissue; its shear modulus is 2 c10",
        source=f"{PAPER}, Table I: 2..8",
    ),
    **SHAPE,
    "kappa": Input(
        unit="MPa",
        nominal=14.3,
        range=(0.1, 100.0),
        description="bulk modulus of the tissue",
        source=f"{PAPER}, below equation 4",
    ),
    "stretch": Input(
        nominal=STRETCH,
        range=(1.05, 1.6),
        description="stretch of the midline as laid",
        source=f"{PAPER}: 1.3",
    ),
    "overlap": Input(
        nominal=0.5,
        range=(0.2, 0.8),
        description="share of the width that lies on the turn before",
        source=f"{PAPER}: 0.5, two layers",
    ),
    "start_height": Input(
        unit="mm",
        nominal=-10.0,
        range=(-30.0, 60.0),
        description="height of the midline at the first end above the ankle cut",
        source="assumed: two layers then begin about 15 mm above the ankle",
    ),
    "width": Input(
        unit="mm",
        nominal=100.0,
        range=(50.0, 120.0),
        description="width of the bandage",
        source=f"{PAPER}: 100 mm",
    ),
    "wrapping": Input(
        nominal="prescribed",
        levels=("prescribed", "progressive"),
        description="prescribed: laid on the undeformed leg; progressive: turn by turn on the "
        "leg as it deforms",
        source=f"{PAPER} prescribes, and names updating as the improvement",
    ),
    "tension_law": Input(
        nominal="secant",
        levels=("secant", "curved"),
        description="secant: T = K1 (stretch - 1); curved: the fabric's curve through the same "
        "tension at stretch 1.3",
        source=f"secant: {PAPER}, equation 10; curved: {ASSUMED['curve']}",
    ),
    "sensor_around": Input(
        unit="mm",
        nominal=0.0,
        range=(-30.0, 30.0),
        description="where the sensor's centre lies around the leg from B1, along the skin; "
        "towards the back is positive",
        source=f"{PAPER}: at B1; they move it by 10 mm",
    ),
    "sensor_up": Input(
        unit="mm",
        nominal=0.0,
        range=(-30.0, 30.0),
        description="where the sensor's centre lies above B1, along the skin",
        source=f"{PAPER}: at B1; they move it by 10 mm",
    ),
    "K2": Input(
        unit="N/mm",
        nominal=NOMINAL.K2,
        range=(0.01, 5.0),
        description="membrane stiffness across the bandage",
        source=ASSUMED["K2"],
    ),
    "nu12": Input(
        nominal=NOMINAL.nu12,
        range=(0.0, 0.45),
        description="weft contraction over warp extension",
        source=ASSUMED["nu12"],
    ),
    "G": Input(
        unit="N/mm",
        nominal=NOMINAL.G,
        range=(0.005, 2.0),
        description="membrane shear stiffness",
        source=ASSUMED["G"],
    ),
    "bending": Input(
        unit="N*mm",
        nominal=NOMINAL.F1,
        range=(0.005, 5.0),
        description="bending stiffness along warp and weft; torsion is 0.4 of it",
        source=ASSUMED["F1"],
    ),
    "thickness": Input(
        unit="mm",
        nominal=NOMINAL.thickness,
        range=(0.1, 2.0),
        description="thickness of one layer",
        source=ASSUMED["thickness"],
    ),
}


EXPONENT = Input(
    nominal=1.0,
    range=(0.3, 1.5),
    description="n of the tension law T = tension ((stretch - 1) / 0.3)^n; 1 is the secant",
    source=f"1: {PAPER}, equation 10; 0.64 is close to the curve of `curved`, assumed",
)

FLUID_LOSS = Input(
    nominal=0.0,
    range=(0.0, 0.12),
    description="share of the tissue's volume that leaves the leg in the end, half in 26 minutes",
    source="0: the fabric alone; 0.05: who lies down (muscle 5.5 %, fat 4.4 %; Berg, Tedner, "
    "Tesch 1993, doi 10.1111/j.1748-1716.1993.tb09573.x), time constant 37 minutes",
)

LAWS = ("power",)
"""Tension laws with inputs of their own, which stand in place of `tension_law`."""


def inputs_of(law: str | None) -> dict[str, Input]:
    """The inputs of a solver with that tension law; None: `tension_law` is an input."""
    if law is None:
        return dict(INPUTS)
    replaced = {"tension_law": ("exponent", EXPONENT)}
    return dict(replaced.get(name, (name, one)) for name, one in INPUTS.items())


def _has_a_minimum(nu12: float, K2: float, tension: float) -> bool:
    """Whether the membrane energy has one: nu12^2 K2 < K1 = tension / 0.3."""
    return nu12**2 * K2 < tension / (STRETCH - 1)


CONSTRAINTS = (
    Constraint(
        ("nu12", "K2", "tension"),
        _has_a_minimum,
        "nu12^2 K2 must be below K1 = tension / 0.3, or the fabric's energy has no minimum; "
        "lower nu12 or K2, or raise the tension",
    ),
)


def check_ranges(inputs: Mapping[str, Input], values: Mapping[str, float | str]) -> None:
    """Raise SolverError for the first value that its input does not accept."""
    for name, value in values.items():
        if inputs[name].levels:
            if value not in inputs[name].levels:
                raise SolverError(
                    f"{name}: {value!r} is unknown: {nearest(str(value), inputs[name].levels)}"
                )
            continue
        low, high = inputs[name].range
        if not low <= float(value) <= high:
            unit = f" {inputs[name].unit}".rstrip()
            raise SolverError(
                f"{name}: {value:g}{unit} is not between {low:g} and {high:g}{unit}, "
                "what the solver accepts; check the value and its unit"
            )


def complete(inputs: Mapping[str, Input], given: Mapping[str, float | str]) -> dict:
    """Every input's value: given, or nominal; raises SolverError for one that is wrong."""
    unknown = [name for name in given if name not in inputs]
    if unknown:
        raise SolverError(f"{unknown[0]}: no such input; {nearest(unknown[0], inputs)}")
    values: dict[str, Any] = {name: given.get(name, one.nominal) for name, one in inputs.items()}
    values = {
        name: value if inputs[name].levels else float(value) for name, value in values.items()
    }
    check_ranges(inputs, values)
    return values
