"""The geometric and bandage inputs that every solver on a leg shares, with their sources.

Ranges are what the solvers accept: wider than both the shipped legs and Table II of
Chassagne et al. 2018. A point inside them may still be no possible leg; the solver
then says so.
"""

from __future__ import annotations

from collections.abc import Mapping

from solvers.leg_bandage.basis import shipped_basis
from solvers.leg_bandage.cohort import load_cohort
from surrogate.errors import SolverError
from surrogate.solver import Input


def _shape_input(number: int, accepted: tuple[float, float], table: str) -> Input:
    low, high = shipped_basis().ranges[number - 1]
    return Input(
        nominal=round(float(shipped_basis().mean[number - 1]), 4),
        range=accepted,
        description=f"coordinate of the leg on shape mode {number} of the shipped basis",
        source=f"nominal: mean of the 35 shipped legs, which span {low:.3f}..{high:.3f}; "
               f"Chassagne et al. 2018, Table II: {table}")


SHAPE: dict[str, Input] = {
    "leg_length": Input(
        unit="mm", nominal=round(float(load_cohort().length.mean()), 1), range=(140.0, 360.0),
        description="height of the bandaged leg, from the ankle to the upper cut",
        source="nominal: mean of the 35 shipped legs, which span 185.1..289.9; "
               "Chassagne et al. 2018, Table II: 184.86..290.43"),
    "alpha1": _shape_input(1, (-1.2, -0.35), "-0.920..-0.503"),
    "alpha2": _shape_input(2, (-0.25, 0.25), "-0.109..0.119"),
    "alpha3": _shape_input(3, (-0.25, 0.25), "-0.092..0.068"),
    "alpha4": _shape_input(4, (-0.20, 0.20), "-0.081..0.095"),
}

TENSION = Input(
    unit="N/mm", nominal=0.098, range=(0.0, 0.25),
    description="tension of the bandage per unit of its width, at the nominal stretch",
    source="Chassagne et al. 2018, Table II: 0.059..0.137; nominal: its centre")


def check_ranges(inputs: Mapping[str, Input], values: Mapping[str, float]) -> None:
    """Raise SolverError for the first value outside the range that its input accepts."""
    for name, value in values.items():
        low, high = inputs[name].range
        if not low <= value <= high:
            unit = f" {inputs[name].unit}".rstrip()
            raise SolverError(f"{name}: {value:g}{unit} is not between {low:g} and {high:g}{unit}, "
                              "what the solver accepts; check the value and its unit")
