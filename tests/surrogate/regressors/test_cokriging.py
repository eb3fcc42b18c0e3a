"""Co-kriging: exact cases, joint algebra, refits, another program."""

import numpy as np
import pytest
from scipy import stats
from scipy.stats import qmc

from surrogate.regressors.cokriging import CoKriging
from surrogate.regressors.gaussian_process import GaussianProcess
from surrogate.regressors.level_process import LevelProcess, LevelRuns
from surrogate.regressors.likelihood import LengthPrior
from surrogate.regressors.matern import correlation


def cheap(x):
    return np.sin(3 * x[:, 0]) + 0.4 * x[:, 1] ** 2 + 0.3 * x[:, 0] * x[:, 1]


def true(x):
    return 1.7 * cheap(x) + 0.5 * np.exp(0.4 * x[:, 0]) - 3


def designs(many=30, few=9, seed=0):
    """Cheap points (many, 2), of which the first few are the truth's."""
    points = 2 * qmc.LatinHypercube(2, seed=seed).random(many) - 1
    return points, points[:few]


def fitted(many=30, few=9, nugget=1e-10, **options):
    x, t = designs(many, few)
    return CoKriging(nugget=nugget, lower=[LevelRuns(x, cheap(x))], **options).fit(t, true(t))


NEW = 2 * qmc.LatinHypercube(2, seed=9).random(50) - 1


def test_a_scaled_and_shifted_cheap_level_is_recovered_exactly():
    """Truth = 3 cheap - 2: nothing is uncertain but the cheap level."""
    x, t = designs()
    model = CoKriging(lower=[LevelRuns(x, cheap(x))], nugget=1e-10).fit(t, 3 * cheap(t) - 2)
    low = model.levels_[0]
    np.testing.assert_allclose(model.predict(NEW), 3 * low.predict(NEW) - 2, rtol=1e-7)
    variance = low.parts(low.expanded(NEW))[0]
    np.testing.assert_allclose(
        model.variance_of_levels(NEW), np.column_stack([9 * variance, 0 * variance]), atol=1e-12
    )


def test_rho_linear_in_the_inputs_is_recovered():
    x, t = designs()
    y = (2 + 0.5 * t[:, 1]) * cheap(t) + 1
    model = CoKriging("linear", "linear", lower=[LevelRuns(x, cheap(x))], nugget=1e-10).fit(t, y)
    expected = (2 + 0.5 * NEW[:, 1]) * model.levels_[0].predict(NEW) + 1
    np.testing.assert_allclose(model.predict(NEW), expected, rtol=1e-6)


class HeavyTailed(GaussianProcess):
    """With the prior of lengths of a level."""

    length_prior = LevelProcess.length_prior


def test_without_cheaper_levels_it_is_the_gaussian_process():
    """Of the same prior, its widened deviations included."""
    t = designs()[1]
    ours, known = CoKriging().fit(t, true(t)), HeavyTailed().fit(t, true(t))
    mean, std = known.predict(NEW, return_std=True)
    np.testing.assert_allclose(ours.predict(NEW), mean, rtol=1e-9)
    np.testing.assert_allclose(ours.predict(NEW, True)[1], std, rtol=1e-9)


