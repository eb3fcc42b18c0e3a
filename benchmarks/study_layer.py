"""Time and accuracy of the study layer beside six public packages, in one run.

    pip install smt chaospy statsmodels openturns
    OMP_NUM_THREADS=1 python benchmarks/study_layer.py [--seeds 5] [--only designs ...]

Each row is a task that an analyst has, done by this package and by every package that does
it: scikit-learn, SALib, OpenTURNS, SMT, chaospy, statsmodels. A package that is not installed
is left out. Seconds are processor time on one thread, the median over seeds; the error is the
median over the same seeds. Ratios are theirs over ours: above 1, ours is quicker or more
accurate. Functions: borehole (8 inputs), piston (7), Ishigami (3); training runs are Latin
hypercubes, the same for all packages; errors are taken at 4 096 points of a Sobol' sequence.
About six minutes.

How the others are set is told in `peers`. Sobol' indices of ours come with intervals from eight
scramblings of a shorter sequence, those of SALib and OpenTURNS with a bootstrap of one long
sequence, which is more accurate.
"""

from __future__ import annotations

import argparse
import json
import time
import warnings
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from peers import OURS, Fitting, expansions, only_installed, processes, sample
from scipy.spatial.distance import pdist
from scipy.stats import qmc

from surrogate.designs.latin_hypercube import latin_hypercube
from surrogate.regressors.polynomial import Quadratic
from surrogate.sensitivity.pick_freeze import pick_freeze
from surrogate.space.distributions import uniform
from surrogate.space.space import Parameter, Space
from surrogate_solvers.textbook import Borehole, Ishigami, Piston

EXACT = Path(__file__).parents[1] / "tests" / "reference" / "sobol_indices.json"
Answer = Callable[[int], tuple[float, float]]  # seed -> seconds, error


@dataclass(frozen=True)
class Task:
    """What is done, how its error is measured, and by whom."""

    name: str
    error: str
    programs: dict[str, Answer]


# ---- what all tasks share --------------------------------------------------------------


def space_of(solver) -> Space:
    return Space(
        tuple(Parameter(name, uniform(*given.range)) for name, given in solver.inputs.items())
    )


def function_of(solver) -> Callable[[np.ndarray], np.ndarray]:
    """The solver's output at coded points (m, d)."""
    space, output = space_of(solver), next(iter(solver.outputs))
    return lambda coded: np.asarray(solver(**space.decode(coded))[output])


def hypercube(size: int, runs: int, seed: int) -> np.ndarray:
    return 2.0 * qmc.LatinHypercube(size, seed=seed).random(runs) - 1.0


def clocked(work: Callable[[], object]) -> tuple[object, float]:
    start = time.process_time()
    result = work()
    return result, time.process_time() - start


def exact_indices(name: str) -> np.ndarray:
    """First-order and total indices (2 d,)."""
    facts = json.loads(EXACT.read_text(encoding="utf-8"))["sobol_indices"][name]
    return np.array(
        [
            value
            for part in (facts["first_order"], facts["total"])
            for value in (part.values() if isinstance(part, dict) else part)
        ]
    )


# ---- designs -----------------------------------------------------------------------------


def designs(runs: int, size: int) -> Task:
    """A maximin Latin hypercube; the error is one over the smallest distance."""
    cube = Space(tuple(Parameter(f"x{i}", uniform(0.0, 1.0)) for i in range(size)))

    def judged(make: Callable[[int], np.ndarray]) -> Answer:
        def answer(seed: int) -> tuple[float, float]:
            points, seconds = clocked(lambda: make(seed))
            return seconds, 1.0 / pdist(np.asarray(points)).min()

        return answer

    def ours(seed: int) -> np.ndarray:
        return (latin_hypercube(cube, runs=runs, seed=seed) + 1.0) / 2.0

    def smt(seed: int) -> np.ndarray:
        from smt.sampling_methods import LHS

        limits = np.tile([0.0, 1.0], (size, 1))
        return LHS(xlimits=limits, criterion="ese", seed=seed)(runs)

    def openturns(seed: int) -> np.ndarray:
        import openturns as ot

        ot.RandomGenerator.SetSeed(seed)
        plain = ot.LHSExperiment(ot.JointDistribution([ot.Uniform(0.0, 1.0)] * size), runs)
        plain.setAlwaysShuffle(True)
        cooling = ot.GeometricProfile(10.0, 0.95, 2000)
        return np.array(
            ot.SimulatedAnnealingLHS(plain, ot.SpaceFillingPhiP(50), cooling).generate()
        )

    makers = only_installed({OURS: ours, "SMT": smt, "OpenTURNS": openturns})
    return Task(
        f"maximin Latin hypercube, {runs} x {size}",
        "1 / distance",
        {program: judged(make) for program, make in makers.items()},
    )


