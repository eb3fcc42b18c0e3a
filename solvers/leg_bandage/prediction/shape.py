"""A leg as the reduced model sees it, and what that model gives on it at the points."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from surrogate.errors import SolverError

from ..geometry.basis import shipped_basis
from ..geometry.cohort import snapshot
from ..geometry.landmarks import RULES, b1_height
from ..geometry.leg import Leg
from ..scan import FittedScan
from .bandage_choice import BandageChoice
from .points import Place, corrected, places, under_sensor
from .reduced import Reduced
from .shape_correction import by_laplace_if_it_can, shape_law


@dataclass(frozen=True)
class Shape:
    """The scan's own sections, the leg that the modes make of them, and D where it is known."""

    scanned: Leg
    fitted: Leg
    knee: tuple[float, float] | None = None

    @classmethod
    def of(cls, scan: FittedScan) -> Shape:
        """The leg of a scan."""
        return cls(scan.scanned, scan.leg, scan.knee)

    @property
    def coordinates(self) -> dict[str, float]:
        """The fitted leg in the names of the solvers' inputs."""
        alphas = self.fitted.alphas or ()
        return {
            "leg_length": self.fitted.length,
            **{f"alpha{k}": alpha for k, alpha in enumerate(alphas, 1)},
        }

    def turned(self, angle: float) -> Shape:
        """The same skin with the front taken `angle` rad further towards the inside.

        r(theta - t) has the terms (a + i b) e^(i k t): here t = -angle.
        """
        waves = self.scanned.coefficients[:, 1:6] + 1j * self.scanned.coefficients[:, 6:]
        waves = waves * np.exp(-1j * angle * np.arange(1, 6))
        turned = np.column_stack([self.scanned.coefficients[:, 0], waves.real, waves.imag])
        place = self.scanned.centre @ [1, 1j] * np.exp(-1j * angle)
        centre = np.column_stack([place.real, place.imag])
        scanned = Leg.from_sections(self.scanned.length, turned, centre)
        shape = snapshot(turned, centre - centre[0], self.scanned.length)
        fitted = Leg.from_alphas(self.scanned.length, shipped_basis().project(shape))
        return Shape(scanned, fitted, self.knee)

    def places(self) -> dict[str, Place]:
        """The points on the scan's own sections."""
        return places(self.scanned, self.knee)


def pressures(
    shape: Shape, reduced: Reduced, choice: BandageChoice, mu_skin: float | None = None
) -> dict[str, float]:
    """mmHg at B, B1, C and D by the reduced model, corrected to the scan's own sections.

    B1 by the surrogate of the pressure there, the others by that of the pressure all over the
    skin. A point that either leg does not have is missing.
    """
    inputs = reduced.inputs(shape.coordinates, choice)
    if mu_skin is not None and "mu_skin" in inputs:
        inputs["mu_skin"] = mu_skin
    theta, height, field = reduced.skin_pressure(inputs)
    where, on_modes = shape.places(), places(shape.fitted)
    others = [name for name in where if name != "B1" and name in on_modes]
    read = {
        name: under_sensor(theta, height, field, shape.fitted, on_modes[name].read)
        for name in others
    }
    found = corrected(
        read,
        shape.scanned,
        shape.fitted,
        {name: where[name] for name in others},
        on_modes,
        shape_law().exponent,
    )
    if "B1" in where:
        found["B1"] = at_b1(shape, reduced, inputs)
    return {name: found[name] for name in where if name in found}


def at_b1(shape: Shape, reduced: Reduced, inputs: dict[str, float]) -> float:
    """mmHg at B1, corrected where Laplace's law has an answer on both legs."""
    laplace = {
        "scanned": by_laplace_if_it_can(shape.scanned, 1.0),
        "fitted": by_laplace_if_it_can(shape.fitted, 1.0),
    }
    factor = shape_law().factor(laplace)
    value = float(reduced.at_b1.predict(reduced.coded(inputs))[0])
    return value if factor is None else factor * value


def b1_by_rules(shape: Shape, reduced: Reduced, choice: BandageChoice) -> dict[str, RuleAtB1]:
    """Height of B1 by each rule that finds one on the fitted leg, and the pressure there.

    Pressures are those of the field, corrected: to compare the rules, not to replace the value.
    """
    inputs = reduced.inputs(shape.coordinates, choice)
    theta, height, field = reduced.skin_pressure(inputs)
    found = {}
    for rule in RULES:
        try:
            z = b1_height(shape.fitted, rule)
        except SolverError:
            continue
        place = {rule: Place(z, float(shape.scanned.girth(z)), z)}
        read = {rule: under_sensor(theta, height, field, shape.fitted, z)}
        value = corrected(read, shape.scanned, shape.fitted, place, place, shape_law().exponent)
        found[rule] = RuleAtB1(z, value[rule])
    return found


@dataclass(frozen=True)
class RuleAtB1:
    """B1 by one rule: mm above the ankle cut, and mmHg there."""

    height: float
    value: float
