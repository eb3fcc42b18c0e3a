"""Functions drawn from a Gaussian process: their law is the process given its runs."""

import numpy as np
import pytest
from scipy.stats import qmc

from surrogate.regressors import paths
from surrogate.regressors.gaussian_process import GaussianProcess
from surrogate.regressors.likelihood import Posterior
from surrogate.regressors.matern import correlation
from surrogate.regressors.uncertain_lengths import plausible
from surrogate.space.distributions import distribution, uniform
from surrogate.space.space import Parameter, Space

NUMERIC = Space(tuple(Parameter(name, uniform(0, 1)) for name in "abcde"))
MIXED = Space(
    (
        Parameter("a", uniform(0, 1)),
        Parameter("cloth", levels=("p", "q", "r")),
        Parameter("t", distribution("normal", mean=0, std=1, range=(-2, 3))),
    )
)


def fitted(space=NUMERIC, n=40, **options):
    x = space.sample(n, seed=3)
    y = 5 + 3 * np.sin(2 * x[:, 0]) + x[:, 1] * x[:, 2] + (x[:, 1] == 0)
    return GaussianProcess(space=space, **options).fit(x, y), x, y


@pytest.mark.parametrize("space", [NUMERIC, MIXED], ids=["numeric", "mixed"])
@pytest.mark.parametrize("trend", ["constant", "linear"])
def test_mean_and_spread_are_those_of_the_process(space, trend):
    """Over 2000 paths, at 300 points: mean of the prediction, Student variance s^2 v / (v - 2).

    s is the standard deviation of the process, without the nugget of a new run.
    """
    process, *_ = fitted(space, trend=trend)
    new = space.sample(300, seed=8)
    mean, std = process.predict(new, return_std=True)
    drawn = paths.draw(process, 2000, 0).predict(new, slice(None))
    freedom = process.interval_freedom
    spread = np.sqrt((std**2 - process.nugget_ * process.variance_) * freedom / (freedom - 2))
    assert np.abs((drawn.mean(axis=1) - mean) / spread).max() < 5 / np.sqrt(2000)
    ratio = drawn.std(axis=1) / spread
    assert np.mean(ratio) == pytest.approx(1.0, abs=0.04)
    assert 0.8 < ratio.min() and ratio.max() < 1.15


def test_covariance_between_points_is_that_of_the_process():
    """Correlations of path values at ten pairs of points, against kriging's own formula."""
    process, x, _ = fitted(nugget=1e-4)
    new = NUMERIC.sample(10, seed=5)
    both = np.vstack([new, x])
    R = correlation(both, both, process.lengths_)
    K, k, kk = R[10:, 10:] + 1e-4 * np.eye(40), R[:10, 10:], R[:10, :10]
    one, inverse = np.ones((40, 1)), np.linalg.inv(K)
    rest = np.ones((10, 1)) - k @ inverse @ one
    covariance = kk - k @ inverse @ k.T + rest @ rest.T / (one.T @ inverse @ one)
    deviation = np.sqrt(np.diag(covariance))
    drawn = paths.draw(process, 4000, 1).predict(new, slice(None))
    np.testing.assert_allclose(
        np.corrcoef(drawn), covariance / np.outer(deviation, deviation), atol=0.09
    )


def test_paths_pass_through_noise_free_runs():
    process, x, y = fitted(nugget=1e-8)
    for draw in process.posterior_draws(5, seed=2):
        np.testing.assert_allclose(draw.predict(x), y, atol=2e-3 * np.sqrt(process.variance_))


