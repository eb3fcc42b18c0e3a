"""The region of failed runs: found where there is one, not told where there is none."""

import numpy as np
from sklearn.model_selection import StratifiedKFold, cross_val_score
from sklearn.tree import DecisionTreeClassifier

from surrogate.fitting.failures import _accuracy, failing_region
from surrogate.space.distributions import uniform
from surrogate.space.space import Parameter, Space

SPACE = Space(
    (
        Parameter("load", uniform(0.0, 100.0), unit="N"),
        Parameter("length", uniform(1.0, 3.0), unit="m"),
        Parameter("kind", levels=("x", "y", "z")),
    )
)


def test_a_corner_is_found_in_physical_units():
    """Fails where load > 70 N and length > 2 m, which is 15 % of the space."""
    coded = SPACE.sample(200, seed=1)
    at = SPACE.decode(coded)
    failed = (at["load"] > 70) & (at["length"] > 2)
    found = failing_region(SPACE, coded, failed)
    assert found is not None and found.failed == found.runs == failed.sum()
    assert found.failed_elsewhere == 0 and found.p <= 0.01
    words = dict(condition.split(" > ") for condition in found.where)
    assert set(words) == {"load", "length"}
    assert abs(float(words["load"].split()[0]) - 70) < 3 and words["load"].endswith(" N")
    assert abs(float(words["length"].split()[0]) - 2) < 0.1
    assert str(found).startswith("runs fail where ")


def test_a_level_is_found():
    coded = SPACE.sample(120, seed=2)
    found = failing_region(SPACE, coded, SPACE.decode(coded)["kind"] == "y")
    assert found is not None and found.where == ("kind is y",)


def test_chance_is_not_told():
    """Failures that fall anywhere: at most one of 20 samples is told (1 % each)."""
    rng = np.random.default_rng(3)
    told = 0
    for seed in range(20):
        coded = SPACE.sample(60, seed=seed)
        told += failing_region(SPACE, coded, rng.random(60) < 0.2) is not None
    assert told <= 1


def test_few_failures_are_not_explained():
    coded = SPACE.sample(50, seed=4)
    assert failing_region(SPACE, coded, np.arange(50) < 4) is None
    assert failing_region(SPACE, coded, np.arange(50) >= 4) is None


def test_accuracy_is_scikit_learns():
    """Ties with shuffled labels count, so every digit of `cross_val_score` is needed."""
    rng = np.random.default_rng(5)
    tree = DecisionTreeClassifier(max_depth=2, class_weight="balanced", random_state=0)
    folds = StratifiedKFold(5, shuffle=True, random_state=0)
    for seed in range(5):
        coded, failed = SPACE.sample(60, seed=seed), rng.random(60) < 0.3
        scores = cross_val_score(tree, coded, failed, cv=folds, scoring="balanced_accuracy")
        assert _accuracy(tree, coded, failed, folds) == scores.mean()
