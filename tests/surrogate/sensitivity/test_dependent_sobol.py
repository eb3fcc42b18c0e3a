"""Full and independent Sobol' indices of correlated inputs against closed forms."""

import numpy as np
import pytest
from scipy.special import ndtri

from surrogate.errors import StudyError
from surrogate.fitting.fit import fit
from surrogate.regressors.gaussian_process import GaussianProcess
from surrogate.sensitivity.dependent_sobol import dependent_sobol
from surrogate.sensitivity.shapley import shapley
from surrogate.sensitivity.sobol import sobol
from surrogate.space.distributions import distribution, uniform
from surrogate.space.space import Parameter, Space
from surrogate.study.study import Study

NAMES = ("full_first_order", "full_total", "independent_first_order", "independent_total")


def gaussian_space(correlation):
    normal = distribution("normal", mean=0.0, std=1.0)
    names = [f"x{j}" for j in range(len(correlation))]
    return Space(tuple(Parameter(name, normal) for name in names), tuple(map(tuple, correlation)))


def scores(coded):
    return ndtri(np.clip((coded + 1.0) / 2.0, 1e-15, 1 - 1e-15))


def test_a_sum_of_correlated_normals():
    """f = b'z: full indices (R b)_i^2 / b'R b, independent ones b_i^2 / ((R^-1)_ii b'R b)."""
    R = np.array([[1.0, 0.6, 0.0], [0.6, 1.0, -0.3], [0.0, -0.3, 1.0]])
    b = np.array([1.0, 2.0, 0.5])
    found = dependent_sobol(lambda x: scores(x) @ b, gaussian_space(R), seed=1).isel(output=0)
    variance = b @ R @ b
    full, own = (R @ b) ** 2 / variance, b**2 / np.linalg.inv(R).diagonal() / variance
    for name, expected in zip(NAMES, (full, full, own, own), strict=True):
        assert found[name].values == pytest.approx(expected, abs=4e-3), name
        low, high = found[f"{name}_low"].values, found[f"{name}_high"].values
        assert (low <= expected + 1e-3).all() and (high >= expected - 1e-3).all(), name


@pytest.mark.parametrize("rho", [0.0, 0.5, -0.8])
def test_a_product_of_two_correlated_normals(rho):
    """f = z1 z2 = rho z1^2 + sqrt(1 - rho^2) z1 e, of variance 2 rho^2 + 1 - rho^2."""
    space = gaussian_space([[1.0, rho], [rho, 1.0]])
    found = dependent_sobol(lambda x: scores(x).prod(axis=1), space, seed=2).isel(output=0)
    whole = 1.0 + rho**2
    expected = (2.0 * rho**2 / whole, 1.0, 0.0, (1.0 - rho**2) / whole)
    for name, value in zip(NAMES, expected, strict=True):
        assert found[name].values == pytest.approx([value, value], abs=0.015), name


def test_independent_inputs_have_their_sobol_indices():
    space = Space(tuple(Parameter(name, uniform(-1, 1)) for name in "abc"))

    def f(x):
        return x[:, 0] + x[:, 0] * x[:, 1] + np.sin(3 * x[:, 2])

    found = dependent_sobol(f, space).isel(output=0)
    known = sobol(f, space).isel(output=0)
    for kind in ("full", "independent"):
        for name in ("first_order", "total"):
            assert found[f"{kind}_{name}"].values == pytest.approx(known[name].values, abs=2e-3)


def test_two_of_the_four_are_those_beside_shapley_effects():
    """Var E[f | x_i] and E[Var(f | others)], found there by another estimator."""
    space = gaussian_space([[1.0, 0.7, 0.2], [0.7, 1.0, 0.0], [0.2, 0.0, 1.0]])

    def f(x):
        return np.exp(0.4 * scores(x) @ [1.0, 0.3, 0.5]) + scores(x)[:, 1] ** 2

    found, beside = (method(f, space).isel(output=0) for method in (dependent_sobol, shapley))
    for name, other in (
        ("full_first_order", "closed_first_order"),
        ("independent_total", "independent_total"),
    ):
        half = np.hypot(found[f"{name}_sampling"].values, beside[f"{other}_sampling"].values)
        assert (np.abs(found[name].values - beside[other].values) <= 2.0 * half + 2e-3).all()


def test_an_input_that_only_follows_another_has_nothing_of_its_own():
    space = gaussian_space([[1.0, 0.9], [0.9, 1.0]])
    found = dependent_sobol(lambda x: scores(x)[:, 0] ** 3, space).isel(output=0)
    assert found["independent_total"].values[1] == 0.0
    assert found["full_first_order"].values[1] > 0.5


def test_the_surrogates_part_holds_the_truth():
    """A Gaussian process of 40 runs of a sum: its intervals hold the closed forms."""
    R = np.array([[1.0, 0.5], [0.5, 1.0]])
    space = Space(tuple(Parameter(name, uniform(0, 1)) for name in "ab"), tuple(map(tuple, R)))
    x = np.random.default_rng(0).uniform(-1, 1, (40, 2))
    own = fit(space, x, x[:, 0] + np.sin(2 * x[:, 1]), GaussianProcess())
    found = dependent_sobol(own, space).isel(output=0)
    truth = dependent_sobol(lambda x: x[:, 0] + np.sin(2 * x[:, 1]), space).isel(output=0)
    for name in NAMES:
        assert (found[f"{name}_surrogate"].values > 0.0).all()
        assert (found[f"{name}_low"] <= truth[name] + 1e-3).all()
        assert (found[f"{name}_high"] >= truth[name] - 1e-3).all()


STUDY = {
    "study": "demo",
    "solver": "ishigami",
    "parameters": {"X1": [-1, 1], "X2": [-1, 1]},
    "designs": {"train": {"method": "latin_hypercube", "runs": 20, "seed": 1}},
    "surrogates": {"quadratic": "quadratic"},
}


def test_a_study_takes_it_for_correlated_parameters():
    correlated = {**STUDY, "correlation": [["X1", "X2", 0.5]]}
    study = Study.from_mapping({**correlated, "sensitivity": "dependent_sobol"})
    assert study.sensitivity_method.name == "dependent_sobol"
    with pytest.raises(StudyError, match="use method shapley or dependent_sobol, or drop corr"):
        Study.from_mapping({**correlated, "sensitivity": "sobol"})


def test_constraints_are_refused():
    joined = {**STUDY, "constraints": ["X1 + X2 <= 0.5"], "sensitivity": "dependent_sobol"}
    with pytest.raises(StudyError, match="joined by constraints; use method shapley, or drop"):
        Study.from_mapping(joined)
