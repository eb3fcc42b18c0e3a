"""Surrogates: accuracy and time beside scikit-learn's, and the regression table's time.

    python benchmarks/surrogates.py accuracy     RMSE and seconds of every surrogate
    python benchmarks/surrogates.py small        Gaussian process on 10 to 40 runs: Q2, coverage
    python benchmarks/surrogates.py regression   table beside statsmodels (if it is installed)
    python benchmarks/surrogates.py predict      100 000 predictions of a Gaussian process
    python benchmarks/surrogates.py many         polynomials of 100 000 runs, with cross-validation
    python benchmarks/surrogates.py large        Gaussian process on 1000 to 50 000 runs
    python benchmarks/surrogates.py bounds       Gaussian process: lengths up to 1000, or to 50
    python benchmarks/surrogates.py truncation   polynomial chaos: truncation chosen, or 0.75

Measured in processor time on one thread, ours and scikit-learn's in the same run:

    100 000 predictions in 8 inputs                 ours   scikit-learn
    mean, 1000 runs                                1.5 s         11.4 s
    mean and deviation, 300 runs                   1.0 s          1.3 s

    fit, ten folds and table of 100 000 runs in 7 inputs: linear 0.6 s, quadratic 0.9 s,
    polynomial chaos 6.3 s; 850 MB

Training runs are Latin hypercubes, test runs a Sobol' sequence of 4096 points. Times are
of one fit and of 100 000 predictions of the mean. Set OMP_NUM_THREADS=1 for comparable
figures.
"""

from __future__ import annotations

import argparse
import resource
import time
import warnings

import numpy as np
from public_functions import FUNCTIONS
from scipy import stats
from scipy.stats import qmc
from sklearn.base import clone
from sklearn.ensemble import RandomForestRegressor
from sklearn.exceptions import ConvergenceWarning
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import ConstantKernel, Matern, WhiteKernel

from surrogate.fitting.fit import fit, q2
from surrogate.regressors.chaos import PolynomialChaos
from surrogate.regressors.gaussian_process import GaussianProcess
from surrogate.regressors.likelihood import LengthPrior
from surrogate.regressors.polynomial import Linear, Quadratic
from surrogate.space.distributions import uniform
from surrogate.space.space import Parameter, Space
from surrogate_solvers.textbook import Borehole, Ishigami, OTLCircuit, Piston

SOLVERS = {"piston (7 inputs)": Piston(), "borehole (8 inputs)": Borehole()}
SMALL = SOLVERS | {"otl circuit (6 inputs)": OTLCircuit(), "ishigami (3 inputs)": Ishigami()}


def space_of(solver) -> Space:
    return Space(
        tuple(Parameter(name, uniform(*given.range)) for name, given in solver.inputs.items())
    )


def evaluate(solver, space, coded):
    (values,) = solver(**space.decode(coded)).values()
    return np.asarray(values)


def cube(size: int, runs: int, seed: int) -> np.ndarray:
    return 2.0 * qmc.LatinHypercube(size, seed=seed).random(runs) - 1.0


def scikit_learn_process(size: int) -> GaussianProcessRegressor:
    kernel = ConstantKernel(1.0, (1e-3, 1e6)) * Matern(
        np.full(size, 2.0), (0.05, 50.0), nu=2.5
    ) + WhiteKernel(1e-4, (1e-10, 1.0))
    return GaussianProcessRegressor(
        kernel, normalize_y=True, n_restarts_optimizer=2, random_state=0
    )


def surrogates(space: Space) -> dict:
    return {
        "linear": Linear(space),
        "quadratic": Quadratic(space),
        "polynomial chaos": PolynomialChaos(space=space),
        "gaussian process": GaussianProcess(space=space),
        "scikit-learn process": scikit_learn_process(space.size),
        "scikit-learn forest": RandomForestRegressor(300, random_state=0),
    }


def timed(function, *arguments):
    start = time.perf_counter()
    result = function(*arguments)
    return result, time.perf_counter() - start


