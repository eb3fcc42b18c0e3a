"""Screening of dependent parameters: three indices, against closed forms of a linear model."""

from itertools import combinations
from math import comb

import numpy as np
import pytest

from surrogate import Study
from surrogate.fitting.fit import fit
from surrogate.regressors.polynomial import Linear
from surrogate.sensitivity.frozen import variance_kept
from surrogate.sensitivity.importance import DEPENDENT, LARGEST, importance
from surrogate.sensitivity.model import model
from surrogate.sensitivity.screening import decide
from surrogate.sensitivity.shapley import shapley
from surrogate.sensitivity.sobol import sobol
from surrogate.space.distributions import distribution, uniform
from surrogate.space.space import Parameter, Space

NORMAL = distribution("normal", mean=0.0, std=1.0)


def normals(correlation):
    parameters = tuple(Parameter(f"x{i + 1}", NORMAL) for i in range(len(correlation)))
    return Space(parameters, tuple(map(tuple, np.asarray(correlation).tolist())))


def explained(b, R, inside):
    """Var E[b'x | x_S] of standard normals with correlation R: the regression on x_S."""
    if not inside:
        return 0.0
    S = list(inside)
    along = R[S] @ b
    return float(along @ np.linalg.solve(R[np.ix_(S, S)], along))


def exact(b, R):
    """Shapley effects, full first-order and independent total indices (Iooss, Prieur 2019)."""
    d, V = len(b), b @ R @ b
    shapley_effects = np.zeros(d)
    for i in range(d):
        others = [j for j in range(d) if j != i]
        for size in range(d):
            for S in combinations(others, size):
                gain = explained(b, R, (*S, i)) - explained(b, R, S)
                shapley_effects[i] += gain / (d * comb(d - 1, size))
    first = [explained(b, R, (i,)) for i in range(d)]
    total = [V - explained(b, R, [j for j in range(d) if j != i]) for i in range(d)]
    return shapley_effects / V, np.array(first) / V, np.array(total) / V


R = np.array([[1.0, 0.6, 0.0, 0.0], [0.6, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, -0.3], [0, 0, -0.3, 1.0]])
B = np.array([1.0, 0.0, 0.5, 0.0])


def linear(space, b):
    def function(coded):
        physical = space.decode(coded)
        return np.column_stack([physical[name] for name in space.names]) @ b

    return function


def test_the_three_indices_are_those_of_the_linear_model():
    space = normals(R)
    found = shapley(linear(space, B), space, samples=2**14)
    for name, values in zip(DEPENDENT, exact(B, R), strict=True):
        assert found[name].values[0] == pytest.approx(values, abs=6e-3)


def test_the_largest_of_the_three_decides():
    """x2 does not enter f but tells x1: kept. x4 tells x3, full first-order 0.018: limit 0.05."""
    space = normals(R)
    fits = {"y": linear(space, B)}
    indices = shapley(fits["y"], space, samples=2**14)
    decided = decide(indices, 0.05, fits=fits, space=space, samples=2**12)
    assert decided.keep == ("x1", "x2", "x3") and decided.freeze == ("x4",)
    largest = np.max(exact(B, R), axis=0)
    assert [v.total for v in decided.verdicts] == pytest.approx(largest, abs=6e-3)
    assert decided.index == LARGEST
    assert "full first-order index is at most" in decided.verdicts[3].sentence
    kept = decided.variance_kept[0]
    assert kept.share == pytest.approx(1.0, abs=1e-6) and kept.frozen_error == pytest.approx(0.0)


def test_an_input_that_acts_through_its_twin_only_is_kept():
    """f = x1 x2, x3 nearly x1: the first two indices of x1 are 0, its Shapley effect is not."""
    R = [[1.0, 0.0, 0.995], [0.0, 1.0, 0.0], [0.995, 0.0, 1.0]]
    space = normals(R)

    def product(coded):
        physical = space.decode(coded)
        return physical["x1"] * physical["x2"]

    indices = shapley(product, space, samples=2**13)
    assert indices["closed_first_order"].values[0, 0] < 0.02
    assert indices["independent_total"].values[0, 0] < 0.02
    decided = decide(indices, 0.05, fits={"y": product}, space=space, samples=2**12)
    assert decided.keep == space.names


def test_variance_kept_of_dependent_inputs():
    """1 - (V - Var E[f | kept]) / V of a linear model."""
    space, b = normals(R), np.array([1.0, 0.4, 0.5, 0.7])
    V = b @ R @ b
    kept = variance_kept(model(linear(space, b), space), [1, 3], np.zeros(4))
    assert kept.share == pytest.approx(explained(b, R, (0, 2)) / V, abs=5e-3)
    assert kept.low <= explained(b, R, (0, 2)) / V <= kept.high
    # f - f(x1, 0, x3, 0) = b2 x2 + b4 x4, which are independent
    assert kept.frozen_error == pytest.approx((0.4**2 + 0.7**2) / V, rel=1e-2)


def test_for_independent_parameters_the_largest_is_the_total_index():
    space = Space(tuple(Parameter(name, uniform(-1.0, 1.0)) for name in "abc"))
    coded = space.sample(40, seed=0)
    one = fit(space, coded, coded @ [3.0, 1.0, 0.2], Linear(), surrogate="linear", output="y")
    by_shapley, by_sobol = (importance(method(one, space, draws=8)) for method in (shapley, sobol))
    assert by_shapley["total"].values == pytest.approx(by_sobol["total"].values, abs=1e-9)


STUDY = """\
study: dependent
solver: borehole
parameters:
  rw: [0.05, 0.15]
  L: [1120, 1680]
  Kw: [9855, 9870]
  Tu: [63070, 115600]
correlation: [[rw, L, 0.5]]
designs: {train: {method: latin_hypercube, runs: 30, seed: 1}}
surrogates: {quadratic: quadratic}
sensitivity: {method: shapley, samples: 1024, draws: 10}
screening: {freeze_below: 0.02}
"""


def test_a_study_with_correlated_parameters_may_be_screened():
    study = Study.from_text(STUDY)
    points = study.designs["train"].coded
    physical = study.space.decode(points)
    flow = physical["rw"] ** 2 / physical["L"] * 1e5
    one = fit(
        study.space,
        points,
        flow,
        study.surrogates["quadratic"].estimator,
        surrogate="q",
        output="y",
    )
    indices = shapley(one, study.space, samples=1024, draws=10)
    decided = decide(indices, 0.02, fits={"y": one}, space=study.space, samples=2**12, draws=10)
    assert {"rw", "L"} <= set(decided.keep) and "Kw" in decided.freeze