# ---- surrogates --------------------------------------------------------------------------


def fitted(solver, runs: int, fits: dict[str, Fitting], name: str) -> Task:
    """Fit and predict; the error is the RMSE over the standard deviation of the output."""
    function = function_of(solver)
    size = len(solver.inputs)
    test = 2.0 * qmc.Sobol(size, seed=9).random(4096) - 1.0
    truth = function(test)

    def judged(fit: Fitting) -> Answer:
        def answer(seed: int) -> tuple[float, float]:
            coded = hypercube(size, runs, seed)
            values = function(coded)
            found, seconds = clocked(lambda: fit(coded, values))
            return seconds, relative_error(found.predict(test), truth)

        return answer

    title = f"{name}, {type(solver).__name__.lower()}, {runs} runs"
    return Task(title, "RMSE / sd", {key: judged(fit) for key, fit in fits.items()})


def relative_error(found: np.ndarray, truth: np.ndarray) -> float:
    return float(np.sqrt(np.mean((np.ravel(found) - truth) ** 2)) / truth.std())


def predictions(runs: int, points: int) -> Task:
    """Mean and deviation at many points, of the processes that each package fitted."""
    function, size = function_of(Borehole()), 8
    many = hypercube(size, points, seed=2)
    truth = function(many)

    def judged(fit: Fitting) -> Answer:
        def answer(seed: int) -> tuple[float, float]:
            coded = hypercube(size, runs, seed)
            found = fit(coded, function(coded))
            (mean, _), seconds = clocked(lambda: found.spread(many))
            return seconds, relative_error(mean, truth)

        return answer

    return Task(
        f"{points} means and deviations, {runs} runs",
        "RMSE / sd",
        {name: judged(fit) for name, fit in processes(size).items() if name != "OpenTURNS"},
    )


# ---- sensitivity -------------------------------------------------------------------------


def sampled(name: str, solver, pairs: int) -> Task:
    """Sobol' indices of a function, with intervals, at equal numbers of evaluations."""
    space, function = space_of(solver), function_of(solver)
    truth = exact_indices(name)

    def judged(find: Callable[[int], list[np.ndarray]]) -> Answer:
        def answer(seed: int) -> tuple[float, float]:
            found, seconds = clocked(lambda: find(seed))
            return seconds, rms(found, truth)

        return answer

    def ours(seed: int) -> list[np.ndarray]:
        result = pick_freeze(function, space, samples=pairs, seed=seed)
        return [result.first_order, result.total]

    def salib(seed: int) -> list[np.ndarray]:
        from SALib.analyze import sobol as analyse
        from SALib.sample import sobol as sampling

        cube = {
            "num_vars": space.size,
            "names": [f"x{i}" for i in range(space.size)],
            "bounds": [[-1.0, 1.0]] * space.size,
        }
        points = sampling.sample(cube, pairs, calc_second_order=True, seed=seed)
        found = analyse.analyze(cube, function(points), calc_second_order=True, seed=seed)
        return [found["S1"], found["ST"]]

    def openturns(seed: int) -> list[np.ndarray]:
        import openturns as ot

        ot.RandomGenerator.SetSeed(seed)
        law = ot.JointDistribution([ot.Uniform(-1.0, 1.0)] * space.size)
        inputs = ot.SobolIndicesExperiment(law, pairs, True).generate()
        outputs = sample(function(np.array(inputs)))
        found = ot.SaltelliSensitivityAlgorithm(inputs, outputs, pairs)
        for interval in (found.getFirstOrderIndicesInterval, found.getTotalOrderIndicesInterval):
            interval()
        return [np.array(found.getFirstOrderIndices()), np.array(found.getTotalOrderIndices())]

    finders = only_installed({OURS: ours, "SALib": salib, "OpenTURNS": openturns})
    return Task(
        f"Sobol' indices of {name}, {pairs} pairs",
        "RMS error",
        {program: judged(find) for program, find in finders.items()},
    )


