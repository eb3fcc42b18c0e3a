"""Polynomials: terms, exact recovery, closed-form indices, the scikit-learn contract."""

import tracemalloc

import numpy as np
import pytest
from sklearn.utils.estimator_checks import check_estimator

from surrogate.errors import FitError
from surrogate.regressors.polynomial import Interactions, Linear, Quadratic
from surrogate.space.distributions import distribution, uniform
from surrogate.space.space import Parameter, Space

MIXED = Space(
    (
        Parameter("tension", uniform(0.05, 0.14), unit="N/mm"),
        Parameter("bandage", levels=("a", "b", "c")),
        Parameter("mu", distribution("normal", mean=0.2, std=0.05)),
    )
)
NUMERIC = Space((Parameter("tension", uniform(0, 1)), Parameter("mu", uniform(0, 1))))

#: Chassagne et al. 2018, Table III: mmHg for each coded unit, and the indices that follow.
TABLE_3 = {
    "mu_skin": 2.7,
    "tension": 11.54,
    "leg_length": 2.85,
    "alpha1": 4.54,
    "alpha2": 3.92,
    "alpha3": -1.74,
    "alpha4": -0.51,
}


def points(space, n=60, seed=1):
    return space.sample(n, seed=seed)


@pytest.mark.parametrize(
    ("model", "names"),
    [
        (Linear, ["1", "tension", "mu"]),
        (Interactions, ["1", "tension", "mu", "tension:mu"]),
        (Quadratic, ["1", "tension", "mu", "tension:mu", "tension^2", "mu^2"]),
    ],
)
def test_term_names(model, names):
    x = points(NUMERIC)
    assert list(model(NUMERIC).fit(x, x[:, 0]).model_.names) == names
    assert model().minimum_runs(NUMERIC) == len(names)


def test_categorical_terms_are_effect_coded_and_never_squared():
    """Three levels are two columns; interactions join different parameters only."""
    x = points(MIXED)
    fitted = Quadratic(MIXED).fit(x, x[:, 0])
    assert list(fitted.model_.names) == [
        "1",
        "tension",
        "bandage[b]",
        "bandage[c]",
        "mu",
        "tension:bandage[b]",
        "tension:bandage[c]",
        "tension:mu",
        "bandage[b]:mu",
        "bandage[c]:mu",
        "tension^2",
        "mu^2",
    ]
    assert fitted.minimum_runs(MIXED) == 12


def test_effect_coding_gives_level_means():
    """With effect coding the constant is the mean of the level means, the rest deviations."""
    space = Space((Parameter("bandage", levels=("a", "b", "c")),))
    x = np.array([[-1.0], [0.0], [1.0], [1.0]])
    fitted = Linear(space).fit(x, [1.0, 4.0, 7.0, 9.0])
    np.testing.assert_allclose(fitted.coef_, [(1 + 4 + 8) / 3, 4 - 13 / 3, 8 - 13 / 3])
    np.testing.assert_allclose(fitted.predict([[-1.0], [0.0], [1.0]]), [1, 4, 8])


def test_quadratic_recovers_a_quadratic_function():
    x = points(NUMERIC)
    y = 1 - 2 * x[:, 0] + 3 * x[:, 0] * x[:, 1] + 0.5 * x[:, 1] ** 2
    fitted = Quadratic(NUMERIC).fit(x, y)
    np.testing.assert_allclose(fitted.coef_, [1, -2, 0, 3, 0, 0.5], atol=1e-13)
    np.testing.assert_allclose(fitted.predict(x), y, atol=1e-13)


def test_prediction_interval_covers_at_its_level():
    """mean +- t std of a new observation covers 95 % of new noisy values (theory: exactly)."""
    rng = np.random.default_rng(5)
    inside = 0
    for _ in range(2000):
        x, new = rng.uniform(-1, 1, (12, 1)), rng.uniform(-1, 1, (1, 1))
        fitted = Linear().fit(x, 2 * x[:, 0] + rng.normal(size=12))
        mean, std = fitted.predict(new, return_std=True)
        inside += abs(2 * new[0, 0] + rng.normal() - mean[0]) < 2.228138851964939 * std[0]
    assert fitted.interval_freedom == 10
    assert inside / 2000 == pytest.approx(0.95, abs=0.0147)  # three standard errors


