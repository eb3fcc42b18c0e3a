"""The posterior against conjugate theory, and what it says of itself."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy import stats

from surrogate.calibration.calibrate import calibrate, likelihood_of
from surrogate.calibration.likelihood import Normal
from surrogate.calibration.posterior import Posterior
from surrogate.calibration.problem import Measured, Problem
from surrogate.fitting.fit import Fit, fit
from surrogate.regressors.polynomial import Linear
from surrogate.space.distributions import distribution, uniform
from surrogate.space.space import Parameter, Space

SPACE = Space((Parameter("x", uniform(0.0, 10.0)), Parameter("t", uniform(-5.0, 5.0))))
X = np.array([1.0, 3.0, 5.0, 7.0, 9.0])


@cache
def line() -> Fit:
    """A linear surrogate of 2 + 0.5 x + 3 t with residuals of standard deviation 0.05 or so."""
    coded = np.random.default_rng(3).uniform(-1.0, 1.0, (60, 2))
    at = SPACE.decode(coded)
    noise = 0.05 * np.random.default_rng(4).standard_normal(60)
    return fit(SPACE, coded, 2.0 + 0.5 * at["x"] + 3.0 * at["t"] + noise, Linear(), output="y")


def problem(values: np.ndarray, error: float, **words: object) -> Problem:
    """Measurements at X, t being free with the prior N(1, 0.5^2)."""
    prior = words.pop("prior", distribution("normal", mean=1.0, std=0.5, range=(-5.0, 5.0)))
    coded = SPACE.encode({"x": X, "t": np.zeros(len(X))})
    measured = Measured("y", "", values, np.full(len(X), error))
    return Problem(SPACE, {"t": prior}, coded, tuple("abcde"), (measured,), **words)


def conjugate(values: np.ndarray, error: float, extra: np.ndarray | float = 0.0):
    """Exact mean and sd of t: y = a + b t + e, e ~ N(0, V), t ~ N(1, 0.5^2).

    The emulator's covariance is taken at t = 1; it hardly changes within the posterior.
    """
    at = problem(values, error)
    law = next(likelihood_of(at, {"y": line()}).laws(np.zeros((1, 1))))
    covariance = law.covariance[0] + extra
    zero, one = (
        line().predict(SPACE.encode({"x": X, "t": np.full(len(X), t)})) for t in (0.0, 1.0)
    )
    slope = one - zero
    precision = slope @ np.linalg.solve(covariance, slope) + 1.0 / 0.5**2
    mean = (slope @ np.linalg.solve(covariance, values - zero) + 1.0 / 0.5**2) / precision
    return mean, precision**-0.5


def test_a_covariance_that_is_not_positive_definite_costs_its_own_value_only():
    rng = np.random.default_rng(5)
    root, mean, values = rng.normal(size=(4, 5, 5)), rng.normal(size=(4, 5)), rng.normal(size=5)
    covariance = root @ root.swapaxes(1, 2) + 0.1 * np.eye(5)
    measured, none = Measured("y", "", values, np.ones(5)), np.zeros((4, 5, 5))
    expected = [
        stats.multivariate_normal(*one).logpdf(values) for one in zip(mean, covariance, strict=True)
    ]

    def densities() -> np.ndarray:
        return Normal(measured, np.arange(5), mean, covariance, none, none[:, 0]).log_density

    assert densities() == pytest.approx(expected, rel=1e-7)
    covariance[1, 0, 0] = -1.0
    expected[1] = -np.inf
    assert densities() == pytest.approx(expected, rel=1e-7)


VALUES = 2.0 + 0.5 * X + 3.0 * 1.4 + np.array([0.3, -0.2, 0.5, 0.1, -0.4])


@cache
def linear() -> Posterior:
    return calibrate(problem(VALUES, 0.6, seed=1), {"y": line()})


def test_linear_gaussian_case_has_the_conjugate_posterior():
    """Mean and variance within four Monte Carlo standard errors of the exact ones."""
    mean, sd = conjugate(VALUES, 0.6)
    found = linear().figures.sel(unknown="t")
    size = float(found["ess_bulk"])
    assert float(found["mean"]) == pytest.approx(mean, abs=4.0 * sd / np.sqrt(size))
    assert float(found["sd"]) == pytest.approx(sd, rel=4.0 / np.sqrt(2.0 * size))
    assert float(found["shrinkage"]) == pytest.approx(1.0 - sd**2 / 0.25, abs=0.02)


def test_draws_follow_the_exact_law():
    mean, sd = conjugate(VALUES, 0.6)
    drawn = linear().draws("t")
    thinned = drawn[:: max(len(drawn) // 400, 1)]
    assert stats.kstest(thinned, stats.norm(mean, sd).cdf).pvalue > 1e-3


def test_a_walk_that_converged_says_so():
    found = linear().figures
    assert found.attrs["converged"] == 1
    assert (found["r_hat"] < 1.05).all() and (found["ess_bulk"] >= 400).all()
    assert linear().notes == ()


def test_dominating_prior_is_kept():
    """Measurements a hundred times as wide as the prior leave it as it is."""
    found = calibrate(problem(VALUES, 150.0, seed=2), {"y": line()}).figures.sel(unknown="t")
    assert float(found["mean"]) == pytest.approx(1.0, abs=0.05)
    assert float(found["sd"]) == pytest.approx(0.5, rel=0.08)
    assert abs(float(found["shrinkage"])) < 0.15


def test_same_seed_same_draws():
    again = calibrate(problem(VALUES, 0.6, seed=1), {"y": line()})
    assert np.array_equal(again.draws("t"), linear().draws("t"))


def test_posterior_that_piles_up_at_an_end_is_told():
    """Measurements that ask for t = 1.4 with a prior that ends at 1.2."""
    found = calibrate(problem(VALUES, 0.1, prior=uniform(-5.0, 1.2)), {"y": line()})
    assert any("lies at the upper end of its range" in one for one in found.notes)


def test_walk_that_is_cut_short_is_told():
    found = calibrate(problem(VALUES, 0.6), {"y": line()}, longest=64)
    assert found.figures.attrs["converged"] == 0
    assert "before it had converged" in found.notes[0]


def test_constant_discrepancy_is_a_bias_that_all_cases_share():
    """Two points only: given its sd s the bias adds s^2 to all covariances."""
    two = replace(
        problem(VALUES, 0.6, discrepancy=True),
        measured=(Measured("y", "", np.where(X < 4, VALUES, np.nan), np.full(5, 0.6)),),
    )
    likelihood = likelihood_of(two, {"y": line()})
    assert likelihood.coordinates.names == ("t", "y_discrepancy")
    z = np.array([[0.0, 0.7]])
    law, s = next(likelihood.laws(z)), likelihood.coordinates.values(z)["y_discrepancy"][0]
    assert law.bias[0] == pytest.approx(np.full((2, 2), s**2))
    exact = stats.multivariate_normal(law.mean[0], law.covariance[0])
    assert law.log_density[0] == pytest.approx(exact.logpdf(VALUES[:2]), rel=1e-9)
