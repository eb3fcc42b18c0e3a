"""Fits: any estimator, levels, fields, intervals, folds, bounded memory."""

import tracemalloc

import numpy as np
import pytest
from scipy import stats
from sklearn.ensemble import RandomForestRegressor
from sklearn.linear_model import BayesianRidge, LinearRegression
from sklearn.model_selection import cross_val_predict
from sklearn.neighbors import KNeighborsRegressor
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import StandardScaler
from sklearn.svm import SVR

from surrogate.errors import FitError
from surrogate.fitting import fit as fitting
from surrogate.fitting.fit import Fit, fit
from surrogate.regressors.folds import folds
from surrogate.regressors.polynomial import Interactions, Linear, Quadratic
from surrogate.space.distributions import uniform
from surrogate.space.space import Parameter, Space

NUMERIC = Space(tuple(Parameter(name, uniform(0, 1)) for name in ("a", "b", "c")))
LEVELS = Space((Parameter("a", uniform(0, 1)), Parameter("cloth", levels=("p", "q", "r"))))


def sample(space=NUMERIC, n=40, seed=0, noise=0.1):
    x = space.sample(n, seed=seed)
    rng = np.random.default_rng(seed)
    return x, 1 + 2 * x[:, 0] - x[:, 1] + x[:, 0] ** 2 + noise * rng.normal(size=n)


@pytest.mark.parametrize(
    "estimator",
    [
        Linear(),
        Quadratic(),
        LinearRegression(),
        RandomForestRegressor(n_estimators=20),
        make_pipeline(StandardScaler(), SVR()),
        make_pipeline(StandardScaler(), BayesianRidge()),
        KNeighborsRegressor(3),
    ],
    ids=lambda e: type(e).__name__,
)
@pytest.mark.parametrize("space", [NUMERIC, LEVELS], ids=["numeric", "levels"])
def test_any_estimator(estimator, space):
    """Every scikit-learn regressor fits, predicts with intervals, and repeats itself."""
    x, y = sample(space)
    first, again = (fit(space, x, y, estimator, surrogate="s", output="y") for _ in range(2))
    np.testing.assert_array_equal(first.predict(x), again.predict(x))
    np.testing.assert_array_equal(first.left_out, again.left_out)
    low, high = first.interval(x)
    assert (low < first.predict(x)).all() and (first.predict(x) < high).all()
    mean, std = first.predict(x, return_std=True)
    assert mean.shape == std.shape == (40,) and (std > 0).all()
    assert 0.3 < first.q2 < 1.0


def test_closed_form_left_out_predictions_equal_scikit_learn_refits():
    """Linear's closed-form ten folds are those of cross_val_predict on the same folds."""
    x, y = sample()
    ours = fit(NUMERIC, x, y, Linear())
    splits = [(np.flatnonzero(ours.folds != k), np.flatnonzero(ours.folds == k)) for k in range(10)]
    theirs = cross_val_predict(LinearRegression(), x, y, cv=splits)
    np.testing.assert_allclose(ours.left_out, theirs, atol=1e-12)
    np.testing.assert_allclose(fit(NUMERIC, x, y, LinearRegression()).left_out, theirs, atol=1e-12)


def test_folds_are_balanced_shared_and_fixed_by_the_seed():
    assert (folds(20) == np.arange(20)).all()
    assert (np.bincount(folds(200)) == 20).all()
    assert (folds(200, seed=1) == folds(200, seed=1)).all()
    assert (folds(200, seed=1) != folds(200, seed=2)).any()


def test_q2_of_small_designs_is_that_of_the_regression_table():
    x, y = sample(n=20)
    fitted = fit(NUMERIC, x, y, Linear())
    assert fitted.q2 == pytest.approx(float(fitted.estimator.regression_table()["q2"]), rel=1e-12)


def test_q2_by_definition():
    """1 - SSE / SST: 1 - (1 + 1) / 2 = 0 here; a constant has Q2 1 when met and NaN otherwise."""
    assert fitting.q2([1.0, 2.0, 3.0], [2.0, 2.0, 2.0]) == 0.0
    assert fitting.q2([2.0, 2.0], [2.0, 2.0]) == 1.0
    assert np.isnan(fitting.q2([2.0, 2.0], [2.0, 3.0]))
    assert fitting.rmse([1.0, 2.0], [1.0, 4.0]) == pytest.approx(np.sqrt(2))


def test_levels_reach_plain_estimators_without_an_order():
    """Level means 1, 5, 2 are not monotone in the coded value, and a linear model meets them."""
    x = LEVELS.sample(60, seed=4)
    y = x[:, 0] + np.select([x[:, 1] < -0.5, x[:, 1] > 0.5], [1.0, 2.0], 5.0)
    for estimator in (LinearRegression(), Linear()):
        np.testing.assert_allclose(fit(LEVELS, x, y, estimator).predict(x), y, atol=1e-12)


def test_student_intervals_of_a_polynomial():
    """t(0.975, n - p) times the standard deviation of a new observation."""
    x, y = sample(n=12)
    fitted = fit(NUMERIC, x, y, Linear())
    mean, std = fitted.predict(x, return_std=True)
    np.testing.assert_allclose(fitted.interval(x)[1], mean + stats.t.ppf(0.975, 8) * std)


