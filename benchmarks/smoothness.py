"""Smoothness of the bandage model in each input (check V13).

    python benchmarks/smoothness.py [--mesh medium] [--steps 41] [--inputs tension overlap]
                                    [--workers 2] [--csv runs.csv]

Each input is swept over its range with the others at their nominal values. Scatter is what is
left of `pressure_b1` about a polynomial in the input, of the degree up to 8 that predicts left
out points best. Steps of the mesh over the leg, contact that opens, and a Newton method that
stops would show in it; a smooth answer leaves what a polynomial cannot follow.
Ranges: Table II of Chassagne et al. 2018, the alphas' and lengths those of the shipped
legs; wrapping by choice.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np

from surrogate_solvers.leg_bandage.parameters import INPUTS
from surrogate_solvers.leg_bandage.verification.legs import shape_ranges
from surrogate_solvers.leg_bandage.verification.sweeps import Case, key_of, solve_all

RANGES = {
    "tension": (0.059, 0.137),
    **shape_ranges(),
    "overlap": (0.4, 0.6),
    "mu_skin": (0.1, 0.3),
    "stretch": (1.2, 1.4),
    "start_height": (-20.0, 10.0),
}
DEGREES = range(1, 9)


def smooth(x: np.ndarray, y: np.ndarray) -> tuple[int, np.ndarray]:
    """Degree and fitted values of the polynomial with the least leave-one-out error.

    The error of point i when it is left out is its residual over 1 - H_ii (Allen 1974).
    """
    best = None
    for degree in DEGREES:
        if degree > len(x) - 3:
            break
        at = 2 * (x - x[0]) / (x[-1] - x[0]) - 1
        q, _ = np.linalg.qr(np.polynomial.chebyshev.chebvander(at, degree))
        fitted = q @ (q.T @ y)
        press = np.sum(((y - fitted) / (1 - np.sum(q**2, axis=1))) ** 2)
        if best is None or press < best[0]:
            best = press, degree, fitted
    return best[1], best[2]


def sweep(name: str, given: argparse.Namespace) -> None:
    """Print one input's line, and the sentence of every run that failed."""
    at = np.linspace(*RANGES[name], given.steps)
    cases = [Case(name, {name: float(value)}) for value in at]
    found = {}
    for row in solve_all(cases, given.mesh, given.workers, given.csv):
        if row["message"]:
            print(f"{name}, {row['inputs']}: {row['message']}", flush=True)
        else:
            found[row["inputs"]] = row["pressure_b1"]
    y = np.array([found.get(key_of(given.mesh, case)["inputs"], np.nan) for case in cases])
    good = np.isfinite(y)
    head = f"{name:12s} {at[0]:8.4g} .. {at[-1]:<8.4g} {INPUTS[name].unit:5s}"
    if good.sum() < 4:
        print(f"{head} {good.sum()} of {given.steps} converged: too few")
        return
    degree, fitted = smooth(at[good], y[good])
    off = y[good] - fitted
    # freedoms that the polynomial took are given back
    rms = np.sqrt(np.sum(off**2) / (good.sum() - degree - 1))
    print(
        f"{head} {good.sum():3d} of {given.steps} converged, {y[good].min():6.2f} .. "
        f"{y[good].max():6.2f} mmHg, degree {degree}, scatter {rms:.4f} rms, "
        f"{np.abs(off).max():.4f} largest, at {at[good][np.abs(off).argmax()]:.4g}",
        flush=True,
    )


def main() -> None:
    """Sweep the inputs that are asked for."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--mesh", default="medium", help="coarse, medium, fine or a number")
    parser.add_argument("--steps", type=int, default=41)
    parser.add_argument("--inputs", nargs="+", default=list(RANGES), choices=RANGES)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--csv", type=Path, help="keep runs here; those it holds are not repeated")
    given = parser.parse_args()
    for name in given.inputs:
        sweep(name, given)


if __name__ == "__main__":
    main()
