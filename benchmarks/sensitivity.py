"""Sobol' indices: error, coverage and time beside SALib's, and which estimator is best.

    python benchmarks/sensitivity.py salib        ours beside SALib, equal evaluations
    python benchmarks/sensitivity.py estimators   estimators on the same function values
    python benchmarks/sensitivity.py surrogate    coverage of the surrogate's part

Errors are root mean squares over indices and seeds against the exact values of
tests/reference/sobol_indices.json; coverage is the share of 95 % intervals that hold them.
"""

from __future__ import annotations

import argparse
import json
import time
from pathlib import Path

import numpy as np
from SALib.analyze import sobol as salib_analysis
from SALib.sample import sobol as salib_sample
from sklearn.ensemble import RandomForestRegressor

from surrogate.fitting.fit import fit
from surrogate.regressors.gaussian_process import GaussianProcess
from surrogate.regressors.polynomial import Interactions, Linear, Quadratic
from surrogate.sensitivity.draws import Measure, spread
from surrogate.sensitivity.model import model
from surrogate.sensitivity.pick_freeze import pick_freeze, product_moments
from surrogate.sensitivity.unit_cube import global_seed, problem
from surrogate.space.distributions import uniform
from surrogate.space.space import Parameter, Space
from surrogate_solvers.textbook import Borehole, Ishigami, Piston, SobolG

REFERENCE = Path(__file__).parents[1] / "tests" / "reference" / "sobol_indices.json"
SOLVERS = {"ishigami": Ishigami(), "sobol_g": SobolG(), "borehole": Borehole(), "piston": Piston()}
NAMES = ("first_order", "total", "second_order")


def cases():
    """name, space, function of coded points, exact indices (S, T, upper triangle of S2)."""
    facts = json.loads(REFERENCE.read_text(encoding="utf-8"))["sobol_indices"]
    for name, solver in SOLVERS.items():
        space = Space(
            tuple(Parameter(key, uniform(*given.range)) for key, given in solver.inputs.items())
        )
        exact = [
            np.array(list(part.values()) if isinstance(part, dict) else part)
            for part in (facts[name][index] for index in NAMES)
        ]
        yield name, space, as_function(solver, space), exact


def as_function(solver, space):
    """The solver's first output at coded points."""
    output = next(iter(solver.outputs))
    return lambda coded: solver(**space.decode(coded))[output]


def upper(matrix: np.ndarray) -> np.ndarray:
    """Entries above the diagonal."""
    return matrix[np.triu_indices(len(matrix), 1)]


def ours(function, space, pairs, seed):
    """Indices and half-widths by `pick_freeze`."""
    found = pick_freeze(function, space, samples=pairs, seed=seed)
    values = (found.first_order, found.total, upper(found.second_order))
    return values, (
        found.half["first_order"],
        found.half["total"],
        upper(found.half["second_order"]),
    )


def salib(function, space, pairs, seed):
    """Indices and half-widths by SALib: Saltelli 2010 and Jansen, bootstrap of 100."""
    cube = problem(space)
    u = salib_sample.sample(cube, pairs, calc_second_order=True, seed=seed)
    values = function(space.quantile(u))
    with global_seed(seed):
        found = salib_analysis.analyze(cube, values, calc_second_order=True, seed=seed)
    return (
        (found["S1"], found["ST"], upper(found["S2"])),
        (found["S1_conf"], found["ST_conf"], upper(found["S2_conf"])),
    )


def compare_salib(seeds: int) -> None:
    """Errors, coverage and time of both at the same number of evaluations."""
    print(
        f"{'function':10} {'evaluations':>11} {'program':8} {'rms S':>9} {'rms T':>9} "
        f"{'rms S2':>9} {'cover S':>8} {'cover T':>8} {'cover S2':>9} {'seconds':>8}"
    )
    for name, space, function, exact in cases():
        for pairs in (2**10, 2**14):
            for program, method in (("ours", ours), ("SALib", salib)):
                start = time.perf_counter()
                results = [method(function, space, pairs, seed) for seed in range(seeds)]
                seconds = (time.perf_counter() - start) / seeds
                errors = [
                    np.array([values[k] - exact[k] for values, _ in results]) for k in range(3)
                ]
                halves = [np.array([half[k] for _, half in results]) for k in range(3)]
                rms = [np.sqrt((error**2).mean()) for error in errors]
                cover = [(np.abs(e) <= h).mean() for e, h in zip(errors, halves, strict=True)]
                print(
                    f"{name:10} {pairs * (2 * space.size + 2):11d} {program:8} "
                    + " ".join(f"{value:9.2e}" for value in rms)
                    + " ".join(f"{value:9.3f}" for value in cover)
                    + f" {seconds:8.3f}"
                )


