"""Learning curves against theory: laws that are known, and least squares with terms left out."""

import numpy as np
import pytest

from surrogate.errors import FitError
from surrogate.fitting.bent_line import Prior, bent_line
from surrogate.fitting.fit import fit
from surrogate.fitting.forecast import Goal, crossing, forecast
from surrogate.fitting.learning import Curve, learn
from surrogate.fitting.power_law import PowerLaw, power_law
from surrogate.regressors.gaussian_process import GaussianProcess
from surrogate.regressors.polynomial import Linear, Quadratic
from surrogate.space.distributions import uniform
from surrogate.space.space import Parameter, Space

RUNS = np.array([10, 14, 20, 28, 40, 57, 80])


def scattered(errors, scatter=0.1, subsets=40, seed=0):
    noise = np.random.default_rng(seed).normal(0.0, scatter, (subsets, len(errors)))
    return errors * np.exp(noise)


def space(size):
    return Space(tuple(Parameter(f"x{k}", uniform(-1, 1)) for k in range(size)))


def curve_of(errors, **more):
    nothing = np.full_like(errors, np.nan)
    return Curve("gp", "y", RUNS, 1.0 - errors**2, errors, nothing, "the test design", 80, **more)


def test_a_power_law_is_found_again():
    law = power_law(RUNS, scattered(3.0 * RUNS**-1.5), 80)
    assert law.falls
    assert law.exponent == pytest.approx(1.5, abs=0.1)
    value, low, high = law.at(160)
    assert value == pytest.approx(3.0 * 160**-1.5, rel=0.1)
    assert low < 3.0 * 160**-1.5 < high
    needed, low, high = law.needed(3.0 * 160**-1.5)
    assert needed == pytest.approx(160, rel=0.1)
    assert low < 160 < high


def test_a_law_that_bends_is_found_again_and_goes_on_straight():
    """log error = -x - 0.4 x^2 up to twice the runs, then a line with the slope that it has there.

    Another prior than what is found would shift it; the interval has to hold the truth.
    """
    x = np.log(RUNS / 80)
    law = power_law(RUNS, scattered(np.exp(-x - 0.4 * x**2), 0.02), 80)
    assert law.falls and law.bend == pytest.approx(0.4, abs=0.1)
    twice = np.exp(-np.log(2.0) - 0.4 * np.log(2.0) ** 2)
    value, low, high = law.at(160)
    assert low < twice < high and value == pytest.approx(twice, rel=0.1)
    assert law.at(640)[0] / law.at(320)[0] == pytest.approx(law.at(320)[0] / law.at(160)[0])


@pytest.mark.parametrize("row", [(0.0, 1.5, 0.3, 0.0), (0.0, 1.0, -0.3, 0.0), (0.1, 0.9, 0.0, 0.2)])
@pytest.mark.parametrize("runs", [60.0, 120.0, 150.0, 500.0])
def test_runs_and_error_of_a_law_are_inverse(row, runs):
    law = PowerLaw(np.array(row), np.array([row]), 80)
    assert law.needed(law.at(runs)[0])[0] == pytest.approx(runs, rel=1e-9)


def test_a_law_that_would_turn_up_levels_out():
    """b x + q x^2 with b = 0.4, q = -0.5 is largest at x = 0.4."""
    row = np.array([0.0, 0.4, -0.5, 0.0])
    law = PowerLaw(row, row[None], 80)
    assert law.at(1000)[0] == pytest.approx(np.exp(-0.08))
    assert law.needed(0.93)[0] == pytest.approx(80 * np.exp(0.4 - np.sqrt(0.16 + 2 * np.log(0.93))))
    assert law.needed(0.9)[0] == np.inf


def test_a_prior_yields_to_exact_conjugate_theory():
    """With t known the posterior of a normal mean is the precision-weighted mean."""
    y, spread = np.array([1.0, 2.0, 4.0]), 1e4 * np.eye(3)  # t is nothing beside it
    x = np.array([[-1.0], [0.0], [1.0]])
    rng = np.random.default_rng(0)
    mean, draws = bent_line(x, y, spread, Prior((0.5,), (2.0,)), 20_000, rng)
    slope = (0.5 / 2.0**2 + (x[:, 0] @ y) / 1e4) / (1.0 / 2.0**2 + 2.0 / 1e4)
    assert mean[1] == pytest.approx(slope, rel=1e-3)
    assert draws[:, 1].std() == pytest.approx((1.0 / 2.0**2 + 2.0 / 1e4) ** -0.5, rel=0.02)


def test_a_floor_is_found_again():
    law = power_law(RUNS, scattered(50.0 * RUNS**-2.0 + 0.2, 0.02), 80)
    assert law.floor == pytest.approx(0.2, rel=0.03)
    assert law.needed(0.15) == (np.inf, np.inf, np.inf)
    assert law.needed(0.2035)[0] == pytest.approx((50 / 0.0035) ** 0.5, rel=0.3)


