"""Huber's estimate: a published table, wild runs, suspicion at its level."""

import numpy as np
import pytest

from surrogate.regressors.huber import Huber
from surrogate.regressors.polynomial import Linear

#: Brownlee 1965: air flow, water temperature, acid concentration, and stack loss.
STACK_LOSS = np.array(
    """80 27 89 42; 80 27 88 37; 75 25 90 37; 62 24 87 28; 62 22 87 18; 62 23 87 18; 62 24 93 19;
    62 24 93 20; 58 23 87 15; 58 18 80 14; 58 18 89 14; 58 17 88 13; 58 18 82 11; 58 19 93 12;
    50 18 89 8; 50 18 86 7; 50 19 72 8; 50 19 79 8; 50 20 80 9; 56 20 82 15; 70 20 91 15""".replace(
        ";", " "
    ).split(),
    dtype=float,
).reshape(21, 4)


def test_the_stack_loss_data_give_the_published_table():
    """rlm of R's MASS (Venables and Ripley 2002, section 6.5): coefficients, errors and scale."""
    model = Huber().fit(STACK_LOSS[:, :3], STACK_LOSS[:, 3])
    table = model.regression_table()
    assert table["coefficient"].values == pytest.approx(
        [-41.0265, 0.8294, 0.9261, -0.1278], abs=2e-3
    )
    assert table["standard_error"].values == pytest.approx(
        [9.8073, 0.1112, 0.3034, 0.1289], rel=0.01
    )
    assert model.scale_ == pytest.approx(2.441, abs=2e-3)


def line(seed=0, n=40):
    r = np.random.default_rng(seed)
    x = r.uniform(-1, 1, (n, 2))
    return x, 3.0 + 2.0 * x[:, 0] - x[:, 1] + 0.1 * r.normal(size=n)


def test_wild_runs_hardly_move_it_and_are_found():
    """Four of 40 runs are off by 5; least squares moves by ten times as much."""
    x, y = line()
    y[[3, 11, 20, 31]] += 5.0
    robust, plain = Huber().fit(x, y), Linear().fit(x, y)
    truth = np.array([3.0, 2.0, -1.0])
    assert np.abs(robust.coef_ - truth).max() < 0.06
    assert np.abs(plain.coef_ - truth).max() > 0.4
    assert robust.suspicious_.tolist() == [3, 11, 20, 31]
    assert robust.scale_ == pytest.approx(0.1, rel=0.35)


@pytest.mark.parametrize("n", [8, 40])
def test_good_runs_are_seldom_suspected(n):
    """Normal errors: in 5 to 9 % of the samples; among 120, two standard errors more at most."""
    found = [len(Huber().fit(*line(seed, n)).suspicious_) > 0 for seed in range(120)]
    assert np.mean(found) < 0.09 + 2 * np.sqrt(0.09 * 0.91 / 120)


def test_normal_errors_cost_five_percent():
    """Variance of the estimates over that of least squares: 1 / 0.95, within sampling error."""
    robust, plain = (
        np.array([kind().fit(*line(seed, 100)).coef_ for seed in range(300)])
        for kind in (Huber, Linear)
    )
    ratio = (robust.var(axis=0) / plain.var(axis=0)).mean()
    assert ratio == pytest.approx(1 / 0.95, abs=0.04)


def test_standard_errors_are_the_scatter_of_the_estimates():
    samples = [Huber().fit(*line(seed)) for seed in range(200)]
    scatter = np.std([model.coef_ for model in samples], axis=0)
    told = np.mean([model.regression_table()["standard_error"].values for model in samples], axis=0)
    assert told == pytest.approx(scatter, rel=0.12)


def test_exact_runs_with_a_few_wild_ones_give_the_exact_polynomial():
    x, _ = line(n=20)
    y = 3.0 + 2.0 * x[:, 0] - x[:, 1]
    y[[2, 7]] = 100.0
    model = Huber().fit(x, y)
    assert model.coef_ == pytest.approx([3.0, 2.0, -1.0], abs=1e-7)
    assert model.suspicious_.tolist() == [2, 7]
    model = Huber().fit(x, 3.0 + 2.0 * x[:, 0] - x[:, 1])
    assert model.coef_ == pytest.approx([3.0, 2.0, -1.0], abs=1e-12)
    assert not len(model.suspicious_)


def test_leave_one_out_refits():
    x, y = line(n=12)
    rest = np.arange(12) != 4
    expected = Huber().fit(x[rest], y[rest]).predict(x[[4]])[0]
    assert Huber().fit(x, y).leave_one_out()[4] == pytest.approx(expected, rel=1e-12)
