"""Posterior draws of a Gaussian process against its own mean and standard deviation."""

import numpy as np
import pytest

from surrogate.distributions import uniform
from surrogate.regressors.gaussian_process import GaussianProcess
from surrogate.sensitivity import posterior
from surrogate.space import Parameter, Space

SPACE = Space((Parameter("x", uniform(-1.0, 1.0)), Parameter("y", uniform(-1.0, 1.0))))


@pytest.mark.parametrize("trend", ["constant", "linear"])
def test_draws_have_the_mean_and_spread_of_the_process(trend):
    """Mean and standard deviation of 2000 draws at 50 new points (kriging equations).

    The variance of Student's t with nu degrees of freedom is nu / (nu - 2) times its scale's;
    the nugget belongs to runs and not to the function.
    """
    coded = SPACE.sample(12, seed=1)
    process = GaussianProcess(trend=trend, nugget=1e-8, space=SPACE).fit(
        coded, np.sin(4.0 * coded[:, 0]) + coded[:, 0] * coded[:, 1])
    points = SPACE.sample(50, seed=2)
    mean, std = process.predict(points, return_std=True)
    drawn = posterior.draws(process, 2000, seed=3)(points)
    freedom = process.interval_freedom
    function_std = np.sqrt(std**2 - process.variance_ * process.nugget_)
    expected = function_std * np.sqrt(freedom / (freedom - 2.0))
    assert np.abs((drawn.mean(axis=1) - mean) / expected).max() < 0.12
    ratio = drawn.std(axis=1) / expected
    assert 0.97 < ratio.mean() < 1.03 and ratio.min() > 0.9


def test_draws_pass_through_the_runs_of_an_interpolating_process():
    """A draw leaves a run by no more than its nugget: 5 standard deviations at most."""
    coded = SPACE.sample(15, seed=4)
    values = np.exp(coded[:, 0]) * coded[:, 1]
    process = GaussianProcess(nugget=1e-9, space=SPACE).fit(coded, values)
    drawn = posterior.draws(process, 50, seed=5)(coded)
    allowed = 5.0 * np.sqrt(process.variance_ * process.nugget_)
    assert allowed < 0.002 * values.std()
    np.testing.assert_allclose(drawn, np.tile(values[:, None], 50), rtol=0.0, atol=allowed)


def test_same_seed_same_draws():
    """And another seed gives other ones."""
    coded = SPACE.sample(10, seed=6)
    process = GaussianProcess(space=SPACE).fit(coded, coded[:, 0] ** 3)
    one, same, other = (posterior.draws(process, 5, seed=s)(coded + 0.01) for s in (7, 7, 8))
    np.testing.assert_array_equal(one, same)
    assert not np.array_equal(one, other)