def joint_law(model, new):
    """Mean and variance at new points by the joint covariance of both levels, trends known.

    Cov(cheap, cheap) = k, Cov(true, cheap) = rho k, Cov(true, true) = rho^2 k + d
    (Kennedy and O'Hagan 2000, section 2.3).
    """
    low, high = model.levels_
    x, t = low.points_, high.points_
    trend = [low.offset_ + low.scale_ * low.trend_[0]]
    rho = high.trend_[1] * high.scale_ / low.scale_
    trend.append(high.offset_ + high.scale_ * high.trend_[0] - rho * low.offset_ + rho * trend[0])

    def k(a, b):
        return low.variance_ * correlation(a, b, low.lengths_)

    def d(a, b):
        return high.variance_ * correlation(a, b, high.lengths_)

    corner = rho * k(t, x)
    whole = np.block([[k(x, x), corner.T], [corner, rho**2 * k(t, t) + d(t, t)]])
    whole[np.diag_indices(len(x))] += low.variance_ * low.nugget_
    below = np.arange(len(x), len(whole))
    whole[below, below] += high.variance_ * high.nugget_
    row = np.hstack([rho * k(new, x), rho**2 * k(new, t) + d(new, t)])
    rest = np.concatenate([cheap(x) - trend[0], true(t) - trend[1]])
    mean = trend[1] + row @ np.linalg.solve(whole, rest)
    variance = rho**2 * low.variance_ + high.variance_
    return mean, variance - np.einsum("ij,ji->i", row, np.linalg.solve(whole, row.T))


def lengths_set(level, lengths):
    """The level with other lengths, of which its correlations are better conditioned."""
    logs = np.append(np.log(lengths) * np.ones(2), level.logs_[-1])
    level._set(logs, level._factored(logs))
    return level


def test_recursive_is_joint_cokriging():
    """Le Gratiet and Garnier 2014, proposition 1: nested points give the law of all at once.

    The joint law here takes trend and rho as known, so its variance is smaller.
    """
    model = fitted()
    low = lengths_set(model.levels_[0], 0.7)
    high = lengths_set(model.truth, 0.9)
    mean, variance = joint_law(model, NEW)
    ours, std = model.predict(NEW, return_std=True)
    np.testing.assert_allclose(ours, mean, rtol=1e-5)
    assert np.all(variance <= std**2 * (1 + 1e-6))
    known = np.sqrt(variance)
    for level in (high, low):  # trends known: no part of the variance comes from them
        object.__setattr__(level.factors_, "gain", 0.0 * level.factors_.gain)
    np.testing.assert_allclose(model.predict(NEW, return_std=True)[1], known, rtol=1e-3, atol=1e-5)


@pytest.mark.parametrize("scale", ["constant", "linear"])
@pytest.mark.parametrize("folds", [range(10), [0, 0, 1, 1, 2, 2, 3, 3, 4, 4]])
def test_left_out_predictions_are_those_of_refits(scale, folds):
    """Runs of both levels left out, lengths and nuggets held."""
    model, folds = fitted(few=10, nugget=1e-8, scale=scale), np.array(folds)
    x, t = designs(few=10)
    expected = np.empty(10)
    for fold in np.unique(folds):
        out = np.flatnonzero(folds == fold)
        low = held(model.levels_[0], None, np.delete(x, out, 0), cheap)
        high = held(model.truth, low, np.delete(t, out, 0), true)
        expected[out] = high.offset_ + high.scale_ * high.mean(high.expanded(t[out]))
    np.testing.assert_allclose(model.leave_out(folds), expected, rtol=1e-5, atol=1e-6)


def held(level, below, points, answer):
    """The level fitted to other runs with its lengths, nugget and standardisation.

    Rho multiplies the level below about its mean, so another mean would be another model.
    """
    other = LevelProcess(**{**level.get_params(deep=False), "below": below})
    other._take(points, answer(points))
    other.offset_, other.scale_ = level.offset_, level.scale_
    other.standard_ = (answer(points) - level.offset_) / level.scale_
    other._set(level.logs_, other._factored(level.logs_))
    return other


def test_draws_scatter_as_the_prediction_says():
    """Student's t with n - q degrees of freedom has variance nu / (nu - 2)."""
    model = fitted(few=12, nugget=1e-6)
    drawn = model.posterior_draws(1000, seed=2)
    values = drawn[0].paths.predict(NEW, slice(0, 1000))
    np.testing.assert_allclose(values[:, 7], drawn[7].predict(NEW), rtol=1e-9)
    mean, std = model.predict(NEW, return_std=True)
    freedom = model.interval_freedom
    scatter = values.std(axis=1) / np.sqrt(freedom / (freedom - 2))
    np.testing.assert_allclose(values.mean(axis=1), mean, atol=5 * (std / 30).max())
    assert np.median(scatter / std) == pytest.approx(1.0, abs=0.1)


