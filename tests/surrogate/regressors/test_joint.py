"""The joint law of new runs, by a Gaussian process and by a polynomial."""

from __future__ import annotations

import numpy as np
import pytest

from surrogate.regressors.gaussian_process import GaussianProcess
from surrogate.regressors.matern import correlation
from surrogate.regressors.polynomial import Quadratic

RNG = np.random.default_rng(1)
X = RNG.uniform(-1.0, 1.0, (30, 2))
Y = np.sin(3.0 * X[:, 0]) + X[:, 1] ** 2 + 0.05 * RNG.standard_normal(30)
SETS = np.concatenate([RNG.uniform(-1.0, 1.0, (3, 4, 2)), np.zeros((3, 2, 2))], axis=1)


@pytest.mark.parametrize("regressor", [GaussianProcess(), GaussianProcess("linear"), Quadratic()])
def test_diagonal_is_the_variance_of_a_new_run_and_means_agree(regressor):
    regressor.fit(X, Y)
    mean, covariance = regressor.predict_joint(SETS)
    alone, std = regressor.predict(SETS.reshape(-1, 2), return_std=True)
    assert mean.ravel() == pytest.approx(alone, rel=1e-10)
    assert np.einsum("kii->ki", covariance).ravel() == pytest.approx(std**2, rel=1e-9)


@pytest.mark.parametrize("regressor", [GaussianProcess(), Quadratic()])
def test_runs_at_the_same_point_are_one_run(regressor):
    _, covariance = regressor.fit(X, Y).predict_joint(SETS)
    assert covariance[:, 4, 5] == pytest.approx(covariance[:, 4, 4], rel=1e-12)


def test_covariance_is_that_of_the_bordered_kriging_system():
    """k(x, y) - [r; f]' [R F; F' 0]^-1 [r; f] (Santner et al. 2018, section 3.2)."""
    process = GaussianProcess("linear").fit(X, Y)
    points, n = SETS[0, :4], len(X)
    k, F = (lambda a, b: correlation(a, b, process.lengths_)), process.trend_columns
    q = F(X).shape[1]
    whole = np.block([[k(X, X) + process.nugget_ * np.eye(n), F(X)], [F(X).T, np.zeros((q, q))]])
    right = np.vstack([k(X, points), F(points).T])
    exact = (
        k(points, points) + process.nugget_ * np.eye(4) - right.T @ np.linalg.solve(whole, right)
    )
    _, found = process.predict_joint(points[None])
    assert found[0] == pytest.approx(process.predictive_variance * exact, rel=1e-7, abs=1e-10)
