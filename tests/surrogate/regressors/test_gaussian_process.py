"""Gaussian process: against scikit-learn's algebra, brute-force refits, theory of kriging."""

import pickle

import numpy as np
import pytest
from scipy import integrate, stats
from scipy.stats import qmc
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import ConstantKernel, Matern, WhiteKernel
from sklearn.utils.estimator_checks import check_estimator

from surrogate.regressors import gaussian_process, matern
from surrogate.regressors.gaussian_process import GaussianProcess
from surrogate.regressors.likelihood import Posterior
from surrogate.space.distributions import distribution, uniform
from surrogate.space.space import Parameter, Space

NUMERIC = Space(tuple(Parameter(name, uniform(0, 1)) for name in ("a", "b", "c")))


def smooth(x):
    return 10 + 3 * np.sin(2 * x[:, 0]) + x[:, 1] * (x[:, 0] + 0.5 * x[:, -1] ** 2)


def design(n=40, d=3, seed=0):
    return 2 * qmc.LatinHypercube(d, seed=seed).random(n) - 1


def test_one_dimensional_correlation_is_scikit_learns():
    """In one column the product form is the Matern 5/2 kernel."""
    a, b = design(9, 1), design(7, 1, seed=1)
    np.testing.assert_allclose(
        matern.correlation(a, b, np.array([0.7])), Matern(0.7, nu=2.5)(a, b), rtol=1e-13
    )


@pytest.mark.parametrize("trend", [1, 4])
def test_gradient_of_the_posterior(trend):
    """Analytic gradient against central differences."""
    x = design()
    posterior = Posterior(x, np.column_stack([np.ones(40), x])[:, :trend], smooth(x)[:, None])
    at = np.log([1.0, 2.0, 0.7, 1e-3])
    steps = 1e-5 * np.eye(4)
    numeric = [
        (posterior.at(at + h).deviances - posterior.at(at - h).deviances) / 2e-5 for h in steps
    ]
    np.testing.assert_allclose(posterior.at(at).gradient(0), np.ravel(numeric), rtol=1e-6)


def test_prediction_in_one_dimension_equals_scikit_learn():
    """Same kernel and known mean: a trend fixed by 1e6 prior variance is universal kriging.

    A constant with prior variance v is the kernel v + s^2 m(r); v -> infinity gives the flat
    prior on the trend (Rasmussen and Williams 2006, section 2.7).
    """
    x = design(15, 1)
    y = np.sin(3 * x[:, 0])
    ours = GaussianProcess(nugget=1e-4).fit(x, y)
    variance = ours.variance_ / ours.scale_**2
    kernel = (
        ConstantKernel(1e5, "fixed")
        + ConstantKernel(variance, "fixed") * Matern(ours.lengths_[0], "fixed", nu=2.5)
        + WhiteKernel(variance * 1e-4, "fixed")
    )
    theirs = GaussianProcessRegressor(kernel, optimizer=None, normalize_y=True).fit(x, y)
    new = design(50, 1, seed=3)
    mean, std = ours.predict(new, return_std=True)
    their_mean, their_std = theirs.predict(new, return_std=True)
    np.testing.assert_allclose(mean, their_mean, atol=1e-6)
    np.testing.assert_allclose(std, their_std, rtol=1e-4)


def test_residuals_are_the_nugget_times_the_weights():
    """y - mean = eta R^-1 (y - F b): so a nugget of 1e-9 interpolates, to 1e-5 of the range."""
    x = design()
    y = smooth(x)
    for nugget in (1e-9, 1e-2):
        fitted = GaussianProcess(nugget=nugget).fit(x, y)
        mean, std = fitted.predict(x, return_std=True)
        expected = nugget * fitted.scale_ * fitted.weights_
        np.testing.assert_allclose(y - mean, expected, atol=1e-7)
    fitted = GaussianProcess(nugget=1e-9).fit(x, y)
    mean, std = fitted.predict(x, return_std=True)
    assert np.abs(y - mean).max() < 1e-5 * np.ptp(y)
    assert std.max() < 1e-4 * np.sqrt(fitted.variance_)


@pytest.mark.parametrize("trend", ["constant", "linear"])
@pytest.mark.parametrize("groups", [40, 8])
def test_closed_form_leave_out_equals_refits_with_the_same_lengths(trend, groups):
    """Dubrule 1983, blocks included: conditioning anew without the fold gives the same."""
    x = design()
    y = smooth(x)
    fitted = GaussianProcess(trend=trend, nugget=1e-3).fit(x, y)
    folds = np.arange(40) % groups
    expected, spread = np.empty((2, 40))
    for fold in range(groups):
        other = GaussianProcess(trend=trend, nugget=1e-3)
        other.columns_, other.points_ = fitted.columns_, fitted.points_[folds != fold]
        other.offset_, other.scale_ = fitted.offset_, fitted.scale_
        other.log_noise_, other.noise_ = None, fitted.noise_[folds != fold]
        other.standard_, other.n_features_in_ = fitted.standard_[folds != fold], 3
        other._set(fitted.logs_, other._factored(fitted.logs_))
        mean, std = other.predict(x[folds == fold], return_std=True)
        expected[folds == fold] = mean
        spread[folds == fold] = std * np.sqrt(fitted.variance_ / other.variance_)
    mean, std = fitted._closed(folds)
    np.testing.assert_allclose(fitted.unscaled(mean), expected, atol=1e-8)
    np.testing.assert_allclose(fitted.scale_ * std, spread, rtol=1e-8)
    if groups == 40:
        np.testing.assert_allclose(fitted.leave_one_out(), expected, atol=1e-8)