@pytest.mark.parametrize("confidence", [0.5, 0.9, 0.95])
def test_conformal_intervals_cover(confidence):
    """Intervals from left-out errors cover new points at their level (Vovk 2015)."""
    inside = []
    for seed in range(20):
        x, y = sample(n=100, seed=seed, noise=1.0)
        new_x, new_y = sample(n=500, seed=seed + 1000, noise=1.0)
        low, high = fit(NUMERIC, x, y, LinearRegression()).interval(new_x, confidence)
        inside.append(np.mean((low < new_y) & (new_y < high)))
    assert np.mean(inside) == pytest.approx(confidence, abs=0.03)


def test_fields_are_fitted_mode_by_mode():
    """A field of two modes, each linear in the inputs, is met to rounding; so is its rank."""
    x = NUMERIC.sample(25, seed=2)
    s = np.linspace(0, 1, 30).reshape(5, 6)
    field = 3 + x[:, :1, None] * np.sin(3 * s) + (x[:, 1:2, None] - 0.2) * s**2
    fitted = fit(NUMERIC, x, field, Linear())
    assert len(fitted.estimator.modes_) == 2 and fitted.estimator.truncation_error_ < 1e-7
    np.testing.assert_allclose(fitted.predict(x), field, atol=1e-10)
    assert fitted.left_out.shape == (25, 5, 6) and fitted.q2 == pytest.approx(1.0, abs=1e-12)
    mean, std = fitted.predict(x[:3], return_std=True)
    assert mean.shape == std.shape == (3, 5, 6)


def test_intervals_of_a_field_of_one_mode_are_those_of_its_scalar():
    """A field s(x) * shape has the scalar's Student intervals, scaled by the shape."""
    x, y = sample(n=12)
    shape = np.array([1.0, 2.0, -0.5])
    low, high = fit(NUMERIC, x, y[:, None] * shape, Linear()).interval(x)
    scalar_low, scalar_high = fit(NUMERIC, x, y, Linear()).interval(x)
    np.testing.assert_allclose(
        high - low, (scalar_high - scalar_low)[:, None] * np.abs(shape), rtol=1e-9
    )


def test_field_truncation_error_is_the_share_left_out():
    """Eckart-Young: what k modes leave out is sqrt(1 - sum_k s^2 / sum s^2), reproduced here."""
    x = NUMERIC.sample(25, seed=2)
    rng = np.random.default_rng(0)
    field = rng.normal(size=(25, 40)) * np.linspace(1, 0.01, 40)
    fitted = fit(NUMERIC, x, field, KNeighborsRegressor(2)).estimator
    fluctuation = field - field.mean(axis=0)
    kept = fluctuation @ fitted.modes_.T @ fitted.modes_
    expected = np.sqrt(((fluctuation - kept) ** 2).sum() / (fluctuation**2).sum())
    assert fitted.truncation_error_ == pytest.approx(expected, rel=1e-8)
    assert expected**2 <= 1e-4


def test_constant_output():
    x = NUMERIC.sample(20, seed=1)
    for estimator in (Linear(), RandomForestRegressor(5)):
        fitted = fit(NUMERIC, x, np.full(20, 7.0), estimator)
        np.testing.assert_allclose(fitted.predict(x), 7.0)
        assert fitted.q2 == 1.0
    field = fit(NUMERIC, x, np.full((20, 4), 7.0), Linear())
    np.testing.assert_allclose(field.predict(x), np.full((20, 4), 7.0))
    assert len(field.estimator.modes_) == 0


def test_saturated_fit_has_no_q2_and_no_interval():
    x, y = sample(n=4)
    fitted = fit(NUMERIC, x, y, Linear())
    assert np.isnan(fitted.q2) and np.isnan(fitted.interval(x)[0]).all()
    np.testing.assert_allclose(fitted.predict(x), y)


def test_memory_stays_bounded():
    """A million points of a quadratic in three parameters (ten terms) need no 80 MB matrix."""
    x, y = sample()
    fitted = fit(NUMERIC, x, y, Quadratic())
    many = np.random.default_rng(0).uniform(-1, 1, (1_000_000, 3))
    tracemalloc.start()
    fitted.predict(many)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 40e6  # 8 MB of results and chunks


@pytest.mark.parametrize(
    ("break_it", "message"),
    [
        (lambda x, y: (x[:3], y[:3]), "needs at least 7 runs in 3 parameters but 'y' has 3"),
        (lambda x, y: (x, np.where(y > 1, np.nan, y)), "not finite"),
        (lambda x, y: (x[:, :2], y), "do not fit 3 parameters"),
        (lambda x, y: (x[:20], y), "20 points but 40 values"),
    ],
)
def test_bad_data_is_refused_with_a_sentence(break_it, message):
    with pytest.raises(FitError, match=message):
        fit(NUMERIC, *break_it(*sample()), Interactions(), surrogate="s", output="y")


def test_what_an_estimator_refuses_becomes_a_sentence():
    x, y = sample(n=4)
    with pytest.raises(FitError, match="surrogate 's' cannot be"):
        fit(NUMERIC, x, y, SVR(C=-1.0), surrogate="s", output="y")


def test_no_portable_form_of_a_forest():
    x, y = sample()
    with pytest.raises(FitError, match="no portable form"):
        fit(NUMERIC, x, y, RandomForestRegressor(5)).portable()


def test_minimum_runs():
    assert fitting.minimum_runs(Interactions(), NUMERIC) == 7
    assert fitting.minimum_runs(RandomForestRegressor(), NUMERIC) == 2
    assert isinstance(fit(NUMERIC, *sample(n=7), Interactions()), Fit)