def estimates(M: np.ndarray, mean: float) -> dict[str, np.ndarray]:
    """First-order and total indices by the known estimators from product moments (k, k)."""
    d = len(M) // 2 - 1
    a, b, ai, bi = 0, 1, np.arange(2, 2 + d), np.arange(2 + d, 2 + 2 * d)
    M = M - mean**2
    square = np.diag(M)
    variance = square.mean()
    far = square[:, None] + square[None, :] - 2.0 * M
    pair = 0.5 * (M[a, bi] + M[b, ai])
    own = 0.25 * (square[a] + square[b] + square[ai] + square[bi])
    four = far[a, b] + far[ai, bi]
    return {
        "S Janon 2014": pair / own,
        "S Saltelli 2010": (pair - M[a, b]) / variance,
        "S Jansen 1999": 1.0 - 0.25 * (far[a, bi] + far[b, ai]) / variance,
        "S Azzini 2021": 2.0 * (M[a, bi] - M[a, b] - M[ai, bi] + M[ai, b]) / four,
        "T Jansen 1999": 0.25 * (far[a, ai] + far[b, bi]) / variance,
        "T Janon 2014": 1.0 - 0.5 * (M[a, ai] + M[b, bi]) / own,
        "T Azzini 2021": (far[a, ai] + far[b, bi]) / four,
    }


def compare_estimators(seeds: int) -> None:
    """RMS error of each estimator on the same values of one scrambled sequence."""
    for name, space, function, exact in cases():
        for pairs in (2**9, 2**12):
            errors: dict[str, list] = {}
            centre = function(space.sample(64, seed=0)).mean()
            for seed in range(seeds):
                M = product_moments(function, space, samples=pairs, scramblings=1, seed=seed)[0]
                # Moments are less the pilot's mean, so the rest of the mean is small.
                rest = function(space.sample(2**14, seed=1)).mean() - centre
                for key, value in estimates(M, rest).items():
                    errors.setdefault(key, []).append(value - exact[key[0] == "T"])
            print(f"{name}, {pairs} pairs")
            for key, gaps in errors.items():
                rms = np.sqrt(np.mean(np.square(gaps), axis=0))
                print(
                    f"  {key:16} rms {np.sqrt((rms**2).mean()):.2e}  worst index "
                    f"{rms.max():.2e}  smallest index {rms[np.argmin(exact[key[0] == 'T'])]:.2e}"
                )


def compare_surrogate(seeds: int) -> None:
    """How often draws alone, missed variance alone and both cover the solver's S and T."""
    estimators = {
        "linear": Linear(),
        "interactions": Interactions(),
        "quadratic": Quadratic(),
        "gp": GaussianProcess(),
        "forest": RandomForestRegressor(n_estimators=20, random_state=0),
    }
    print(
        f"{'function':10} {'surrogate':13} {'runs':>5} {'q2':>6} {'draws':>7} {'missed':>7} "
        f"{'both':>7} {'worst index':>12}"
    )
    for name, space, function, exact in cases():
        if name not in ("borehole", "piston"):
            continue
        for kind, estimator in estimators.items():
            runs = 75 if kind == "quadratic" else 60
            covered, scores = [], []
            for seed in range(seeds):
                coded = space.sample(runs, seed=seed)
                fitted = fit(space, coded, function(coded), estimator)
                scores.append(fitted.q2)
                covered.append(_covered(fitted, space, exact, seed))
            share = np.mean(covered, axis=0)
            print(
                f"{name:10} {kind:13} {runs:5d} {np.mean(scores):6.3f} "
                + " ".join(f"{value:7.3f}" for value in share.mean(axis=1))
                + f" {share[2].min():12.3f}",
                flush=True,
            )


def _covered(fitted, space, exact, seed) -> np.ndarray:
    """(3, 2 d): whether draws, missed variance and both cover S and T."""
    rows = []
    measure = Measure(space, closed=hasattr(fitted.estimator, "sobol_indices"), seed=seed)
    values = measure.of(fitted.estimator)
    for draws, q2 in ((40, 1.0), (0, None), (40, None)):
        parts = spread(
            model(fitted, space, q2=q2), measure, draws=draws, confidence=0.95, seed=seed
        )
        rows.append(
            np.concatenate(
                [
                    (exact[k] >= values[k] - parts[k].below - 1e-4)
                    & (exact[k] <= values[k] + parts[k].above + 1e-4)
                    for k in range(2)
                ]
            )
        )
    return np.array(rows)


def main() -> None:
    """Run one of the comparisons."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("what", choices=["salib", "estimators", "surrogate"])
    parser.add_argument("--seeds", type=int, default=20)
    arguments = parser.parse_args()
    {"salib": compare_salib, "estimators": compare_estimators, "surrogate": compare_surrogate}[
        arguments.what
    ](arguments.seeds)


if __name__ == "__main__":
    main()