def test_indices_of_a_path_against_sampling():
    """Exact indices of a drawn function against pick-freeze on 2^15 points."""
    process, *_ = fitted(MIXED)
    draw = process.posterior_draws(4, seed=1)[2]
    exact = draw.sobol_indices()
    u = qmc.Sobol(6, seed=0).random(2**15) * (1 - 1e-12)
    a, b = MIXED.quantile(u[:, :3]), MIXED.quantile(u[:, 3:])
    f_a, f_b = draw.predict(a), draw.predict(b)
    variance = np.r_[f_a, f_b].var()
    assert exact.variance == pytest.approx(variance, rel=4e-3)
    assert exact.mean == pytest.approx(f_a.mean(), rel=1e-3)
    for i in range(3):
        mixed = a.copy()
        mixed[:, i] = b[:, i]
        f_mixed = draw.predict(mixed)
        assert exact.total[i] == pytest.approx(
            ((f_a - f_mixed) ** 2).mean() / 2 / variance, abs=4e-3
        )
        assert exact.first_order[i] == pytest.approx(
            (f_b * (f_mixed - f_a)).mean() / variance, abs=5e-3
        )


def test_intervals_of_indices_shrink_with_runs_and_hold_the_truth():
    """f = x1 + x2^2 (S1 = 15/19): the spread over paths falls, the truth lies within 4 of it."""
    spreads = []
    for n in (8, 30):
        x = 2 * qmc.LatinHypercube(2, seed=1).random(n) - 1
        process = GaussianProcess().fit(x, x[:, 0] + x[:, 1] ** 2)
        first = [
            draw.sobol_indices().first_order[0] for draw in process.posterior_draws(60, seed=0)
        ]
        spreads.append(np.std(first))
        assert abs(process.sobol_indices().first_order[0] - 15 / 19) < 4 * spreads[-1] + 1e-3
    assert spreads[1] < spreads[0] / 3


def test_same_seed_same_paths():
    process, x, _ = fitted()
    first, again, other = (
        process.posterior_draws(3, seed=seed)[1].predict(x[:4] * 0.9) for seed in (1, 1, 2)
    )
    np.testing.assert_array_equal(first, again)
    assert (first != other).any()


def test_constant_output_has_constant_paths():
    x = NUMERIC.sample(10, seed=0)
    draw = GaussianProcess(space=NUMERIC).fit(x, np.full(10, 2.0)).posterior_draws(2, seed=0)[0]
    assert (draw.predict(x) == 2.0).all() and draw.sobol_indices().variance == 0.0


def test_lengths_are_drawn_from_the_curvature_of_the_posterior():
    """Laplace: the covariance of log lengths is 2 H^-1, here by differences of the values."""
    process, x, _ = fitted(n=60)
    logs, size = process.logs_.copy(), len(process.logs_)
    logs[-1] = np.log(1e-3)
    posterior = Posterior(process.points_, np.ones((60, 1)), process.standard_[:, None])

    def value(*moves):
        return posterior.at(logs + np.sum(moves, axis=0)).deviances[0]

    h = 0.01 * np.eye(size)
    hessian = [
        [(value(a, b) - value(a, -b) - value(-a, b) + value(-a, -b)) / 4e-4 for b in h] for a in h
    ]
    values, axes = np.linalg.eigh(hessian)
    covariance = axes @ np.diag(1.0 / np.maximum(values / 2.0, 1.5**-2)) @ axes.T
    wide = np.log([[1e-30, 1e30]] * size)
    drawn = plausible(posterior, logs, wide, 20_000, np.random.default_rng(0))
    deviation = np.sqrt(np.diag(covariance))
    np.testing.assert_allclose(
        np.cov(drawn.T) / np.outer(deviation, deviation),
        covariance / np.outer(deviation, deviation),
        atol=0.04,
    )


def test_draws_of_one_output_differ_in_lengths_and_are_found_together():
    process, x, _ = fitted()
    drawn = process.posterior_draws(25, seed=4)
    assert len({tuple(one.own.process.lengths_) for one in drawn}) == 10
    together = drawn[0].paths.predict(x[:5], slice(None))
    alone = np.column_stack([one.predict(x[:5]) for one in drawn])
    np.testing.assert_allclose(together, alone, rtol=1e-9)
