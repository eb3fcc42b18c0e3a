"""Prediction intervals: coverage from few runs, and another program's on the same folds."""

import numpy as np
import pytest
from scipy.stats import qmc
from sklearn.linear_model import LinearRegression
from sklearn.model_selection import PredefinedSplit

from surrogate.fitting.fit import fit
from surrogate.regressors.gaussian_process import GaussianProcess
from surrogate.space.distributions import uniform
from surrogate.space.space import Parameter, Space


def space_of(size):
    return Space(tuple(Parameter(f"x{i}", uniform(0, 1)) for i in range(size)))


def friedman(u):
    """Friedman, Grosse and Stuetzle 1983, five inputs."""
    bent = 10.0 * np.sin(np.pi * u[:, 0] * u[:, 1]) + 20.0 * (u[:, 2] - 0.5) ** 2
    return bent + 10.0 * u[:, 3] + 5.0 * u[:, 4]


def currin(u):
    """Currin, Mitchell, Morris and Ylvisaker 1988, two inputs; bent at one edge."""
    above = 2300.0 * u[:, 0] ** 3 + 1900.0 * u[:, 0] ** 2 + 2092.0 * u[:, 0] + 60.0
    below = 100.0 * u[:, 0] ** 3 + 500.0 * u[:, 0] ** 2 + 4.0 * u[:, 0] + 20.0
    return -np.expm1(-0.5 / np.maximum(u[:, 1], 1e-12)) * above / below


def step(u):
    """A jump, which is no path of a smooth process."""
    return np.where(u[:, 0] + 0.3 * u[:, 1] > 0.6, 1.0, 0.0)


@pytest.mark.parametrize("function, size", [(friedman, 5), (currin, 2), (step, 2)])
@pytest.mark.parametrize("runs", [10, 20])
def test_intervals_from_few_runs_hold_new_runs(function, size, runs):
    """95 % intervals with the fitted lengths taken as known held 72 to 86 % from ten runs."""
    new = qmc.Sobol(size, seed=9).random(256)
    truth, inside = function(new), []
    for seed in range(10):
        u = qmc.LatinHypercube(size, seed=seed).random(runs)
        found = fit(space_of(size), 2.0 * u - 1.0, function(u), GaussianProcess())
        mean, (half,) = found.half_widths(2.0 * new - 1.0, (0.95,))
        inside.append((np.abs(truth - mean) <= half).mean())
    assert 0.92 < np.mean(inside) < 0.98


def test_deviations_are_wider_by_what_left_out_runs_show():
    """Cressie 1993: the mean square of left-out errors over their deviations; 1 at least."""
    u = qmc.LatinHypercube(2, seed=3).random(12)
    process = GaussianProcess().fit(2.0 * u - 1.0, step(u))
    mean, std = process.left_out_
    z = (process.standard_ - mean) / std
    assert process.widening_ > 1.0
    assert process.widening_ == pytest.approx(np.sqrt((z**2).mean() * 13 / 11))
    _, wide = process.predict(u, return_std=True)
    process.widening_ = 1.0
    np.testing.assert_allclose(
        wide / process.predict(u, return_std=True)[1], np.sqrt((z**2).mean() * 13 / 11)
    )


def test_intervals_of_a_regressor_without_deviations_are_mapies():
    """MAPIE's cross-validated conformal intervals about the prediction, on the same folds."""
    mapie = pytest.importorskip("mapie.regression")
    space = space_of(3)
    x, new = space.sample(60, seed=1), space.sample(20, seed=2)
    y = x[:, 0] + x[:, 1] ** 2 + 0.1 * np.random.default_rng(0).normal(size=60)
    ours = fit(space, x, y, LinearRegression())
    theirs = mapie.CrossConformalRegressor(
        LinearRegression(), confidence_level=0.95, method="base", cv=PredefinedSplit(ours.folds)
    ).fit_conformalize(x, y)
    np.testing.assert_allclose(
        np.array(ours.interval(new)), theirs.predict_interval(new)[1][:, :, 0].T, rtol=1e-10
    )


@pytest.mark.parametrize("noise", [0.0, 1e-9])
def test_an_exact_trend_leaves_deviations_of_rounding_only(noise):
    """A plane under a linear trend: nothing is left out but rounding, which widens nothing."""
    x = np.random.default_rng(0).uniform(-1, 1, (30, 2))
    y = x @ [1.0, 2.0] + noise * np.sin(9.0 * x[:, 0])
    process = GaussianProcess(trend="linear").fit(x, y)
    at = np.random.default_rng(1).uniform(-1, 1, (200, 2))
    mean, std = process.predict(at, return_std=True)
    drawn = np.array([draw.predict(at) for draw in process.posterior_draws(5, seed=0)])
    assert std.max() < 1e-6
    assert np.abs(drawn - mean).max() < 1e-5