def test_the_parts_of_the_variance_add_up():
    model = fitted(few=12)
    parts = model.variance_of_levels(NEW)
    one = model.truth
    np.testing.assert_allclose(
        parts.sum(axis=1) + one.nugget_ * one.variance_, model.predict(NEW, True)[1] ** 2
    )


def test_a_cheap_level_with_fewer_inputs_does_not_see_the_others():
    """Its mean is the same wherever the input that it does not take lies."""
    x, t = designs()
    lower = LevelRuns(x, np.sin(3 * x[:, 0]), inputs=(0,))
    model = CoKriging(lower=[lower]).fit(t, np.sin(3 * t[:, 0]) + 0.3 * t[:, 1])
    moved = NEW * [1.0, 0.0]
    low = model.levels_[0]
    np.testing.assert_array_equal(low.predict(NEW), low.predict(moved))
    error = model.predict(NEW) - np.sin(3 * NEW[:, 0]) - 0.3 * NEW[:, 1]
    assert np.sqrt(np.mean(error**2)) < 0.02


def test_a_constant_cheap_level_is_told():
    x, t = designs()
    with pytest.raises(ValueError, match="cheaper level takes different values"):
        CoKriging(lower=[LevelRuns(x, np.ones(len(x)))]).fit(t, true(t))


def test_too_few_runs_of_the_cheapest_level_are_told():
    """It has no level below, and the message speaks of none."""
    x, t = designs(3, 3)
    with pytest.raises(ValueError, match="3 runs cannot determine a linear trend with 3 coeff"):
        CoKriging(trend="linear", lower=[LevelRuns(x, cheap(x))]).fit(t, true(t))


def test_a_misspelt_scale_is_told():
    x, t = designs()
    with pytest.raises(ValueError, match="constant"):
        CoKriging(scale="constnt").fit(t, true(t))


def test_three_levels_beat_two():
    """Each level between brings the truth nearer."""
    x, t = designs(60, 5)
    middle = x[:15]
    low = LevelRuns(x, cheap(x) + 0.3 * np.cos(2 * x[:, 1]))
    between = LevelRuns(middle, cheap(middle) + 0.05 * np.cos(2 * middle[:, 1]))
    errors = [
        np.sqrt(np.mean((CoKriging(lower=lower).fit(t, true(t)).predict(NEW) - true(NEW)) ** 2))
        for lower in ([low], [low, between])
    ]
    assert errors[1] < 0.5 * errors[0]


def test_predictions_are_those_of_smt_with_its_lengths():
    """Same runs, kernel and lengths: the co-kriging of SMT (Le Gratiet's MuFiCokriging)."""
    mfk = pytest.importorskip("smt.applications").MFK
    x, t = designs()
    theirs = mfk(theta0=[0.5], corr="matern52", n_start=1, print_global=False, nugget=1e-10)
    theirs.set_training_values(x, cheap(x)[:, None], name=0)
    theirs.set_training_values(t, true(t)[:, None])
    theirs.train()
    ours = fitted(nugget=1e-10)
    low = ours.levels_[0]
    for level, theta in zip((low, ours.truth), theirs.optimal_theta, strict=True):
        lengths_set(level, theirs.X_scale / np.asarray(theta))
    mean, std = ours.predict(NEW, return_std=True)
    np.testing.assert_allclose(mean, theirs.predict_values(NEW)[:, 0], rtol=1e-4, atol=1e-4)
    assert std == pytest.approx(np.sqrt(theirs.predict_variances(NEW)[:, 0]), rel=0.2, abs=1e-4)