def rms(found: Sequence[np.ndarray], truth: np.ndarray) -> float:
    return float(np.sqrt(np.mean((np.concatenate(found) - truth) ** 2)))


def from_runs(name: str, solver, runs: int) -> Task:
    """Fit a chaos expansion to a few runs and read Sobol' indices off it."""
    space, function = space_of(solver), function_of(solver)
    truth = exact_indices(name)

    def judged(fit: Fitting) -> Answer:
        def answer(seed: int) -> tuple[float, float]:
            coded = hypercube(space.size, runs, seed)
            values = function(coded)
            found, seconds = clocked(lambda: fit(coded, values).indices())
            return seconds, rms(found, truth)

        return answer

    return Task(
        f"Sobol' indices of {name} from {runs} runs by chaos",
        "RMS error",
        {key: judged(fit) for key, fit in expansions(space.size).items()},
    )


# ---- regression --------------------------------------------------------------------------


def table(runs: int) -> Task:
    """Coefficients, errors, p-values and influence of a quadratic in seven inputs."""
    space, function = space_of(Piston()), function_of(Piston())

    def ours(seed: int) -> tuple[float, float]:
        coded = hypercube(space.size, runs, seed)
        model = Quadratic(space).fit(coded, function(coded))
        _, seconds = clocked(model.regression_table)
        return seconds, 1.0

    def statsmodels(seed: int) -> tuple[float, float]:
        import statsmodels.api as sm

        coded = hypercube(space.size, runs, seed)
        model = Quadratic(space).fit(coded, function(coded))
        own = model.regression_table()

        def work():
            found = sm.OLS(model.model_.y, model.model_.matrix).fit()
            return found, found.bse, found.pvalues, found.get_influence().resid_studentized_external

        (found, errors, _, _), seconds = clocked(work)
        gap = np.max(np.abs(own["standard_error"].values / errors - 1.0))
        return seconds, 1.0 + gap

    programs = only_installed({OURS: ours, "statsmodels": statsmodels})
    return Task(f"regression table of a quadratic, {runs} runs", "1 + gap to ours", programs)


# ---- printing ----------------------------------------------------------------------------


def tasks() -> dict[str, Callable[[], Iterator[Task]]]:
    def surrogates() -> Iterator[Task]:
        for solver, runs in ((Borehole(), 50), (Borehole(), 200), (Piston(), 100)):
            yield fitted(solver, runs, processes(len(solver.inputs)), "Gaussian process")
        for solver, runs in ((Ishigami(), 100), (Borehole(), 100), (Piston(), 200)):
            yield fitted(solver, runs, expansions(len(solver.inputs)), "polynomial chaos")
        yield predictions(300, 20_000)

    def sensitivity() -> Iterator[Task]:
        for name, solver in (("ishigami", Ishigami()), ("borehole", Borehole())):
            yield sampled(name, solver, 2**12)
        for name, solver, runs in (("ishigami", Ishigami(), 200), ("borehole", Borehole(), 100)):
            yield from_runs(name, solver, runs)

    return {
        "designs": lambda: iter([designs(50, 5), designs(100, 7)]),
        "surrogates": surrogates,
        "sensitivity": sensitivity,
        "regression": lambda: iter([table(200), table(500)]),
    }


def show(task: Task, seeds: int) -> None:
    """One line a program: seconds and error, and both over ours."""
    answers = {
        program: np.median([answer(seed) for seed in range(seeds)], axis=0)
        for program, answer in task.programs.items()
    }
    own = answers[OURS]
    for program, (seconds, error) in answers.items():
        ratios = (seconds / own[0], error / own[1])
        print(
            f"| {task.name} | {program} | {seconds:.3f} | {ratios[0]:.2f} "
            f"| {task.error} {error:.2e} | {ratios[1]:.2f} |",
            flush=True,
        )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--only", nargs="+", choices=list(tasks()), default=list(tasks()))
    given = parser.parse_args()
    warnings.simplefilter("ignore")  # the packages warn of lengths at their bounds
    print("| task | program | seconds | time / ours | error | error / ours |")
    print("|---|---|---|---|---|---|")
    for part in given.only:
        for task in tasks()[part]():
            show(task, given.seeds)


if __name__ == "__main__":
    main()
