"""Adaptive designs that choose levels of fidelity: solver seconds at equal RMSE.

    python benchmarks/spending.py [forrester currin park borehole] [--repeats 5]

The pairs of `fidelity.py`; a cheap run counts a second, one of the truth ten. The fixed design has
n runs of the truth nested in 5 n cheap ones. The adaptive one begins with a third of the fixed
one's truth (two more than inputs at least) nested in three times as many cheap runs, and chooses
place and level until it has spent as many seconds. Co-kriging learns from both; RMSE on 1000
points, medians over repeats with other initial runs. `seconds`: of the adaptive design when its
RMSE has come to the fixed one's, looked for up to twice the budget; `saved`: 1 - that over the
budget. `truth`: runs of the truth of both. The printed table stands in docs/how_to/levels.md.
"""

from __future__ import annotations

import argparse

import numpy as np
from fidelity import CHEAP, PAIRS, RATIO, rmse

from surrogate.adaptive.aim import ACCURACY, Aim, Level, Review, Rule, Until
from surrogate.adaptive.answers import Answers
from surrogate.adaptive.by_seconds import choose_levels
from surrogate.adaptive.costs import costs
from surrogate.adaptive.judge import is_due, review
from surrogate.designs.nested import nested
from surrogate.regressors.cokriging import CoKriging
from surrogate.regressors.level_process import LevelRuns
from surrogate.space.distributions import uniform
from surrogate.space.space import Parameter, Space

NAMES = ("cheap", "true")
#: Runs between looks at the RMSE, and budgets up to which it is looked at.
LOOK, BUDGETS = 4, 2.0
FIRST, PER_TRUTH = 3, 3


class Pair:
    """A pair of `fidelity.py` with the points that judge it."""

    def __init__(self, name: str) -> None:
        size, cheap, truth, *_ = PAIRS[name]
        self.space = Space(tuple(Parameter(f"x{j}", uniform(0, 1)) for j in range(size)))
        self.functions = dict(zip(NAMES, (cheap, truth), strict=True))
        self.new = self.space.sample(1000, seed=99)
        self.target = truth((self.new + 1) / 2)

    def design(self, cheap: int, true: int, seed: int) -> Answers:
        """A nested design and its answers."""
        rows = nested(self.space, runs=dict(zip(NAMES, (cheap, true), strict=True)), seed=seed)
        return self.answered(rows, np.repeat(NAMES, (cheap, true)))

    def answered(self, coded: np.ndarray, levels: np.ndarray) -> Answers:
        """All answers of some runs."""
        values, ok = np.empty(len(coded)), np.ones(len(coded), dtype=bool)
        for name, of in self.functions.items():
            values[levels == name] = of((coded[levels == name] + 1) / 2)
        return Answers(coded, ok, ok, {"y": values}, levels)

    def error(self, answers: Answers) -> float:
        """RMSE of the co-kriging of some runs."""
        cheap, true = (answers.of_level(name).known("y") for name in NAMES)
        return rmse(CoKriging(lower=[LevelRuns(*cheap)]).fit(*true).predict(self.new), self.target)


def race(pair: Pair, true: int, seed: int) -> tuple[float, float, float, int]:
    """RMSE of the fixed and of the adaptive design, seconds at equal RMSE, runs of the truth."""
    budget, fixed = true * (RATIO + CHEAP), pair.error(pair.design(CHEAP * true, true, seed))
    inputs = tuple(range(pair.space.size))
    levels = (Level("cheap", inputs, 1.0), Level("true", inputs, RATIO))
    until = Until(None, "q2", seconds=BUDGETS * budget)
    rule = Rule(Aim(ACCURACY, ("y",)), until, seed=seed, levels=levels)
    first = max(true // FIRST, pair.space.size + 2)
    answers, reviews = pair.design(PER_TRUTH * first, first, 100 + seed), list[Review]()
    reached, equal, runs, looked = np.nan, np.inf, 0, 0
    while True:
        spent = costs(rule, answers).spent
        if len(answers.coded) >= looked + LOOK or spent + 1.0 > budget > spent - RATIO:
            looked, error = len(answers.coded), pair.error(answers)
            if spent <= budget:
                reached, runs = error, int((answers.levels == "true").sum())
            if error <= fixed:
                equal = min(equal, spent)
        if spent > budget and np.isfinite(equal):
            return fixed, reached, equal, runs
        if is_due(rule, reviews, len(answers.coded)):
            reviews.append(review(rule, pair.space, answers))
        rows, names = choose_levels(rule, pair.space, answers, reviews[-1])
        if not len(rows):
            return fixed, reached, equal, runs
        answers = pair.answered(
            np.vstack([answers.coded, rows]), np.append(answers.levels, np.array(names))
        )


def line(name: str, true: int, repeats: int) -> str:
    """A row of the table."""
    pair, budget = Pair(name), true * (RATIO + CHEAP)
    found = np.array([race(pair, true, seed) for seed in range(repeats)])
    fixed, reached, equal, runs = np.median(found, axis=0)
    better = int((found[:, 1] < found[:, 0]).sum())
    return (
        f"{name:<10} {budget:>7.0f} {fixed:>9.3g} {reached:>9.3g} {better:>3} of {repeats} "
        f"{equal:>8.0f} {1 - equal / budget:>6.0%} {true:>6} {runs:>5.0f}"
    )


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("pairs", nargs="*", metavar="PAIR")
    parser.add_argument("--repeats", type=int, default=5)
    given = parser.parse_args()
    print("pair        budget     fixed  adaptive  better  seconds  saved  truth: fixed, adaptive")
    for name in given.pairs or PAIRS:
        for true in PAIRS[name][3]:
            print(line(name, true, given.repeats), flush=True)


if __name__ == "__main__":
    main()
