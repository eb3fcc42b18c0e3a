"""Convergence and smoothness of the bandage model: `python benchmarks/verification_contact.py`.

V12  pressure at B1 on coarse, medium and fine: observed order, Richardson's estimate
V13  sweeps of one input: scatter of the pressure about a smooth curve (a polynomial of
     degree 5 in the input), largest and root mean square
"""

from __future__ import annotations

import argparse

import numpy as np
from scipy.optimize import brentq

from solvers.leg_bandage.model import MESHES
from solvers.leg_bandage.plugin import INPUTS, LegBandage
from surrogate.errors import SolverError

SWEEPS = {"tension": (0.059, 0.137), "leg_length": (190.0, 285.0), "alpha1": (-0.88, -0.53),
          "alpha2": (-0.06, 0.11), "alpha3": (-0.08, 0.09), "alpha4": (-0.03, 0.033),
          "overlap": (0.4, 0.6), "mu_skin": (0.1, 0.3)}
DEGREE = 5


def convergence() -> None:
    """Print V12: element size is the laid row length."""
    sizes = [MESHES[name].row for name in MESHES]
    values = [LegBandage(mesh=name)()["pressure_b1"] for name in MESHES]
    for name, size, value in zip(MESHES, sizes, values, strict=True):
        print(f"V12 {name}: h = {size} mm, pressure_b1 = {value:.3f} mmHg")
    order, limit = richardson(sizes, values)
    print(f"V12 observed order {order:.2f}, limit {limit:.3f} mmHg, "
          f"medium off by {100 * (values[1] / limit - 1):.2f} %")


def richardson(sizes, values) -> tuple[float, float]:
    """Order p and limit f of f + C h^p through three values; NaN when they do not converge."""
    (h1, h2, h3), (f1, f2, f3) = sizes, values
    ratio = (f1 - f2) / (f2 - f3)

    def miss(p):
        return (h1**p - h2**p) / (h2**p - h3**p) - ratio

    if miss(0.05) * miss(8.0) > 0:
        return np.nan, np.nan
    order = brentq(miss, 0.05, 8.0)
    return order, f3 + (f3 - f2) / ((h2 / h3) ** order - 1)


def smoothness(name: str, mesh: str, points: int) -> None:
    """Print V13 for one input."""
    solver, at = LegBandage(mesh=mesh), np.linspace(*SWEEPS[name], points)
    pressure = np.full(points, np.nan)
    for i, value in enumerate(at):
        try:
            pressure[i] = solver(**{name: value})["pressure_b1"]
        except SolverError as error:
            print(f"V13 {name} = {value:.4g}: {error}")
    good = np.isfinite(pressure)
    fit = np.polynomial.Polynomial.fit(at[good], pressure[good], DEGREE)
    off = pressure[good] - fit(at[good])
    print(f"V13 {name} on {mesh}, {good.sum()} of {points} points {at[0]:g}..{at[-1]:g} "
          f"{INPUTS[name].unit}: pressure_b1 {pressure[good].min():.2f}..{pressure[good].max():.2f}"
          f" mmHg, scatter {np.sqrt(np.mean(off**2)):.3f} rms, {np.abs(off).max():.3f} largest",
          flush=True)


def main() -> None:
    """Run what the command line asks for."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sweeps", nargs="*", default=list(SWEEPS), choices=SWEEPS)
    parser.add_argument("--mesh", default="medium")
    parser.add_argument("--points", type=int, default=41)
    parser.add_argument("--no-convergence", action="store_true")
    given = parser.parse_args()
    if not given.no_convergence:
        convergence()
    for name in given.sweeps:
        smoothness(name, given.mesh, given.points)


if __name__ == "__main__":
    main()
