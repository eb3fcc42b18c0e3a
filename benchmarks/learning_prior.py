"""The prior of learning curves: how errors of eighteen published functions fall.

    python benchmarks/learning_prior.py

Empirical Bayes: slope b and bend q of log error = log a - b x - q x^2, x = log(n / N), are normal
over curves; their means and standard deviations have the largest marginal likelihood of the curves
of Gaussian processes and polynomial chaos with ten and with twenty runs a parameter. None of the
functions is in `benchmarks/learning.py`, which judges forecasts made with the prior. Curves that
end in rounding are left out. A quarter of an hour of processor time.

                              slope -b            bend -q
    largest likelihood        -1.85 +- 1.00       -0.14 +- 0.20      66 curves

These are `power_law.ANY_FORM`.

Functions as in the library of Surjanovic and Bingham (sfu.ca/~ssurjano), where sources are given.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass

import numpy as np
import public_functions as public
from learning import curves
from numpy.typing import NDArray
from scipy.optimize import minimize

from surrogate.errors import FitError
from surrogate.fitting.bent_line import STRAYS, WIDE, log_evidence
from surrogate.fitting.learning import Curve
from surrogate.fitting.power_law import covariance_of_medians
from surrogate.regressors.chaos import PolynomialChaos
from surrogate.regressors.gaussian_process import GaussianProcess
from surrogate.solver import Input, Output

Array = NDArray[np.float64]
#: Curves whose error falls by more than this in logarithms, or below, end in rounding.
FALL, LOWEST = 25.0, -15.0


@dataclass(frozen=True)
class Function:
    """A function of inputs with ranges, in the order of its arguments."""

    ranges: Mapping[str, tuple[float, float]]
    of: Callable[..., Array]
    outputs = {"y": Output()}

    @property
    def inputs(self) -> dict[str, Input]:
        return {
            name: Input(nominal=0.5 * (low + high), range=(low, high))
            for name, (low, high) in self.ranges.items()
        }

    def __call__(self, **at: Array) -> dict[str, Array]:
        return {"y": self.of(*(np.asarray(at[name], dtype=float) for name in self.ranges))}


def _inputs(size: int, low: float = 0.0, high: float = 1.0) -> dict[str, tuple[float, float]]:
    return {f"x{k}": (low, high) for k in range(1, size + 1)}


def by_inputs(of: Callable[[Array], Array]) -> Callable[..., Array]:
    """A function of rows (inputs, n), as in `public_functions`, as one of the inputs."""
    return lambda *x: of(np.array(x))


def dette_exponential(a: Array, b: Array, c: Array) -> Array:
    powers = ((a, 1.75), (b, 1.5), (c, 1.25))
    return 100.0 * sum(np.exp(-2.0 / np.maximum(x, 1e-3) ** power) for x, power in powers)


def rosenbrock(*x: Array) -> Array:
    return sum(100 * (b - a**2) ** 2 + (1 - a) ** 2 for a, b in zip(x, x[1:], strict=False))


def zakharov_log(*x: Array) -> Array:
    weighted = sum(0.5 * (k + 1) * v for k, v in enumerate(x))
    return np.log(1 + sum(v**2 for v in x) + weighted**2)


def loeppky(a: Array, b: Array, c: Array, d: Array, e: Array, f: Array, g: Array) -> Array:
    linear = 6 * a + 4 * b + 5.5 * c + d + 0.5 * e + 0.2 * f + 0.1 * g
    return linear + 3 * a * b + 2.2 * a * c + 1.4 * b * c


def steel_column(
    Fs: Array, P1: Array, P2: Array, P3: Array, B: Array, D: Array, H: Array, F0: Array, E: Array
) -> Array:
    load, euler = P1 + P2 + P3, np.pi**2 * E * B * D * H**2 / 2 / 7500**2
    return Fs - load * (1 / (2 * B * D) + F0 / (B * D * H) * euler / (euler - load))


def oscillator(k: Array, c: Array, m: Array, x0: Array) -> Array:
    damping = c / (2 * m)
    return x0 * np.exp(-damping) * np.cos(np.sqrt(k / m - damping**2))


def sulfur(*x: Array) -> Array:
    Tr, Ac, Rs, beta, psi, f, Q, Y, L = x
    return -1361e12 / 2 * Tr**2 * (1 - Ac) * Rs**2 * beta * psi * f * 3 * Q * Y * L / 5.1e14


FUNCTIONS = {
    "dette_curved": Function(_inputs(3), by_inputs(public.dette_curved)),
    "dette_exponential": Function(_inputs(3), dette_exponential),
    "dette_8d": Function(_inputs(8), by_inputs(public.dette_8d)),
    "park_a": Function(_inputs(4, 0.01), by_inputs(public.park_1)),
    "park_b": Function(_inputs(4), by_inputs(public.park_2)),
    "franke": Function(_inputs(2), by_inputs(public.franke)),
    "lim": Function(_inputs(2), by_inputs(public.lim)),
    "currin": Function({"x1": (0.0, 1.0), "x2": (0.02, 1.0)}, by_inputs(public.currin)),
    "robot_arm": Function(
        {f"t{k}": (0.0, 1.5) for k in range(4)} | {f"l{k}": (0.0, 1.0) for k in range(4)},
        by_inputs(public.robot_arm),
    ),
    "rosenbrock": Function(_inputs(4, -2.0, 2.0), rosenbrock),
    "gramacy_lee": Function(_inputs(6), by_inputs(public.gramacy_lee_6d)),
    "loeppky": Function(_inputs(7), loeppky),
    "zakharov_log": Function(_inputs(4, -3.0, 3.0), zakharov_log),
    "branin": Function({"x1": (-5.0, 10.0), "x2": (0.0, 15.0)}, by_inputs(public.branin)),
    "steel_column": Function(
        {
            "Fs": (480.0, 520.0),
            "P1": (5e5, 7e5),
            "P2": (4e5, 8e5),
            "P3": (4e5, 8e5),
            "B": (285.0, 315.0),
            "D": (16.0, 24.0),
            "H": (270.0, 330.0),
            "F0": (10.0, 50.0),
            "E": (19e4, 23e4),
        },
        steel_column,
    ),
    "welch_6": Function(
        _inputs(6, -0.5, 0.5),
        lambda a, b, c, d, e, f: 5 * b / (1 + a) + 5 * (d - c) ** 2 + 40 * f**3 - 5 * f + 0.05 * e,
    ),
    "oscillator": Function(
        {"k": (10.0, 40.0), "c": (0.05, 0.6), "m": (0.5, 2.0), "x0": (0.5, 2.0)}, oscillator
    ),
    "sulfur": Function(
        {
            "Tr": (0.5, 0.9),
            "Ac": (0.3, 0.8),
            "Rs": (0.7, 1.0),
            "beta": (0.1, 0.5),
            "psi": (3.0, 7.0),
            "f": (1.2, 2.2),
            "Q": (50.0, 100.0),
            "Y": (0.3, 0.7),
            "L": (3.0, 9.0),
        },
        sulfur,
    ),
}


def medians(curve: Curve) -> tuple[Array, Array, Array] | None:
    """x (k,), medians of log error (k,) and their covariance; None for a curve of rounding."""
    logs = np.log(curve.rmse)
    y = np.nanmedian(logs, axis=0)
    if y.min() < max(y.max() - FALL, LOWEST):
        return None
    n = curve.runs.astype(float)
    return np.log(n / curve.whole), y, covariance_of_medians(n, logs, curve.whole)


def log_evidence_of(one: tuple[Array, Array, Array], mean: Array, sd: Array) -> float:
    """Of a curve, with slope and bend normal, summed over how far it strays from its law."""
    x, y, covariance = one
    X = np.column_stack([np.ones_like(x), x, x**2])
    residual, spread = y - X[:, 1:] @ mean, np.array([WIDE, *sd])
    given = [log_evidence(X, residual, covariance + t**2 * np.eye(len(x)), spread) for t in STRAYS]
    return float(np.logaddexp.reduce(given))


def main() -> None:
    known = []
    for name, function in FUNCTIONS.items():
        for kind in (PolynomialChaos, GaussianProcess):
            with suppress(FitError):
                first, whole, _ = curves(function, kind)
                known += [one for one in map(medians, (first, whole)) if one is not None]
        print(f"{name}: {len(known)} curves so far", flush=True)
    start = np.array([-1.5, -0.1, 0.0, -1.0])

    def lost(at: Array) -> float:
        return -sum(log_evidence_of(one, at[:2], np.exp(at[2:])) for one in known)

    found = minimize(lost, start, method="Nelder-Mead", options={"xatol": 0.01, "fatol": 0.01}).x
    sd = np.exp(found[2:])
    print(f"slope {found[0]:.2f} +- {sd[0]:.2f}, bend {found[1]:.2f} +- {sd[1]:.2f}")


if __name__ == "__main__":
    main()
