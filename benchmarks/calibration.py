"""Calibration: simulation-based calibration (Talts et al. 2018), and coverage of the real function.

    python benchmarks/calibration.py ranks [REPEATS]      the joint law that calibration states
    python benchmarks/calibration.py coverage [REPEATS]   measurements by the function itself

`ranks`. One surrogate of each function is fitted and then stays: what is simulated is the joint law
of all that is unknown given its runs. A truth (free inputs, error of measurement, discrepancy)
is drawn from the prior, measurements from the law that the surrogate predicts for all cases
together (mean and joint covariance of its errors) plus discrepancy plus error. Then the truth is a
draw from the posterior, so that its rank among the last draws of 32 walkers is uniform on 0..32;
chi-square on eight groups, p for each unknown. `without`: the posterior leaves the surrogate's
error out, and the ranks of a coarse surrogate have to pile up at both ends.

`coverage`. Measurements are made by the function itself: there is no law of functions from which
it was drawn, so that coverage of intervals can be asked and no uniform ranks.

Measured with 128 repeats (`ranks`, some 110 s of processor time a line): p of each unknown

    forrester    t free           error 0.05 sd              t 0.322
    forrester    t free           error estimated            t 0.728, error 0.751
    branin       t free           0.05 sd, discrepancy       t 0.666, its sd 0.343, its length 0.181
    branin       t free           0.05 sd, normal prior      t 0.439
    decay        k free           0.05 sd                    k 0.720
    decay        y0, k free       estimated, normal priors   y0 0.219, k 0.681, error 0.414
    decay        y0, k free       0.05 sd, discrepancy       y0 0.010, k 0.670, sd 0.209,
                                                             length 0.238
    ishigami     X2 free          error estimated            X2 0.601, error 0.509
    borehole     L free           0.05 sd                    L 0.406
    borehole     L free           estimated, discrepancy     L 0.304, error 0.351, sd 0.694,
                                                             length 0.509
    piston       S, k free        0.05 sd                    S 0.340, k 0.831
    piston       S, k free        estimated, normal priors   S 0.774, k 0.705, error 0.473
    otl_circuit  Rb2, Rf, Rc1     0.05 sd                    0.639, 0.601, 0.234
    wing_weight  Nz, Wdg free     0.05 sd, discrepancy       0.188, 0.694, sd 0.165, length 0.433
    wing_weight  Sw, A, tc, Wdg   0.05 sd, normal priors     0.120, 0.217, 0.519, 0.473

38 unknowns of 15 problems. The smallest p is 0.010; when all posteriors are right, the smallest of
38 is below that with probability 0.32. Other truths of that problem (seed 1234 in `ranks`) give
0.481, 0.087, 0.816, 0.242. The same without the surrogate's error (40 repeats, error 0.01 sd,
coarse surrogates): forrester 8 runs, t 2e-20; branin 9 runs, t 3e-17; ishigami 12 runs, X2 0.010.
`coverage` has not been measured yet.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy import stats
from threadpoolctl import threadpool_limits

from surrogate.calibration import sampling
from surrogate.calibration.calibrate import likelihood_of, sample
from surrogate.calibration.likelihood import Likelihood
from surrogate.calibration.problem import Measured, Problem
from surrogate.designs.latin_hypercube import latin_hypercube
from surrogate.fitting.fit import Fit, fit
from surrogate.regressors.gaussian_process import GaussianProcess
from surrogate.space.distributions import distribution, uniform
from surrogate.space.space import Parameter, Space
from surrogate_solvers import textbook

GROUPS = 8


@dataclass(frozen=True)
class Trial:
    """A function of the literature with free inputs, cases and an error of measurement.

    free       names of the free inputs; the others are known
    noise      error of measurement as a share of the output's standard deviation; None: estimated
    normal     free inputs have a normal prior (sd a fifth of the range), else the uniform one
    """

    name: str
    function: Callable[..., np.ndarray]
    ranges: dict[str, tuple[float, float]]
    free: tuple[str, ...]
    runs: int
    cases: int = 6
    noise: float | None = 0.05
    discrepancy: bool = False
    normal: bool = False


def _ranges(solver: type, *names: str) -> dict[str, tuple[float, float]]:
    return {name: solver.inputs[name].range for name in names}


def _of(solver: type) -> Callable[..., np.ndarray]:
    """A textbook function of some inputs, the others at their nominal values."""
    nominal = {name: one.nominal for name, one in solver.inputs.items()}

    def function(**at: np.ndarray) -> np.ndarray:
        whole = {**nominal, **at}
        shape = np.broadcast(*at.values()).shape
        found = solver()(**{k: np.broadcast_to(v, shape) for k, v in whole.items()})
        return np.asarray(next(iter(found.values())))

    return function


def forrester(x: np.ndarray, t: np.ndarray) -> np.ndarray:
    """Forrester, Sobester, Keane 2008, with a phase to learn."""
    return (6.0 * x - 2.0) ** 2 * np.sin(12.0 * x - 4.0 * t)


def decay(x: np.ndarray, y0: np.ndarray, k: np.ndarray) -> np.ndarray:
    """Bayarri et al. 2007, section 2: y0 exp(-k x)."""
    return y0 * np.exp(-k * x)


def branin(x: np.ndarray, t: np.ndarray) -> np.ndarray:
    """Branin 1972, the second input to learn."""
    return (t - 5.1 * x**2 / (4 * np.pi**2) + 5 * x / np.pi - 6) ** 2 + 10 * (
        1 - 1 / (8 * np.pi)
    ) * np.cos(x)


def _trials() -> list[Trial]:
    b, p, o, w = textbook.Borehole, textbook.Piston, textbook.OTLCircuit, textbook.WingWeight
    names = {one: list(one.inputs) for one in (b, p, o, w)}
    unit = (0.0, 1.0)
    fx = Trial("forrester", forrester, {"x": unit, "t": unit}, ("t",), 16)
    dx = Trial("decay", decay, {"x": (0.0, 3.0), "y0": (3.0, 7.0), "k": (0.5, 2.5)}, ("k",), 14)
    bx = Trial("branin", branin, {"x": (-5.0, 10.0), "t": (0.0, 15.0)}, ("t",), 20)
    ish = Trial(
        "ishigami", _of(textbook.Ishigami), _ranges(textbook.Ishigami, "X1", "X2"), ("X2",), 25
    )

    def some(solver: type, name: str, free: tuple[int, ...], known: tuple[int, ...], runs: int):
        own = names[solver]
        chosen = [own[j] for j in (*known, *free)]
        return Trial(name, _of(solver), _ranges(solver, *chosen), tuple(own[j] for j in free), runs)

    bore, pist = some(b, "borehole", (6,), (3, 5), 20), some(p, "piston", (1, 3), (2,), 20)
    otl, wing = (
        some(o, "otl_circuit", (1, 2, 3), (0,), 24),
        some(w, "wing_weight", (7, 8), (0,), 24),
    )
    four = some(w, "wing_weight", (0, 2, 6, 8), (7,), 30)
    return [
        fx,
        replace(fx, noise=None),
        replace(bx, discrepancy=True),
        replace(bx, normal=True),
        dx,
        replace(dx, free=("y0", "k"), noise=None, normal=True),
        replace(dx, free=("y0", "k"), discrepancy=True),
        replace(ish, noise=None),
        bore,
        replace(bore, discrepancy=True, noise=None),
        pist,
        replace(pist, noise=None, normal=True),
        otl,
        replace(wing, discrepancy=True),
        replace(four, normal=True),
    ]


def _built(trial: Trial) -> tuple[Problem, Fit]:
    """The problem with empty measurements, and the surrogate."""
    space = Space(
        tuple(Parameter(name, uniform(low, high)) for name, (low, high) in trial.ranges.items())
    )
    coded = latin_hypercube(space, runs=trial.runs, seed=1)
    values = trial.function(**space.decode(coded))
    one = fit(space, coded, values, GaussianProcess(), output="y")
    places = latin_hypercube(space, runs=trial.cases, seed=2)
    at = space.encode(space.decode(places))
    at[:, [space.names.index(name) for name in trial.free]] = 0.0
    priors = {}
    for name in trial.free:
        low, high = trial.ranges[name]
        words = {"mean": 0.5 * (low + high), "std": 0.2 * (high - low), "range": (low, high)}
        priors[name] = distribution("normal", **words) if trial.normal else space[name].law
    error = np.nan if trial.noise is None else trial.noise * values.std()
    measured = Measured("y", "", np.zeros(trial.cases), np.full(trial.cases, error))
    labels = tuple(map(str, range(trial.cases)))
    return Problem(space, priors, at, labels, (measured,), trial.discrepancy), one


def _with_values(problem: Problem, values: np.ndarray, seed: int) -> Problem:
    return replace(problem, measured=(replace(problem.measured[0], values=values),), seed=seed)


def _simulated(likelihood: Likelihood, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """A truth z (unknown,) from the prior, and measurements (case,) by the law stated."""
    z = rng.standard_normal(len(likelihood.coordinates.unknowns))
    law = next(likelihood.laws(z[None]))
    return z, rng.multivariate_normal(law.mean[0], law.covariance[0], method="eigh")


def ranks(trial: Trial, repeats: int, *, emulator_error: bool = True) -> dict[str, np.ndarray]:
    """Ranks (repeat,) of the truth of each unknown."""
    problem, surrogate = _built(trial)
    likelihood, rng = likelihood_of(problem, {"y": surrogate}), np.random.default_rng(7)
    found = []
    for k in range(repeats):
        z, y = _simulated(likelihood, rng)
        asked = replace(_with_values(problem, y, k), emulator_error=emulator_error)
        chains = sample(likelihood_of(asked, {"y": surrogate}), longest=sampling.FIRST)
        found.append((chains.z[:, -1] < z).sum(axis=0))
    names = likelihood.coordinates.names
    return dict(zip(names, np.array(found).T, strict=True))


def uniformity(found: np.ndarray) -> float:
    """p of chi-square on groups of ranks 0..32, expected in proportion to their sizes."""
    groups = np.array_split(np.arange(sampling.WALKERS + 1), GROUPS)
    counts = [np.isin(found, group).sum() for group in groups]
    sizes = np.array([len(group) for group in groups])
    return float(stats.chisquare(counts, len(found) * sizes / sizes.sum()).pvalue)


def _described(trial: Trial) -> str:
    noise = "estimated" if trial.noise is None else f"{trial.noise:g} sd"
    words = f"{trial.name:12} {len(trial.free)} free  {noise:9}"
    return f"{words}  {'discrepancy' if trial.discrepancy else '':11}  {trial.runs} runs"


def print_ranks(repeats: int) -> None:
    """The table of `ranks`."""
    for trial in _coarse():
        found = ranks(trial, repeats, emulator_error=False)
        told = "  ".join(f"{name} {uniformity(one):.1e}" for name, one in found.items())
        print(f"{_described(trial)}  without the surrogate's error, p: {told}", flush=True)
    for trial in _trials():
        start = time.process_time()
        found = ranks(trial, repeats)
        told = "  ".join(f"{name} {uniformity(one):.3f}" for name, one in found.items())
        print(f"{_described(trial)}  p: {told}  ({time.process_time() - start:.0f} s)", flush=True)


def _coarse() -> list[Trial]:
    """Trials with few runs."""
    every = _trials()
    return [
        replace(every[0], runs=8, noise=0.01),
        replace(every[3], runs=9, noise=0.01),
        replace(every[7], runs=12, noise=0.01),
    ]


def print_coverage(repeats: int) -> None:
    """Share of truths inside 50 % and 95 % intervals, with and without the surrogate's error."""
    for trial in [t for t in _trials() if t.noise and not t.discrepancy] + _coarse():
        problem, surrogate = _built(trial)
        for emulator_error in (True, False):
            inside = np.zeros((2, len(trial.free)))
            for k in range(repeats):
                inside += _covered(trial, problem, surrogate, k, emulator_error)
            words = " ".join(
                f"{name} {a:.2f}/{b:.2f}"
                for name, a, b in zip(trial.free, *(inside / repeats), strict=True)
            )
            how = "with   " if emulator_error else "without"
            print(f"{_described(trial)}  {how}  50 %/95 %: {words}", flush=True)


def _covered(
    trial: Trial, problem: Problem, surrogate: Fit, seed: int, emulator_error: bool
) -> np.ndarray:
    likelihood, rng = likelihood_of(problem, {"y": surrogate}), np.random.default_rng(seed)
    z = rng.standard_normal((1, len(likelihood.coordinates.unknowns)))
    points = likelihood.coordinates.points(likelihood.coordinates.values(z))[0]
    truth = trial.function(**problem.space.decode(points))
    y = truth + problem.measured[0].errors * rng.standard_normal(len(truth))
    asked = replace(_with_values(problem, y, seed), emulator_error=emulator_error)
    drawn = sample(likelihood_of(asked, {"y": surrogate}), longest=sampling.FIRST).z
    ends = np.quantile(drawn.reshape(-1, drawn.shape[2]), (0.25, 0.75, 0.025, 0.975), axis=0)
    return np.array([(ends[0] <= z[0]) & (z[0] <= ends[1]), (ends[2] <= z[0]) & (z[0] <= ends[3])])


if __name__ == "__main__":
    what, repeats = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 128
    with threadpool_limits(1):  # small systems: threads would take ten times as long
        {"ranks": print_ranks, "coverage": print_coverage}[what](repeats)
