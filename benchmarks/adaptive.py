"""Adaptive designs against space-filling ones of as many runs, for each aim.

    python benchmarks/adaptive.py [AIM ...] [--repeats 10]

Twelve runs a parameter, a third of them the initial Latin hypercube. The other design is one
maximin Latin hypercube of all runs. A Gaussian process learns from each; its error, by the aim:

    accuracy     RMSE on 4096 points, as a share of the output's deviation
    index_width  width of the widest interval of a total index
    index_error  of the same designs: largest error of a total index
    target       share of the space on the wrong side of the output's 80 % quantile
    optimum      best run above the smallest value, as a share of the output's deviation
    probability  relative error of the probability of the 99 % quantile, 40 000 points

`ratio` is adaptive / space-filling of the medians, `better` in how many repeats the adaptive
design has the smaller error. The printed table stands in docs/how_to/adaptive.md.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from growing import grown
from numpy.typing import NDArray
from public_functions import branin, goldstein_price, hartmann_3, hartmann_6, six_hump_camel
from reliability import four_branches

from surrogate.adaptive.aim import (
    ACCURACY,
    FIGURES,
    INDEX_WIDTH,
    OPTIMUM,
    PROBABILITY,
    TARGET,
    Aim,
    Rule,
    Until,
)
from surrogate.designs.latin_hypercube import latin_hypercube
from surrogate.fitting.fit import fit
from surrogate.regressors.gaussian_process import GaussianProcess
from surrogate.sensitivity.pick_freeze import pick_freeze
from surrogate.sensitivity.sobol import sobol
from surrogate.solver import Solver
from surrogate.space.distributions import distribution, uniform
from surrogate.space.space import Parameter, Space
from surrogate_solvers.textbook import Borehole, Ishigami, OTLCircuit, Piston

Array = NDArray[np.float64]
A_PARAMETER, INITIAL = 12, 1.0 / 3.0


@dataclass(frozen=True)
class Function:
    """A public function of coded points."""

    space: Space
    of: Callable[[Array], Array]


def _textbook(solver: Solver) -> Function:
    """The first output of a textbook solver."""
    inputs, output = solver.inputs.items(), next(iter(solver.outputs))
    space = Space(tuple(Parameter(name, uniform(*one.range)) for name, one in inputs))
    return Function(space, lambda coded: np.asarray(solver(**space.decode(coded))[output]))


def _box(ranges: list[tuple[float, float]], of: Callable[[Array], Array]) -> Function:
    """A function of the rows x (inputs, n) on a box."""
    laws = enumerate((uniform(*one) for one in ranges), start=1)
    return _of_rows(Space(tuple(Parameter(f"x{k}", law) for k, law in laws)), of)


def _four_branches(**ends: tuple[float, float]) -> Function:
    """Series system of four branches, two normal inputs (Echard et al. 2011, section 4.1).

    ends  range=(low, high) of the inputs, which are then coded by it and not by probability
    """
    law = distribution("normal", mean=0.0, std=1.0, **ends)
    space = Space(tuple(Parameter(f"x{k}", law) for k in (1, 2)))
    return _of_rows(space, lambda x: -four_branches(x))


def _of_rows(space: Space, of: Callable[[Array], Array]) -> Function:
    return Function(space, lambda coded: of(np.array(list(space.decode(coded).values()))))


BRANIN = _box([(-5, 10), (0, 15)], branin)
CAMEL = _box([(-3, 3), (-2, 2)], six_hump_camel)
HARTMANN_3 = _box([(0, 1)] * 3, hartmann_3)
ISHIGAMI, BOREHOLE, PISTON = _textbook(Ishigami()), _textbook(Borehole()), _textbook(Piston())
OTL = _textbook(OTLCircuit())
WHOLE = {
    "branin": BRANIN,
    "ishigami": ISHIGAMI,
    "hartmann 3": HARTMANN_3,
    "otl circuit": OTL,
    "piston": PISTON,
    "borehole": BOREHOLE,
}
#: Runs where twelve a parameter are too few for anything.
RUNS = {"branches, (-5, 5)": 60, "branches, no ends": 60}
#: Aim -> functions; for an optimum the smallest value too.
FUNCTIONS: dict[str, dict[str, Function]] = {
    ACCURACY: WHOLE,
    INDEX_WIDTH: WHOLE,
    TARGET: WHOLE,
    OPTIMUM: {
        "branin": BRANIN,
        "six-hump camel": CAMEL,
        "log goldstein": _box([(0, 1)] * 2, goldstein_price),
        "hartmann 3": HARTMANN_3,
        "hartmann 6": _box([(0, 1)] * 6, hartmann_6),
    },
    PROBABILITY: {
        "branches, (-5, 5)": _four_branches(range=(-5.0, 5.0)),
        "branches, no ends": _four_branches(),
        "branin": BRANIN,
        "hartmann 3": HARTMANN_3,
        "otl circuit": OTL,
        "piston": PISTON,
        "borehole": BOREHOLE,
    },
}
SMALLEST = {
    "branin": 0.397887,
    "six-hump camel": -1.031628,
    "log goldstein": (np.log(3.0) - 8.693) / 2.427,
    "hartmann 3": -3.862782,
    "hartmann 6": -3.322368,
}


class Truth:
    """What a design of a function is judged by, for one aim."""

    def __init__(self, aim: str, name: str, function: Function) -> None:
        self.aim, self.name, self.function = aim, name, function
        self.points = function.space.sample(40_000 if aim == PROBABILITY else 4096, seed=12345)
        self.values = function.of(self.points)
        self.value = float(np.quantile(self.values, 0.99 if aim == PROBABILITY else 0.8))
        if aim == INDEX_WIDTH:
            self.total = pick_freeze(function.of, function.space, samples=2**15).total

    def errors(self, coded: Array) -> dict[str, float]:
        """Errors of a design, by name."""
        if self.aim == OPTIMUM:
            gap = float(self.function.of(coded).min()) - SMALLEST[self.name]
            return {self.aim: gap / float(self.values.std())}
        process = GaussianProcess(normal_scores=self.aim == PROBABILITY)
        one = fit(self.function.space, coded, self.function.of(coded), process)
        if self.aim == INDEX_WIDTH:
            table = sobol(one, self.function.space)
            width = float((table["total_high"] - table["total_low"]).max())
            error = float(np.abs(table["total"].values.ravel() - self.total).max())
            return {self.aim: width, "index_error": error}
        predicted = one.predict(self.points)
        if self.aim == ACCURACY:
            error = float(np.sqrt(np.mean((predicted - self.values) ** 2)))
            return {self.aim: error / float(self.values.std())}
        beyond, said = self.values > self.value, predicted > self.value
        if self.aim == TARGET:
            return {self.aim: float((beyond != said).mean())}
        return {self.aim: float(abs(said.mean() - beyond.mean()) / beyond.mean())}


def compared(aim: str, name: str, function: Function, repeats: int) -> Iterator[str]:
    """A line for each error of one function."""
    truth = Truth(aim, name, function)
    runs = RUNS.get(name, A_PARAMETER * function.space.size)
    start = max(round(INITIAL * runs), function.space.size + 3)
    rule = Rule(Aim(aim, ("y",), truth.value), Until(runs, FIGURES[aim][0]))
    both = []
    for seed in range(repeats):
        filling = latin_hypercube(function.space, runs=runs, seed=100 + seed)
        chosen = grown(function.space, function.of, rule, start, seed)
        both.append((truth.errors(chosen), truth.errors(filling)))
    for error in both[0][0]:
        pairs = np.array([(ours[error], filled[error]) for ours, filled in both])
        ours, filled = np.median(pairs, axis=0)
        better = int((pairs[:, 0] < pairs[:, 1]).sum())
        yield (
            f"{error:<12} {name:<17} {runs:>4} {ours:>10.3g} {filled:>10.3g} "
            f"{ours / filled:>7.2f} {better:>3} of {repeats}"
        )


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("aims", nargs="*", metavar="AIM")
    parser.add_argument("--repeats", type=int, default=10)
    given = parser.parse_args()
    print(
        f"{'error':<12} {'function':<17} {'runs':>4} {'adaptive':>10} {'filling':>10} "
        f"{'ratio':>7} better"
    )
    for aim in given.aims or FUNCTIONS:
        for name, function in FUNCTIONS[aim].items():
            for line in compared(aim, name, function, given.repeats):
                print(line, flush=True)


if __name__ == "__main__":
    main()
