"""Replicates: pure error, scatter that depends on the place, folds that keep them together."""

import numpy as np
import pytest
from scipy import stats

from surrogate.fitting.fit import fit
from surrogate.fitting.replicates import replicates
from surrogate.regressors.folds import folds, point_folds
from surrogate.regressors.gaussian_process import GaussianProcess
from surrogate.regressors.polynomial import Linear
from surrogate.space.distributions import uniform
from surrogate.space.space import Parameter, Space

SPACE = Space((Parameter("x", uniform(-1, 1)),))


def test_pure_error_of_a_published_table():
    """Montgomery, Peck and Vining 2012, example 4.8: SS_PE = 15.563 on 7 degrees of freedom."""
    x = [1, 1, 2, 3.3, 3.3, 4, 4, 4, 4.7, 5, 5.6, 5.6, 5.6, 6, 6, 6.5, 6.9]
    y = [10.84, 9.3, 16.35, 22.88, 24.35, 24.56, 25.86, 29.16, 24.59, 22.25, 25.9, 27.2, 25.61]
    y += [25.45, 26.56, 21.03, 21.46]
    found = replicates(np.array(x)[:, None], np.array(y))
    assert found.freedom == 7
    assert found.std**2 * found.freedom == pytest.approx(15.563, abs=5e-4)


def test_brown_forsythe_is_that_of_scipy_and_keeps_its_level():
    r = np.random.default_rng(1)
    x = np.repeat(np.linspace(-1, 1, 6), 8)[:, None]
    noise = r.normal(size=48)
    wild = replicates(x, noise * np.exp(2.5 * x[:, 0]))
    assert wild.uneven and wild.largest > 5 * wild.smallest
    groups = (noise * np.exp(2.5 * x[:, 0])).reshape(6, 8)
    assert wild.p == pytest.approx(stats.levene(*groups, center="median").pvalue, rel=1e-12)
    found = [replicates(x, r.normal(size=48)).uneven for _ in range(300)]
    assert np.mean(found) < 0.03


def test_equal_answers_are_no_scatter():
    x = np.array([0.0, 0.0, 1.0])[:, None]
    assert replicates(x, np.array([2.0, 2.0, 3.0])) is None
    assert replicates(x[1:], np.array([2.0, 3.0])) is None


def test_replicates_share_a_fold():
    x = np.repeat(np.linspace(-1, 1, 30), 3)[:, None]
    found = point_folds(x)
    assert (found.reshape(30, 3) == found[::3, None]).all() and len(set(found)) == 10
    unique = np.random.default_rng(0).random((40, 2))
    assert (point_folds(unique) == folds(40)).all()


@pytest.mark.parametrize("estimator", [Linear(), GaussianProcess()], ids=["linear", "gp"])
def test_cross_validation_is_not_flattered_by_replicates(estimator):
    """Up and down from point to point: no model predicts it, however often each was run."""
    r = np.random.default_rng(5)
    levels = np.tile([1.0, -1.0], 4)
    x, y = np.repeat(np.linspace(-1, 1, 8), 4)[:, None], np.repeat(levels, 4)
    found = fit(SPACE, x, y + 0.01 * r.normal(size=32), estimator)
    assert found.q2 < 0.0


def test_the_nugget_is_the_scatter_of_the_replicates():
    """Of 20 points with 5 replicates, whose scatter has standard deviation 0.2."""
    r = np.random.default_rng(2)
    x = np.repeat(np.linspace(-1, 1, 20), 5)[:, None]
    y = np.sin(3 * x[:, 0]) + 0.2 * r.normal(size=100)
    model = GaussianProcess(space=SPACE).fit(x, y)
    noise = np.sqrt(model.nugget_ * model.variance_)
    assert noise == pytest.approx(replicates(x, y).std, rel=0.1)
