"""Noise that depends on the place, learnt from replicates."""

import numpy as np
import pytest

from surrogate.errors import FitError
from surrogate.fitting.fit import fit
from surrogate.regressors.gaussian_process import GaussianProcess
from surrogate.regressors.log_noise import log_variances
from surrogate.regressors.matern import correlation
from surrogate.space.distributions import uniform
from surrogate.space.space import Parameter, Space

SPACE = Space((Parameter("x", uniform(-1, 1)),))


def std(x):
    """From 0.05 at the left end to 1 at the right one."""
    return 0.05 * 20.0 ** (0.5 * (x + 1.0))


def runs(points, times, spread=std, seed=0):
    r = np.random.default_rng(seed)
    x = np.repeat(np.linspace(-1, 1, points), times)
    return x[:, None], np.sin(3 * x) + spread(x) * r.normal(size=len(x))


@pytest.mark.parametrize("times", [2, 3, 10])
def test_log_variances_are_unbiased(times):
    """5000 points with variance 4: their mean is log 4 within four standard errors."""
    x = np.repeat(np.arange(5000.0), times)[:, None]
    y = 2.0 * np.random.default_rng(1).normal(size=len(x))
    points, logs = log_variances(x, y)
    assert len(points) == 5000
    assert logs.mean() == pytest.approx(np.log(4.0), abs=4.0 * logs.std() / np.sqrt(5000))


def test_the_standard_deviation_follows_the_place():
    """Of 30 points with 8 replicates, over 12 samples: right at both ends and in the middle."""
    at = np.array([-0.9, 0.0, 0.9])
    told = np.zeros(3)
    for seed in range(12):
        model = GaussianProcess(space=SPACE, noise="replicates").fit(*runs(30, 8, seed=seed))
        told += model.predict(at[:, None], return_std=True)[1] / 12
    assert told == pytest.approx(std(at), rel=0.1)


def test_intervals_cover_at_every_place():
    """95 % intervals in each third of the range: 0.91 to 0.98; with equal noise 1 and below 0.9."""
    inside = {"replicates": np.zeros(3), "equal": np.zeros(3)}
    for seed in range(12):
        x, y = runs(25, 4, seed=seed)
        new = np.random.default_rng(100 + seed).uniform(-1, 1, 600)
        truth = np.sin(3 * new) + std(new) * np.random.default_rng(200 + seed).normal(size=600)
        third = np.digitize(new, [-1 / 3, 1 / 3])
        for noise, found in inside.items():
            low, high = fit(SPACE, x, y, GaussianProcess(noise=noise)).interval(new[:, None])
            covered = (low <= truth) & (truth <= high)
            found += [covered[third == k].mean() / 12 for k in range(3)]
    assert (inside["replicates"] > 0.91).all() and (inside["replicates"] < 0.98).all()
    assert inside["equal"][0] > 0.995 and inside["equal"][2] < 0.9


def test_the_mean_is_nearer_than_with_equal_noise():
    """Over 12 samples the mean square error of the mean answer falls by a fifth and more."""
    at = np.linspace(-1, 1, 200)
    wrong = {"replicates": 0.0, "equal": 0.0}
    for seed in range(12):
        x, y = runs(25, 4, seed=seed)
        for noise in wrong:
            model = GaussianProcess(space=SPACE, noise=noise).fit(x, y)
            wrong[noise] += np.mean((model.predict(at[:, None]) - np.sin(3 * at)) ** 2)
    assert wrong["replicates"] < 0.8 * wrong["equal"]


def test_equal_noise_is_found_to_be_equal():
    """Noise of one size: the largest is at most 1.6 times the smallest in nine of ten samples."""
    at = np.linspace(-1, 1, 50)[:, None]
    ratios = []
    for seed in range(20):
        x, y = runs(25, 4, lambda x: 0.3, seed)
        found = GaussianProcess(space=SPACE, noise="replicates").fit(x, y).noise_at(at)
        ratios.append(np.sqrt(found.max() / found.min()))
    assert np.quantile(ratios, 0.9) < 1.6


def test_it_is_stochastic_kriging_of_the_means():
    """Ankenman, Nelson and Staum 2010, equation 9: means with the variances sigma_i^2 / n_i."""
    x, y = runs(12, 5)
    model = GaussianProcess(space=SPACE, noise="replicates").fit(x, y)
    points, means = x[::5], y.reshape(12, 5).mean(axis=1)
    R = correlation(points, points, model.lengths_)
    R += np.diag(model.nugget_ * model.noise_at(points) / 5)
    one = np.ones(12)
    trend = one @ np.linalg.solve(R, means) / (one @ np.linalg.solve(R, one))
    at = np.linspace(-1, 1, 7)[:, None]
    near = correlation(at, points, model.lengths_)
    expected = trend + near @ np.linalg.solve(R, means - trend)
    assert model.predict(at) == pytest.approx(expected, rel=1e-7)


def test_paths_scatter_as_the_noise_allows():
    """Draws of the mean answer lie within the deviations, and spread more where noise is large."""
    x, y = runs(25, 4)
    model = GaussianProcess(space=SPACE, noise="replicates").fit(x, y)
    at = np.array([[-0.9], [0.9]])
    drawn = np.array([draw.predict(at) for draw in model.posterior_draws(200, seed=1)])
    left, right = drawn.std(axis=0)
    assert 3.0 * left < right < model.predict(at, return_std=True)[1][1]


@pytest.mark.parametrize(
    ("x", "y", "told"),
    [
        (np.linspace(-1, 1, 20), np.arange(20.0), "at least 5 points that were run more than once"),
        (np.repeat(np.linspace(-1, 1, 6), 2), np.repeat(np.arange(6.0), 2), "finds no noise"),
    ],
)
def test_runs_that_show_no_noise_are_refused(x, y, told):
    with pytest.raises(FitError, match=told):
        fit(SPACE, x[:, None], y, GaussianProcess(noise="replicates"))


def test_unknown_words_fields_and_exports_are_refused():
    x, y = runs(12, 3)
    with pytest.raises(FitError, match="noise 'replicate': .*replicates"):
        fit(SPACE, x, y, GaussianProcess(noise="replicate"))
    with pytest.raises(FitError, match="noise: replicates is for single numbers"):
        fit(SPACE, x, np.outer(y, [1.0, 2.0, 3.0]), GaussianProcess(noise="replicates"))
    with pytest.raises(FitError, match="has no portable form"):
        fit(SPACE, x, y, GaussianProcess(noise="replicates")).portable()
