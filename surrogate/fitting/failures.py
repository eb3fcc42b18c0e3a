"""Where the solver fails: a small tree on the parameters, told only when it beats chance.

The tree has at most two splits in depth. Its balanced accuracy on left-out runs (the mean
of the shares of failed and of good runs that it tells) is compared with that after the
labels were shuffled (Ojala and Garriga 2010, J. Mach. Learn. Res. 11, 1833).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from sklearn.model_selection import StratifiedKFold
from sklearn.tree import DecisionTreeClassifier

from surrogate.space.space import Parameter, Space

#: Fewest failed and fewest good runs; shuffles; chance below which a region is told.
FEWEST, SHUFFLES, CHANCE = 5, 199, 0.01


@dataclass(frozen=True)
class FailingRegion:
    """The part of the space where most runs fail.

    where            conditions in physical units, all of which hold there
    failed, runs     how many runs failed there, of how many
    failed_elsewhere, runs_elsewhere  the same outside
    accuracy         balanced accuracy on left-out runs, 0.5 being chance
    p                probability of as good a tree by chance
    """

    where: tuple[str, ...]
    failed: int
    runs: int
    failed_elsewhere: int
    runs_elsewhere: int
    accuracy: float
    p: float

    def __str__(self) -> str:
        return (
            f"runs fail where {' and '.join(self.where)}: {self.failed} of {self.runs} there, "
            f"{self.failed_elsewhere} of {self.runs_elsewhere} elsewhere"
        )


def failing_region(
    space: Space, coded: NDArray[np.float64], failed: NDArray[np.bool_], *, seed: int = 0
) -> FailingRegion | None:
    """The region of failed runs; None when there are few, or a tree does not beat chance.

    coded: points (run, parameter); failed: (run,).
    """
    bad = int(failed.sum())
    if min(bad, len(failed) - bad) < FEWEST:
        return None
    features, names = _features(space, coded)
    tree = DecisionTreeClassifier(
        max_depth=2,
        min_samples_leaf=max(2, bad // 5),
        class_weight="balanced",
        random_state=seed,
    )
    folds = StratifiedKFold(min(5, bad, len(failed) - bad), shuffle=True, random_state=seed)
    accuracy = _accuracy(tree, features, failed, folds)
    p = _chance(tree, features, failed, folds, accuracy, seed)
    if p > CHANCE:
        return None
    tree.fit(features, failed)
    leaves = tree.apply(features)
    leaf = max(set(leaves.tolist()), key=lambda one: _weight(failed, leaves == one))
    inside = leaves == leaf
    where = tuple(_condition(space, *names[j], low, value) for j, low, value in _path(tree, leaf))
    return FailingRegion(
        where,
        int(failed[inside].sum()),
        int(inside.sum()),
        int(failed[~inside].sum()),
        int((~inside).sum()),
        float(accuracy),
        float(p),
    )


def _accuracy(
    tree: DecisionTreeClassifier,
    features: NDArray[np.float64],
    failed: NDArray[np.bool_],
    folds: StratifiedKFold,
) -> float:
    """Balanced accuracy of the tree on left-out runs, the mean over folds.

    The digits of scikit-learn's `cross_val_score`, in less than half its time.
    """
    shares = []
    for kept, left_out in folds.split(features, failed):
        told = tree.fit(features[kept], failed[kept]).predict(features[left_out])
        bad = failed[left_out]
        shares.append((told[bad].mean() + (~told[~bad]).mean()) / 2)
    return float(np.mean(shares))


def _chance(
    tree: DecisionTreeClassifier,
    features: NDArray[np.float64],
    failed: NDArray[np.bool_],
    folds: StratifiedKFold,
    accuracy: float,
    seed: int,
) -> float:
    """Probability that shuffled labels are told as well; counted no further than it matters.

    Sequential Monte Carlo test (Besag and Clifford 1991, Biometrika 78, 301): it ends when
    too many shuffles are as good for the tree to beat chance.
    """
    rng, as_good = np.random.default_rng(seed), 0
    for shuffles in range(1, SHUFFLES + 1):
        as_good += _accuracy(tree, features, rng.permutation(failed), folds) >= accuracy
        if (as_good + 1) / (SHUFFLES + 1) > CHANCE:
            return (as_good + 1) / (shuffles + 1)
    return (as_good + 1) / (SHUFFLES + 1)


def _weight(failed: NDArray[np.bool_], inside: NDArray[np.bool_]) -> float:
    """Share of failed runs inside, less the share of good ones."""
    return float(failed[inside].sum() / failed.sum() - (~failed[inside]).sum() / (~failed).sum())


def _features(
    space: Space, coded: NDArray[np.float64]
) -> tuple[NDArray[np.float64], list[tuple[Parameter, str]]]:
    """A column a number, and one a level: (run, feature), with (parameter, level)."""
    columns, names = [], []
    for j, parameter in enumerate(space.parameters):
        if parameter.categorical:
            for level, code in zip(parameter.levels, parameter.coded_levels, strict=True):
                columns.append(np.isclose(coded[:, j], code).astype(float))
                names.append((parameter, level))
        else:
            columns.append(coded[:, j])
            names.append((parameter, ""))
    return np.column_stack(columns), names


def _path(tree: DecisionTreeClassifier, leaf: int) -> list[tuple[int, bool, float]]:
    """From root to leaf: (feature, below, threshold), one a feature and side."""
    inner = tree.tree_
    parents = {
        int(child): (node, below)
        for node in range(inner.node_count)
        for below, child in (
            (True, inner.children_left[node]),
            (False, inner.children_right[node]),
        )
        if child >= 0
    }
    found: dict[tuple[int, bool], float] = {}
    node = leaf
    while node in parents:
        node, below = parents[node]
        found.setdefault((int(inner.feature[node]), below), float(inner.threshold[node]))
    return [(feature, below, value) for (feature, below), value in reversed(found.items())]


def _condition(space: Space, parameter: Parameter, level: str, below: bool, value: float) -> str:
    if level:
        return f"{parameter.name} is {'not ' if below else ''}{level}"
    number = float(parameter.decode(np.array(value)))
    return f"{parameter.name} {'<' if below else '>'} {number:.3g} {parameter.unit}".strip()
