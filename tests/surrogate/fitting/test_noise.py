"""Noise: its share of the variance, what is said of it, and Q2 of the mean answer."""

import numpy as np
import pytest

from surrogate.fitting.fit import fit, q2
from surrogate.fitting.noise import noise, q2_of_mean
from surrogate.fitting.replicates import replicates
from surrogate.regressors.gaussian_process import GaussianProcess
from surrogate.regressors.polynomial import Quadratic
from surrogate.space.distributions import uniform
from surrogate.space.space import Parameter, Space

SPACE = Space(tuple(Parameter(name, uniform(-1, 1)) for name in "ab"))


def mean(x):
    """Of variance 1/3 + 4/45 = 0.42 on the square."""
    return x[:, 0] + x[:, 1] ** 2


def runs(points, times, std, seed=0):
    r = np.random.default_rng(seed)
    x = np.repeat(r.uniform(-1, 1, (points, 2)), times, axis=0)
    return x, mean(x) + std * r.normal(size=len(x))


@pytest.mark.parametrize(("points", "times"), [(150, 1), (40, 4)])
def test_as_much_noise_as_signal_is_half_of_the_variance(points, times):
    """Variance of the mean 0.42 and of the noise 0.42; without replicates by the nugget."""
    x, y = runs(points, times, np.sqrt(0.42))
    own = fit(SPACE, x, y, GaussianProcess(), surrogate="gp", output="y")
    found = noise("y", "mm", [own], replicates(x, y))
    assert found.share == pytest.approx(0.5, abs=0.1)
    assert found.std == pytest.approx(np.sqrt(0.42), rel=0.12)
    assert (found.points, found.surrogate) == ((points, "") if times > 1 else (0, "gp"))
    assert f"standard deviation {found.std:.3g} mm" in found.sentence
    assert "replicates" in found.sentence


def test_little_noise_is_no_matter():
    x, y = runs(60, 1, 0.1)
    assert noise("y", "", [fit(SPACE, x, y, GaussianProcess())], None) is None
    x, y = runs(20, 3, 0.1)
    assert noise("y", "", [fit(SPACE, x, y, Quadratic())], replicates(x, y)) is None


def test_more_noise_than_signal_is_seen_as_such():
    """Ten times the variance of the mean: a nugget far above the process variance."""
    x, y = runs(300, 1, np.sqrt(4.2))
    found = noise("y", "", [fit(SPACE, x, y, GaussianProcess())], None)
    assert found.share == pytest.approx(10 / 11, abs=0.06)


def test_q2_of_the_mean_is_that_of_answers_without_noise():
    """Over 30 samples: near the Q2 of the mean on 2000 points, and rarely above it by much."""
    test = np.random.default_rng(9).uniform(-1, 1, (2000, 2))
    told, true = [], []
    for seed in range(30):
        x, y = runs(40, 4, np.sqrt(0.42), seed)
        own = fit(SPACE, x, y, Quadratic())
        told.append(q2_of_mean(own))
        true.append(q2(mean(test), own.predict(test)))
    assert np.mean(true) > 0.9
    assert np.mean(true) - 0.25 < np.mean(told) < np.mean(true)
    assert np.mean(np.array(told) > np.array(true)) <= 0.2


def test_runs_without_replicates_have_no_q2_of_the_mean():
    x, y = runs(40, 1, 0.3)
    assert q2_of_mean(fit(SPACE, x, y, Quadratic())) is None
    again = np.repeat(x, 2, axis=0)  # a deterministic solver
    assert q2_of_mean(fit(SPACE, again, mean(again), Quadratic())) is None