def test_leave_out_estimates_lengths_anew():
    """Small designs: the left-out prediction is that of a process that never saw the fold."""
    x = design(20)
    fitted = GaussianProcess().fit(x, smooth(x))
    changed = smooth(x)
    changed[3] += 100.0
    other = GaussianProcess(**fitted.get_params()).fit(x, changed)
    start = fitted.logs_
    other.logs_ = start
    left_out = other.unscaled(other._left_out(np.arange(20))[0])
    assert left_out[3] == pytest.approx(fitted.leave_out(np.arange(20))[3], abs=1e-3)


def test_linear_trend_meets_a_plane_exactly():
    """Universal kriging reproduces its trend (unbiasedness), also far outside the runs."""
    x = design(12)
    y = 2 + x @ [1.0, -3.0, 0.5]
    fitted = GaussianProcess(trend="linear").fit(x, y)
    far = 5 * design(10, seed=4)
    np.testing.assert_allclose(fitted.predict(far), 2 + far @ [1.0, -3.0, 0.5], atol=1e-8)


def test_nugget_finds_the_noise():
    """200 runs with noise of standard deviation 0.3: the estimate is within a fifth."""
    x = design(200)
    noise = 0.3 * np.random.default_rng(1).normal(size=200)
    fitted = GaussianProcess().fit(x, smooth(x) + noise)
    assert np.sqrt(fitted.nugget_ * fitted.variance_) == pytest.approx(0.3, rel=0.2)


def test_noise_free_runs_have_no_nugget():
    x = design(100)
    assert GaussianProcess().fit(x, smooth(x)).nugget_ < 1e-6


def test_intervals_cover_paths_of_the_process_itself():
    """t intervals with n - 1 degrees of freedom cover 95 % of paths of the assumed process."""
    inside = []
    for seed in range(60):
        x = design(40, 2, seed)
        K = matern.correlation(x, x, np.array([0.8, 1.5])) + 1e-8 * np.eye(40)
        y = np.linalg.cholesky(K) @ np.random.default_rng(seed).normal(size=40)
        fitted = GaussianProcess().fit(x[:30], y[:30])
        mean, std = fitted.predict(x[30:], return_std=True)
        inside.append(np.abs(y[30:] - mean) < stats.t.ppf(0.975, fitted.interval_freedom) * std)
    assert np.mean(inside) == pytest.approx(0.95, abs=0.035)


@pytest.mark.parametrize(
    "space",
    [
        NUMERIC,
        Space(
            (
                NUMERIC.parameters[0],
                Parameter("cloth", levels=("p", "q", "r")),
                Parameter("t", distribution("normal", mean=0, std=1, range=(-2, 3))),
            )
        ),
    ],
    ids=["uniform", "mixed"],
)
@pytest.mark.parametrize("trend", ["constant", "linear"])
def test_indices_against_sampling(space, trend):
    """Exact indices of the mean against a pick-freeze estimate on 2^17 Sobol' points."""
    x = space.sample(60, seed=3)
    y = smooth(x) + (x[:, 1] == 0)
    fitted = GaussianProcess(trend=trend, space=space).fit(x, y)
    exact = fitted.sobol_indices()
    u = qmc.Sobol(6, seed=0).random(2**15)
    a, b = space.quantile(u[:, :3] * (1 - 1e-12)), space.quantile(u[:, 3:] * (1 - 1e-12))
    f_a, f_b = fitted.predict(a), fitted.predict(b)
    mean, variance = np.r_[f_a, f_b].mean(), np.r_[f_a, f_b].var()
    assert exact.mean == pytest.approx(mean, rel=1e-3)
    assert exact.variance == pytest.approx(variance, rel=3e-3)
    for i in range(3):
        mixed = a.copy()
        mixed[:, i] = b[:, i]
        f_mixed = fitted.predict(mixed)
        first = (f_b * (f_mixed - f_a)).mean() / variance
        total = ((f_a - f_mixed) ** 2).mean() / 2 / variance
        assert exact.first_order[i] == pytest.approx(first, abs=4e-3)
        assert exact.total[i] == pytest.approx(total, abs=4e-3)
    assert exact.second_order[0, 1] == exact.second_order[1, 0] >= 0