def test_indices_of_the_linear_model_of_chassagne_2018():
    """For sum b_i x_i on uniform inputs S_i = b_i^2 / sum b^2: Table III gives 0.709 to tension."""
    space = Space(tuple(Parameter(name, uniform(0, 1)) for name in TABLE_3))
    beta = np.array(list(TABLE_3.values()))
    x = points(space)
    indices = Linear(space).fit(x, 32.73 + x @ beta).sobol_indices()
    np.testing.assert_allclose(indices.first_order, beta**2 / (beta**2).sum(), atol=1e-12)
    np.testing.assert_allclose(indices.total, indices.first_order, atol=1e-12)
    np.testing.assert_allclose(
        indices.first_order,
        [0.038808, 0.708926, 0.043239, 0.109724, 0.081802, 0.016117, 0.001385],
        atol=5e-7,
    )
    assert indices.variance == pytest.approx((beta**2).sum() / 3)
    assert indices.mean == pytest.approx(32.73)


def test_indices_of_a_quadratic():
    """Var x = 1/3, Var x^2 = 4/45, Var x1 x2 = 1/9 on uniform coded inputs."""
    x = points(NUMERIC)
    y = 5 + 2 * x[:, 0] - x[:, 1] + 3 * x[:, 0] * x[:, 1] + 4 * x[:, 0] ** 2
    indices = Quadratic(NUMERIC).fit(x, y).sobol_indices()
    parts = np.array([4 / 3 + 16 * 4 / 45, 1 / 3, 9 / 9])
    assert indices.variance == pytest.approx(parts.sum(), rel=1e-12)
    np.testing.assert_allclose(indices.first_order, parts[:2] / parts.sum(), rtol=1e-11)
    np.testing.assert_allclose(indices.total, (parts[:2] + 1) / parts.sum(), rtol=1e-11)
    np.testing.assert_allclose(
        indices.second_order, [[0, 1 / parts.sum()], [1 / parts.sum(), 0]], rtol=1e-11, atol=1e-14
    )


def test_no_indices_for_correlated_inputs():
    space = Space(NUMERIC.parameters, ((1.0, 0.5), (0.5, 1.0)))
    x = points(space)
    with pytest.raises(FitError, match="correlated"):
        Linear(space).fit(x, x[:, 0]).sobol_indices()


@pytest.mark.parametrize("model", [Linear, Interactions, Quadratic])
def test_scikit_learn_contract(model):
    """scikit-learn's own conformance suite."""
    check_estimator(model(), on_skip=None)


def test_regression_table_marks_a_deterministic_solver():
    x = points(NUMERIC)
    table = Linear(NUMERIC).fit(x, np.exp(x[:, 0])).regression_table(deterministic=True)
    assert list(table["term"].values) == ["1", "tension", "mu"]
    assert table.attrs["deterministic"] == 1 and "deterministic" in table.attrs["notes"]


@pytest.mark.parametrize("model", [Linear, Quadratic])
def test_outputs_fitted_together_are_those_fitted_alone(model):
    """One factorisation for all outputs gives the coefficients and deviations of each."""
    x = points(MIXED)
    Y = np.column_stack([np.exp(x[:, 0]), x[:, 0] * x[:, 2], np.sin(3 * x[:, 2])])
    together = model(MIXED).fit_many(x, Y)
    alone = [model(MIXED).fit(x, y) for y in Y.T]
    new = points(MIXED, n=20, seed=2)
    mean, std = together[0].predict_many(together, new, return_std=True)
    for k, one in enumerate(alone):
        np.testing.assert_allclose(together[k].coef_, one.coef_, atol=1e-13)
        np.testing.assert_allclose(
            (mean[:, k], std[:, k]), one.predict(new, return_std=True), atol=1e-12
        )


def test_hundred_thousand_runs_need_no_matrix_of_runs_by_runs():
    """Fit, ten folds and table in less than 200 MB, a quarter of one fold's hat matrix.

    The truth is a plane, so every left-out prediction is exact.
    """
    x = 2.0 * np.random.default_rng(0).random((100_000, 7)) - 1.0
    y = 3.0 + x @ np.arange(1.0, 8.0)
    tracemalloc.start()
    fitted = Linear().fit(x, y)
    left_out = fitted.leave_out(np.arange(100_000) % 10)
    fitted.regression_table()
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    np.testing.assert_allclose(left_out, y, atol=1e-9)
    assert peak < 200e6
