"""A solver with the parameters of the contact model and an answer that is known.

pressure_b1 = 300 tension + 20 (mu_skin - 0.2) + 0.05 (leg_length - 237) + 10 alpha1
              + 5 alpha2 - 4 alpha3 + 3 alpha4 + 10, mmHg, and all over the skin that
times (1 + cos(theta - 180 degrees) / 2) (1 - height / 2).
"""

import numpy as np

from surrogate.solver import Input, Output

ANGLES, HEIGHTS = np.arange(0.0, 360.0, 30.0), np.linspace(0.0, 1.0, 6)
SLOPES = {
    "mu_skin": 20.0,
    "tension": 300.0,
    "leg_length": 0.05,
    "alpha1": 10.0,
    "alpha2": 5.0,
    "alpha3": -4.0,
    "alpha4": 3.0,
}
REST = 10.0 - 20.0 * 0.2 - 0.05 * 237.0


class CheapLeg:
    """Linear in everything."""

    version = "1"
    inputs = {name: Input() for name in SLOPES}
    outputs = {
        "pressure_b1": Output(unit="mmHg"),
        "pressure_field": Output(
            unit="mmHg", dims=("theta", "height"), coordinates={"theta": ANGLES, "height": HEIGHTS}
        ),
    }

    def __call__(self, **inputs):
        value = REST + sum(SLOPES[name] * x for name, x in inputs.items())
        around = 1 + np.cos(np.radians(ANGLES - 180.0)) / 2
        return {"pressure_b1": value, "pressure_field": value * np.outer(around, 1 - HEIGHTS / 2)}