def accuracy(sizes: tuple[int, ...]) -> None:
    print(f"{'':38} {'RMSE/sd':>9} {'fit s':>8} {'predict s':>9} {'indices s':>9}")
    for title, solver in SOLVERS.items():
        space = space_of(solver)
        test = 2.0 * qmc.Sobol(space.size, seed=9).random(4096) - 1.0
        truth, many = evaluate(solver, space, test), np.tile(test, (25, 1))[:100_000]
        for runs in sizes:
            print(f"{title}, {runs} runs")
            coded = cube(space.size, runs, seed=1)
            values = evaluate(solver, space, coded)
            for name, estimator in surrogates(space).items():
                if name == "quadratic" and runs < estimator.minimum_runs(space):
                    continue
                fitted, fit_seconds = timed(estimator.fit, coded, values)
                _, predict_seconds = timed(fitted.predict, many)
                error = np.sqrt(np.mean((truth - fitted.predict(test)) ** 2)) / truth.std()
                indices = (
                    f"{timed(fitted.sobol_indices)[1]:9.3f}"
                    if hasattr(fitted, "sobol_indices")
                    else f"{'-':>9}"
                )
                print(
                    f"  {name:36} {error:9.2e} {fit_seconds:8.3f} {predict_seconds:9.3f} {indices}"
                )


def small(seeds: int) -> None:
    """Ours beside scikit-learn's where runs are few: median Q2, mean coverage of 95 %."""
    for title, solver in SMALL.items():
        space = space_of(solver)
        test = 2.0 * qmc.Sobol(space.size, seed=9).random(1024) - 1.0
        truth = evaluate(solver, space, test)
        for runs in (10, 20, 40):
            scores = {}
            for seed in range(seeds):
                coded = cube(space.size, runs, seed)
                values = evaluate(solver, space, coded)
                for name in ("gaussian process", "scikit-learn process"):
                    fitted = surrogates(space)[name].fit(coded, values)
                    mean, std = fitted.predict(test, return_std=True)
                    wide = (
                        stats.t.ppf(0.975, fitted.interval_freedom)
                        if name == "gaussian process"
                        else 1.96
                    )
                    scores.setdefault(name, []).append(
                        (q2(truth, mean), np.mean(np.abs(truth - mean) <= wide * std))
                    )
            line = "   ".join(
                f"{name}: Q2 {np.median(pairs, axis=0)[0]:.3f}, coverage "
                f"{np.mean(pairs, axis=0)[1]:.2f}"
                for name, pairs in scores.items()
            )
            print(f"{title}, {runs} runs   {line}")


def regression() -> None:
    try:
        import statsmodels.api as sm
    except ImportError:
        sm = None
    solver = Piston()
    space = space_of(solver)
    for runs in (50, 200, 500):
        coded = cube(space.size, runs, seed=1)
        fitted = Quadratic(space).fit(coded, evaluate(solver, space, coded))
        fitted.regression_table()  # the first call pays for imports
        table, seconds = timed(fitted.regression_table)
        print(f"quadratic in 7 inputs, {runs} runs: table {seconds * 1e3:.1f} ms", end="")
        if sm is None:
            print("; statsmodels is not installed")
            continue
        theirs, their_seconds = timed(_statsmodels, sm, fitted.model_)
        worst = max(
            np.max(np.abs(table[name].values - value) / np.maximum(np.abs(value), 1e-300))
            for name, value in theirs.items()
        )
        print(
            f", statsmodels {their_seconds * 1e3:.1f} ms; largest relative difference {worst:.1e}"
        )


def _statsmodels(sm, model) -> dict[str, np.ndarray]:
    result = sm.OLS(model.y, model.matrix).fit()
    influence = result.get_influence()
    return {
        "coefficient": result.params,
        "standard_error": result.bse,
        "p": result.pvalues,
        "cooks_distance": influence.cooks_distance[0],
        "studentised_external": influence.resid_studentized_external,
        "press": np.sum(influence.resid_press**2),
        "f": result.fvalue,
    }


def predict() -> None:
    """Processor time of 100 000 predictions; scikit-learn at its first lengths."""
    solver = SOLVERS["borehole (8 inputs)"]
    space, size = space_of(solver), 8
    points = cube(size, 100_000, seed=2)
    for runs, deviation in ((1000, False), (300, True)):
        coded = cube(size, runs, seed=1)
        values = evaluate(solver, space, coded)
        kernel = scikit_learn_process(size).kernel
        theirs = GaussianProcessRegressor(kernel, optimizer=None, normalize_y=True)
        own = GaussianProcess(space=space, starts=1)
        seconds = []
        for process in (own.fit(coded, values), theirs.fit(coded, values)):
            start = time.process_time()
            process.predict(points, return_std=deviation)
            seconds.append(time.process_time() - start)
        what = "mean and deviation" if deviation else "mean"
        print(f"{what}, {runs} runs: {seconds[0]:.2f} s, scikit-learn {seconds[1]:.2f} s")


