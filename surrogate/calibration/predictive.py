"""What the posterior says of the cases, measurement by measurement.

At one value of the unknowns, with the notation of `likelihood` and V = C + K + E, what the
measurements y tell of the solver f and of reality f + d at the cases is

    f | y ~ N(m + C V^-1 (y - m), C - C V^-1 C)
    f + d | y ~ N(m + (C + K) V^-1 (y - m), (C + K) - (C + K) V^-1 (C + K))

(Rasmussen and Williams 2006, equations 2.22 to 2.24). A new measurement adds E. The likelihood of
one measurement, given all others, is normal with mean y_i - [V^-1 (y - m)]_i / [V^-1]_ii and
variance 1 / [V^-1]_ii (Sundararajan and Keerthi 2001; Buerkner, Gabry and Vehtari 2021).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from surrogate.calibration.likelihood import LOG_2PI, Likelihood, Normal

Array = NDArray[np.float64]

#: Values of the unknowns at once.
CHUNK = 256


@dataclass(frozen=True, eq=False)
class Told:
    """Draws (draw, case) of one output at the cases; NaN where it was not measured.

    solver       the solver at the free inputs drawn
    replicate    a new measurement
    likelihood   log density of each measurement, given all others
    """

    solver: Array
    replicate: Array
    likelihood: Array


def told(likelihood: Likelihood, z: Array, seed: int) -> dict[str, Told]:
    """Draws of each output, one for each row of z (draw, unknown)."""
    rng = np.random.default_rng(seed)
    cases = len(likelihood.problem.labels)
    found = {
        one.output: Told(*(np.full((len(z), cases), np.nan) for _ in range(3)))
        for one in likelihood.problem.measured
    }
    for start in range(0, len(z), CHUNK):
        part = slice(start, start + CHUNK)
        for law in likelihood.laws(z[part]):
            own = found[law.measured.output]
            own.solver[part, law.rows], own.replicate[part, law.rows] = _drawn(law, rng)
            own.likelihood[part, law.rows] = _left_out(law)
    return found


def _drawn(law: Normal, rng: np.random.Generator) -> tuple[Array, Array]:
    solver = _conditional(law, law.emulator, rng)
    reality = _conditional(law, law.emulator + law.bias, rng)
    return solver, reality + np.sqrt(law.noise) * rng.standard_normal(law.noise.shape)


def _conditional(law: Normal, own: Array, rng: np.random.Generator) -> Array:
    """A draw (w, k) of a part of the measurements that has covariance `own`, given all of them."""
    gain = np.linalg.solve(law.covariance, own).swapaxes(1, 2)
    mean = law.mean + np.einsum("wij,wj->wi", gain, law.residual)
    covariance = own - gain @ own
    values, vectors = np.linalg.eigh(0.5 * (covariance + covariance.swapaxes(1, 2)))
    scaled = np.sqrt(np.maximum(values, 0.0)) * rng.standard_normal(values.shape)
    return np.asarray(mean + np.einsum("wij,wj->wi", vectors, scaled))


def _left_out(law: Normal) -> Array:
    inverse = np.linalg.inv(law.covariance)
    precision = np.einsum("wii->wi", inverse)
    error = np.einsum("wij,wj->wi", inverse, law.residual) / precision
    return np.asarray(0.5 * (np.log(precision) - LOG_2PI - precision * error**2))