def test_indices_in_two_dimensions_against_adaptive_quadrature():
    """Var E[f | x_1] and Var f by nested adaptive quadrature of predictions, to 1e-7."""
    x = design(12, 2)
    fitted = GaussianProcess(nugget=1e-3).fit(x, smooth(x))
    exact = fitted.sobol_indices()
    nodes, weights = np.polynomial.legendre.leggauss(200)
    grid = np.stack(np.meshgrid(nodes, nodes, indexing="ij"), -1).reshape(-1, 2)
    f = fitted.predict(grid).reshape(200, 200)
    w = weights / 2
    mean = w @ f @ w
    variance = w @ (f - mean) ** 2 @ w
    assert exact.variance == pytest.approx(variance, rel=1e-8)
    assert exact.first_order[0] == pytest.approx(w @ (f @ w - mean) ** 2 / variance, rel=1e-8)
    assert exact.first_order[1] == pytest.approx(w @ (w @ f - mean) ** 2 / variance, rel=1e-8)
    assert exact.total[0] == pytest.approx(1 - exact.first_order[1], rel=1e-8)
    conditional = [
        integrate.quad(
            lambda t, s=s: fitted.predict([[s, t]])[0] / 2, -1, 1, points=sorted(x[:, 1]), limit=200
        )[0]
        for s in nodes[::50]
    ]
    np.testing.assert_allclose(f[::50] @ w, conditional, rtol=1e-9)


def test_constant_output():
    x = design(8)
    fitted = GaussianProcess().fit(x, np.full(8, 3.25))
    mean, std = fitted.predict(x, return_std=True)
    assert (mean == 3.25).all() and (std == 0).all()
    assert (fitted.leave_out(np.arange(8)) == 3.25).all()
    assert fitted.sobol_indices().variance == 0.0


@pytest.mark.parametrize("n", [5, 6, 9])
def test_few_runs(n):
    """Five runs in three parameters give finite, sensible predictions."""
    x = design(n)
    fitted = GaussianProcess().fit(x, smooth(x))
    mean, std = fitted.predict(design(100, seed=8), return_std=True)
    assert np.isfinite(mean).all() and (std > 0).all()
    assert smooth(x).min() - 5 < mean.min() and mean.max() < smooth(x).max() + 5


def test_repeated_points():
    x = np.repeat(design(10), 2, axis=0)
    y = smooth(x) + np.tile([0.1, -0.1], 10)
    fitted = GaussianProcess().fit(x, y)
    assert np.isfinite(fitted.predict(x)).all()
    assert np.isfinite(GaussianProcess(nugget=1e-9).fit(x, y).predict(x)).all()


def test_same_seed_same_numbers():
    x = design()
    first, second = (GaussianProcess(seed=4).fit(x, smooth(x)).predict(x) for _ in range(2))
    np.testing.assert_array_equal(first, second)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"trend": "lineer"}, "did you mean 'linear'"),
        ({"nugget": -1.0}, "above 0"),
        ({"trend": "linear"}, "cannot determine a linear trend"),
    ],
)
def test_bad_options(options, message):
    x = design(4)
    with pytest.raises(ValueError, match=message):
        GaussianProcess(**options).fit(x, smooth(x))


def test_scikit_learn_contract():
    """scikit-learn's own conformance suite."""
    check_estimator(GaussianProcess(starts=1), on_skip=None)


def deviance(model):
    posterior = Posterior(
        model.points_, model.trend_columns(model.points_), model.standard_[:, None]
    )
    return posterior.at(model.logs_).deviances[0]


def test_outputs_fitted_together_are_as_probable_as_those_fitted_alone():
    """What the searches share costs nothing: -2 log posterior is within 0.1 or smaller."""
    x = design(60)
    outputs = [10 * smooth(x), 5 * np.sin(5 * x[:, 1]), np.sin(2 * x[:, 0]) + x[:, 1] ** 2]
    together = GaussianProcess().fit_many(x, np.column_stack(outputs))
    alone = [GaussianProcess().fit(x, y) for y in outputs]
    lost = [deviance(one) - deviance(other) for one, other in zip(together, alone, strict=True)]
    assert max(lost) < 0.1
    new = design(50, seed=3)
    np.testing.assert_allclose(
        together[0].predict(new), alone[0].predict(new), atol=1e-3 * outputs[0].std()
    )


def test_an_output_beyond_the_leading_ones_takes_a_neighbours_lengths(monkeypatch):
    """The third output is the second one scaled, so its best place is known without a search."""
    monkeypatch.setattr(gaussian_process, "LEADING", (0.98, 2))
    x = design(60)
    wave = np.sin(5 * x[:, 1])
    models = GaussianProcess().fit_many(x, np.column_stack([smooth(x), wave, 0.01 * wave]))
    np.testing.assert_allclose(models[2].lengths_, models[1].lengths_, rtol=1e-6)


def test_outputs_with_equal_lengths_share_their_factors():
    """Equal outputs have equal lengths: one factorisation, also when it is pickled."""
    x = design()
    models = GaussianProcess().fit_many(x, np.column_stack([smooth(x), smooth(x)]))
    again = pickle.loads(pickle.dumps(models))
    assert again[0].factors_.factor is again[1].factors_.factor
    assert len(pickle.dumps(models)) < 1.5 * len(pickle.dumps(models[0]))