def currin(x):
    """Currin, Mitchell, Morris and Ylvisaker 1988; bent at one edge."""
    a, b = (x.T + 1) / 2
    above = 2300 * a**3 + 1900 * a**2 + 2092 * a + 60
    below = 100 * a**3 + 500 * a**2 + 4 * a + 20
    return -np.expm1(-0.5 / np.maximum(b, 1e-12)) * above / below


def currin_cheap(x):
    """Xiong, Qian and Wu 2013: the mean of four points about."""
    ways = [(0.1, 0.1), (0.1, -0.1), (-0.1, 0.1), (-0.1, -0.1)]
    return np.mean([currin(np.maximum(x + way, [-9.0, -1.0])) for way in ways], axis=0)


def himmelblau(x):
    """Himmelblau 1972 on [-4, 4]; cheap as in Dong, Song, Wang and Dong 2015."""
    a, b = 4 * x.T
    return (a**2 + b - 11) ** 2 + (b**2 + a - 7) ** 2


def himmelblau_cheap(x):
    a, b = 4 * x.T
    return himmelblau(x * [0.5, 0.8]) + b**3 - (a + 1) ** 2


@pytest.mark.parametrize("low, high", [(currin_cheap, currin), (himmelblau_cheap, himmelblau)])
def test_intervals_hold_new_runs_of_the_truth(low, high):
    """95 % intervals from nine true runs; as the likelihood alone has them they hold too few."""
    new = 2 * qmc.Sobol(2, seed=9).random(256) - 1
    truth, inside = high(new), []
    for seed in range(8):
        x, t = designs(45, 9, seed)
        t = x[:9] = 2 * qmc.LatinHypercube(2, seed=100 + seed).random(9) - 1
        model = CoKriging(lower=[LevelRuns(x, low(x))]).fit(t, high(t))
        widened = [level.widening_ for level in model.levels_]
        for factors in (widened, [1.0, 1.0]):
            for level, factor in zip(model.levels_, factors, strict=True):
                level.widening_ = factor
            mean, std = model.predict(new, return_std=True)
            half = stats.t.ppf(0.975, model.interval_freedom) * std
            inside.append((np.abs(truth - mean) <= half).mean())
    held, bare = np.mean(inside[::2]), np.mean(inside[1::2])
    assert 0.91 < held < 0.99
    assert bare < 0.88


def test_deviations_of_each_level_are_wider_by_what_its_left_out_runs_show():
    """As of the Gaussian process; each level's factor widens its own part of the variance."""
    x, t = designs(30, 9)
    model = CoKriging(lower=[LevelRuns(x, cheap(x))]).fit(t, true(t) + 0.3 * (t[:, 0] > 0))
    for level in model.levels_:
        mean, std = level.left_out_
        n, z = len(mean), (level.standard_ - mean) / std
        assert level.widening_ == pytest.approx(max(1, np.sqrt((z**2).mean() * (n + 1) / (n - 1))))
    truth = model.truth
    assert truth.widening_ > 1.2
    wide = model.variance_of_levels(NEW)[:, 1]
    factor, truth.widening_ = truth.widening_, 1.0
    np.testing.assert_allclose(wide, factor**2 * model.variance_of_levels(NEW)[:, 1])


class Bounded(GaussianProcess):
    """Lengths of 50 at most."""

    length_prior = LengthPrior((0.05, 50.0))


@pytest.mark.parametrize("kind", [CoKriging, GaussianProcess])
def test_inputs_without_effect_cost_little(kind):
    """Six of ten inputs are inert: with lengths of 50 at most the error is twice as large."""
    x, new = (2 * qmc.Sobol(10, seed=s).random(n) - 1 for s, n in ((1, 64), (2, 256)))

    def y(x):
        return 6 * x[:, 0] + 4 * x[:, 1] + 5.5 * x[:, 2] + 3 * x[:, 0] * x[:, 1] + x[:, 3] ** 2

    errors = [
        np.sqrt(np.mean((model().fit(x, y(x)).predict(new) - y(new)) ** 2))
        for model in (kind, Bounded)
    ]
    assert errors[0] < 0.5 * errors[1]