def test_least_squares_with_terms_left_out_follow_breiman_and_freedman():
    """Normal x, e left out, p slopes and a constant: error^2 = s^2 (n - 1) / (n - 2 - p)."""
    r, p, repeats = np.random.default_rng(1), 10, 400
    sizes, test = np.array([16, 24, 40, 80]), r.normal(size=(2000, p))
    found = []
    for n in sizes:
        squares = []
        for _ in range(repeats):
            X, e = r.normal(size=(n, p)), r.normal(size=n)
            b = np.linalg.lstsq(X - X.mean(0), e - e.mean(), rcond=None)[0]
            squares.append(1.0 + (((test - X.mean(0)) @ b + e.mean()) ** 2).mean())
        found.append(np.mean(squares) ** 0.5)
    law = power_law(sizes, np.tile(found, (20, 1)), 80, terms=p + 1)
    assert law.exponent == pytest.approx(1.0, abs=0.1)
    assert law.at(10**9)[0] == pytest.approx(1.0, abs=0.03)
    assert law.needed(0.9)[0] == np.inf


def test_a_curve_that_does_not_fall_is_not_extrapolated():
    found = forecast(curve_of(scattered(np.full(7, 0.5))), 1.0, "mm", Goal("rmse", 0.1))
    assert not found.reached and not found.ahead and np.isnan(found.runs[0])
    assert "does not surely fall" in found.sentences[0]
    assert "does not fall towards it" in found.sentences[1]


def test_no_forecast_goes_beyond_eight_times_the_runs():
    errors = scattered(3.0 * RUNS**-1.0)
    near, far = (forecast(curve_of(errors), 1.0, "mm", Goal("rmse", 3.0 / n)) for n in (500, 1000))
    assert near.runs[0] == pytest.approx(500, rel=0.15)
    assert far.runs[0] == np.inf
    assert "more than 640 runs, 8 times those there are" in far.sentences[1]


def test_a_goal_of_q2_is_one_of_rmse():
    """Q2 = 1 - RMSE^2 / variance."""
    errors = scattered(3.0 * RUNS**-1.0)
    by_q2 = forecast(curve_of(errors), 4.0, "", Goal("q2", 0.9999))
    by_rmse = forecast(curve_of(errors), 4.0, "", Goal("rmse", 0.02))
    assert by_q2.runs == pytest.approx(by_rmse.runs)
    value, low, high = by_q2.q2
    assert low < value < high < 1.0


def test_a_goal_that_is_reached_says_where():
    found = forecast(curve_of(scattered(3.0 / RUNS, 0.01)), 1.0, "mm", Goal("rmse", 3.0 / 35))
    assert found.reached
    assert found.runs[0] == pytest.approx(35, rel=0.03)
    assert crossing(RUNS, 3.0 / RUNS, 3.0 / 35) == pytest.approx(35)
    assert np.isnan(crossing(RUNS, 3.0 / RUNS, 3.0 / 81))


def test_an_exact_surrogate_and_one_that_cannot_be_fitted():
    exact = forecast(curve_of(np.full((5, 7), 1e-15)), 1.0, "mm", Goal("rmse", 0.1))
    assert exact.sentences == ("gp is exact to rounding from 10 runs on",)
    lost = forecast(curve_of(np.full((5, 7), np.nan)), 1.0, "mm", Goal("rmse", 0.1))
    assert lost.sentences == ("no forecast: fewer than three sizes could be fitted",)


def product(coded):
    return np.exp(coded[:, 0]) * (1.0 + coded[:, 1] ** 2) + coded[:, 2]


@pytest.fixture(scope="module")
def learnt():
    r = np.random.default_rng(0)
    coded, test = r.uniform(-1, 1, (40, 3)), r.uniform(-1, 1, (200, 3))
    estimator = GaussianProcess()
    whole = fit(space(3), coded, product(coded), estimator, surrogate="gp", output="y")
    return whole, learn(whole, estimator, (test, product(test)), subsets=8), (test, product(test))


def test_a_curve_ends_at_the_error_of_all_runs(learnt):
    whole, curve, (test, truth) = learnt
    assert curve.runs.tolist() == [5, 7, 10, 14, 20, 28, 40]
    assert np.isfinite(curve.rmse[:, :-1]).all()
    assert np.isfinite(curve.rmse[:, -1]).tolist() == [True] + 7 * [False]
    error = np.sqrt(np.mean((whole.predict(test) - truth) ** 2))
    assert curve.rmse[0, -1] == pytest.approx(error, rel=0.05)
    assert (np.diff(np.nanmedian(curve.rmse, axis=0)) < 0.0).all()


def test_the_same_seed_gives_the_same_curve(learnt):
    whole, curve, test = learnt
    again = learn(whole, GaussianProcess(), test, subsets=8)
    np.testing.assert_array_equal(again.rmse, curve.rmse)


def test_without_a_test_design_the_runs_left_out_judge():
    r = np.random.default_rng(0)
    coded = np.repeat(r.uniform(-1, 1, (20, 2)), 3, axis=0)
    values = coded[:, 0] + r.normal(0.0, 0.1, 60)
    whole = fit(space(2), coded, values, Linear())
    curve = learn(whole, Linear(), subsets=200)
    assert curve.judged == "the runs left out"
    assert curve.runs.max() == 48  # 0.8 of 20 points, three replicates each
    assert curve.terms == 3
    # noise 0.1, and the variance of the mean at a new point of 16 points with 3 replicates
    assert np.nanmedian(curve.rmse[:, -1]) == pytest.approx(0.1, rel=0.12)


def test_too_few_runs_are_told():
    coded = np.random.default_rng(0).uniform(-1, 1, (11, 3))
    whole = fit(space(3), coded, coded[:, 0], Quadratic())
    with pytest.raises(FitError, match="11 training points are too few .* needs 10"):
        learn(whole, Quadratic())
