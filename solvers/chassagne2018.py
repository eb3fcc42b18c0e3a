"""The published reduced model: pressure at B1 as a linear function of seven parameters.

Chassagne, Molimard, Convert, Giraux and Badel 2018, IEEE Trans. Biomed. Eng. 65(2),
449-457, doi 10.1109/TBME.2017.2774598: ranges of Table II, coefficients of Table III, coding
of equation 8. Nine simulations of resolution III stand behind it, so each coefficient
also holds the two-parameter interactions that are aliased with it. Equation 9 and Table III
call the friction bandage-bandage; the text, followed here, retains skin-bandage.
"""

from __future__ import annotations

from surrogate.errors import SolverError
from surrogate.solver import Input, Output

MEAN = 32.73
"""mmHg at the centre of all ranges."""

#: Effect in mmHg of going from the centre to the end of the range (Table III).
SLOPES = {
    "mu_skin": 2.7,
    "tension": 11.54,
    "leg_length": 2.85,
    "alpha1": 4.54,
    "alpha2": 3.92,
    "alpha3": -1.74,
    "alpha4": -0.51,
}


def _input(low: float, high: float, unit: str, description: str) -> Input:
    return Input(
        unit=unit,
        nominal=(low + high) / 2.0,
        range=(low, high),
        description=description,
        source="Chassagne et al. 2018, Table II; nominal: centre of the range",
    )


class Chassagne2018:
    """Published linear model of the bandage pressure at B1 (Chassagne et al. 2018)."""

    version = "1"
    inputs = {
        "mu_skin": _input(0.1, 0.3, "", "friction between skin and bandage"),
        "tension": _input(0.059, 0.137, "N/mm", "tension of the bandage per unit of its width"),
        "leg_length": _input(184.86, 290.43, "mm", "height of the bandaged leg"),
        "alpha1": _input(-0.92, -0.503, "", "coordinate of the leg on shape mode 1"),
        "alpha2": _input(-0.109, 0.119, "", "coordinate of the leg on shape mode 2"),
        "alpha3": _input(-0.092, 0.068, "", "coordinate of the leg on shape mode 3"),
        "alpha4": _input(-0.081, 0.095, "", "coordinate of the leg on shape mode 4"),
    }
    outputs = {
        "pressure_b1": Output(unit="mmHg", description="pressure at B1 under a two-layer bandage")
    }

    def __call__(
        self,
        mu_skin: float,
        tension: float,
        leg_length: float,
        alpha1: float,
        alpha2: float,
        alpha3: float,
        alpha4: float,
    ) -> dict[str, float]:
        values = (mu_skin, tension, leg_length, alpha1, alpha2, alpha3, alpha4)
        return {
            "pressure_b1": MEAN
            + sum(
                slope * self._coded(name, value)
                for (name, slope), value in zip(SLOPES.items(), values, strict=True)
            )
        }

    def _coded(self, name: str, value: float) -> float:
        """Equation 8: x* = 2 (x - min) / (max - min) - 1."""
        low, high = self.inputs[name].range
        # A billionth of the range forgives the rounding of a coded end.
        if not low - 1e-9 * (high - low) <= value <= high + 1e-9 * (high - low):
            raise SolverError(
                f"{name}: {value:g} {self.inputs[name].unit}".rstrip()
                + f" is not between {low:g} and {high:g}, where the published model "
                "holds; check the value and its unit"
            )
        return 2.0 * (value - low) / (high - low) - 1.0