def many() -> None:
    """Processor time and memory of fit, ten folds and table of 100 000 runs in 7 inputs."""
    solver = SOLVERS["piston (7 inputs)"]
    space = space_of(solver)
    coded = cube(space.size, 100_000, seed=1)
    values = evaluate(solver, space, coded)
    for model in (Linear(), Quadratic(), PolynomialChaos()):
        start = time.process_time()
        found = fit(space, coded, values, model)
        if hasattr(found.estimator, "regression_table"):
            found.estimator.regression_table()
        seconds = time.process_time() - start
        peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3
        print(f"{type(model).__name__}: {seconds:.2f} s, Q2 {found.q2:.4f}, at most {peak:.0f} MB")


def truncation(sizes: tuple[int, ...]) -> None:
    """Error of chaos with its truncation chosen over that with 0.75."""
    for runs in sizes:
        print_ratios(
            f"{runs} runs: error of the chosen truncation over that of 0.75",
            *(errors_of(PolynomialChaos(hyperbolic=q), runs) for q in (None, 0.75)),
        )


class Shorter(GaussianProcess):
    """The process with lengths of 50 at most."""

    length_prior = LengthPrior((0.05, 50.0))


def bounds(sizes: tuple[int, ...]) -> None:
    """Error of the process over that with lengths of 50 at most."""
    for runs in sizes:
        print_ratios(
            f"{runs} runs: error with lengths up to 1000 over that with 50",
            *(errors_of(process, runs) for process in (GaussianProcess(), Shorter())),
        )


def errors_of(model, runs: int) -> np.ndarray:
    """RMSE over the standard deviation, of every public function."""
    found = []
    for function in FUNCTIONS:
        test = qmc.Sobol(function.inputs, seed=9).random(1024)
        truth, coded = function.values(test), cube(function.inputs, runs, seed=1)
        fitted = clone(model).fit(coded, function.values((coded + 1.0) / 2.0))
        errors = fitted.predict(2.0 * test - 1.0) - truth
        found.append(np.sqrt(np.mean(errors**2)) / truth.std())
    return np.array(found)


def print_ratios(title: str, ours: np.ndarray, theirs: np.ndarray) -> None:
    ratios = (ours + 1e-12) / (theirs + 1e-12)
    low, middle, high, most = np.quantile(ratios, [0.05, 0.5, 0.95, 1.0])
    print(
        f"{title}: geometric mean {np.exp(np.mean(np.log(ratios))):.2f}, median {middle:.2f}, "
        f"90 % of functions {low:.2f} to {high:.2f}, at most {most:.2f}",
        flush=True,
    )


def large(sizes: tuple[int, ...]) -> None:
    """Processor time, memory and error of a Gaussian process, fit with ten folds."""
    solver = SOLVERS["borehole (8 inputs)"]
    space = space_of(solver)
    test = 2.0 * qmc.Sobol(space.size, seed=9).random(2048) - 1.0
    truth = evaluate(solver, space, test)
    for runs in sizes:
        coded = cube(space.size, runs, seed=1)
        values = evaluate(solver, space, coded)
        start = time.process_time()
        found = fit(space, coded, values, GaussianProcess())
        fitted = time.process_time()
        low, high = found.interval(test)
        seconds = time.process_time() - fitted
        inside = np.mean((low <= truth) & (truth <= high))
        peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3
        print(
            f"{runs} runs: fit {fitted - start:.1f} s, 2048 predictions {seconds:.2f} s, 1 - Q2 "
            f"{1.0 - q2(truth, found.predict(test)):.1e}, coverage {inside:.3f}, "
            f"at most {peak:.0f} MB"
        )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "what",
        choices=[
            "accuracy",
            "small",
            "regression",
            "predict",
            "many",
            "bounds",
            "truncation",
            "large",
        ],
    )
    parser.add_argument("--runs", type=int, nargs="+")
    parser.add_argument("--seeds", type=int, default=10)
    given = parser.parse_args()
    # scikit-learn warns of lengths at their bounds, which is what inert inputs have.
    warnings.simplefilter("ignore", ConvergenceWarning)
    {
        "accuracy": lambda: accuracy(tuple(given.runs or (50, 200, 500))),
        "small": lambda: small(given.seeds),
        "regression": regression,
        "predict": predict,
        "many": many,
        "large": lambda: large(tuple(given.runs or (1000, 2000, 5000, 50_000))),
        "bounds": lambda: bounds(tuple(given.runs or (15, 40, 100))),
        "truncation": lambda: truncation(tuple(given.runs or (40, 100, 200))),
    }[given.what]()


if __name__ == "__main__":
    main()
