"""Gaussian processes of many runs beside the exact process of the same runs."""

import numpy as np
import pytest
from scipy.stats import qmc

from surrogate.errors import FitError
from surrogate.fitting.comparison import compare
from surrogate.fitting.fit import fit
from surrogate.regressors import gaussian_process
from surrogate.regressors.gaussian_process import GaussianProcess
from surrogate.regressors.nearest_runs import NearestRuns
from surrogate.space.distributions import uniform
from surrogate.space.space import Parameter, Space

SPACE = Space(tuple(Parameter(name, uniform(-1.0, 1.0)) for name in ("x1", "x2", "x3")))
LOGS = np.log([0.6, 0.9, 2.0, 1e-4])


def points(n, seed):
    return 2.0 * qmc.Sobol(3, seed=seed).random(1 << int(np.ceil(np.log2(n))))[:n] - 1.0


def answers(x):
    return np.sin(4.0 * x[:, 0]) * (1.0 + x[:, 1] ** 2) + np.exp(x[:, 2]) * x[:, 1]


@pytest.fixture(scope="module")
def exact():
    x = points(240, seed=1)
    return GaussianProcess(trend="linear").condition(x, answers(x), LOGS)


def divided(exact, core, nearest):
    """The process of the first `core` runs, and the others beside it."""
    x, standard = exact.points_, exact.standard_
    process = GaussianProcess(trend="linear").condition(x[:core], standard[:core], LOGS)
    # The same units as the process of all runs: its own would be those of the core.
    process.offset_, process.scale_, process.standard_ = 0.0, 1.0, standard[:core]
    process._set(LOGS, process.factors_)
    return NearestRuns.beside(process, x[core:], standard[core:], nearest)


def test_core_and_all_neighbours_are_the_exact_process(exact):
    """Conditioning on the core first and on all others then is conditioning on all runs."""
    new = points(64, seed=2)
    mean, std = exact.predict(new, return_std=True)
    found, variance = divided(exact, core=80, nearest=160).predict(new)
    np.testing.assert_allclose(exact.unscaled(found), mean, atol=2e-5)
    own = np.sqrt(exact.variance_ * variance)
    np.testing.assert_allclose(own, std, rtol=1e-4)


def test_the_error_vanishes_as_neighbours_become_all_runs(exact):
    new = points(64, seed=2)
    mean = exact.predict(new)
    errors = [
        np.abs(exact.unscaled(divided(exact, 80, nearest).predict(new)[0]) - mean).max()
        for nearest in (5, 40, 120, 160)
    ]
    assert errors == sorted(errors, reverse=True)
    assert errors[-1] < 1e-3 * errors[0]


@pytest.fixture(scope="module")
def many():
    """Fits with a threshold that 600 runs exceed, and the exact one."""
    with pytest.MonkeyPatch.context() as patch:
        x = points(600, seed=3)
        whole = fit(SPACE, x, answers(x), GaussianProcess(starts=1), surrogate="gp")
        patch.setattr(gaussian_process, "MANY", 500)
        patch.setattr(gaussian_process, "CORE", 200)
        parts = fit(SPACE, x, answers(x), GaussianProcess(starts=1), surrogate="gp")
    return whole, parts


def test_many_runs_predict_nearly_as_well_as_the_exact_process(many):
    whole, parts = many
    new = points(256, seed=4)
    errors = [
        np.sqrt(np.mean((one.predict(new) - answers(new)) ** 2)) / answers(new).std()
        for one in many
    ]
    assert errors[1] < 3.0 * errors[0] + 1e-12
    assert errors[1] < 1e-3
    low, high = parts.interval(new)
    assert np.mean((low <= answers(new)) & (answers(new) <= high)) > 0.9
    np.testing.assert_allclose(parts.left_out, whole.left_out, atol=0.02 * answers(new).std())
    indices = [one.estimator.sobol_indices().total for one in many]
    np.testing.assert_allclose(*indices, atol=2e-3)


def test_left_out_runs_of_many_do_not_know_themselves(many):
    """A run whose value is wrong does not move its own left-out prediction."""
    _, parts = many
    process = parts.estimator
    kept = process.many_.standard[7]
    process.many_.standard[7] += 100.0
    try:
        moved = process._left_out(process.folds_)[0]
    finally:
        process.many_.standard[7] = kept
    assert moved[7] == pytest.approx(process.left_out_[0][7], abs=1e-9)


def test_an_approximation_is_told_and_not_exported(many):
    whole, parts = many
    assert "approximate" not in str(compare({"gp": {"y": whole}})["sentence"].item())
    words = str(compare({"gp": {"y": parts}})["sentence"].item())
    assert "gp is approximate: lengths and indices come from 200 of the 600 runs" in words
    with pytest.raises(FitError, match="has no portable form"):
        parts.portable()
