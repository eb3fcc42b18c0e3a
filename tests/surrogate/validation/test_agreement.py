"""Figures of agreement against a published example, closed forms and simulation."""

import numpy as np
import pytest
from scipy import stats

from surrogate.validation.agreement import FIGURES, agreement

#: Bland and Altman 1986, Table 1: peak expiratory flow rate (l/min), first measurements.
WRIGHT = np.array(
    [494, 395, 516, 434, 476, 557, 413, 442, 650, 433, 417, 656, 267, 478, 178, 423, 427.0]
)
MINI = np.array(
    [512, 430, 520, 428, 500, 600, 364, 380, 658, 445, 432, 626, 260, 477, 259, 350, 451.0]
)


def test_bland_and_altman_1986():
    """PEFR: mean difference -2.1 (-22.0 to 17.8), SD 38.8, limits -79.7 and 75.5 l/min."""
    found = agreement(MINI, WRIGHT, multiple=2.0)
    assert found["n"] == 17
    assert found["bias"] == pytest.approx(-2.1, abs=0.05)
    assert found["sd"] == pytest.approx(38.8, abs=0.05)
    assert found["lower_limit"] == pytest.approx(-79.7, abs=0.1)
    assert found["upper_limit"] == pytest.approx(75.5, abs=0.1)
    assert found["bias_low"] == pytest.approx(-22.0, abs=0.1)
    assert found["bias_high"] == pytest.approx(17.8, abs=0.1)
    # Their interval of the lower limit, -114.3 to -45.1, is from sqrt(3 s^2 / n); the exact
    # one has the same width within a sixth and lies further out, as a square root's does.
    width = found["lower_limit_high"] - found["lower_limit_low"]
    assert width == pytest.approx(114.3 - 45.1, rel=1 / 6)
    assert found["lower_limit_low"] < -114.3 and found["lower_limit_high"] < -45.1


def test_regression_and_r2():
    """Slope against scipy on pairs mirrored at the origin; R2 against their definitions."""
    found = agreement(WRIGHT, MINI)
    mirrored = stats.linregress(np.r_[WRIGHT, -WRIGHT], np.r_[MINI, -MINI])
    assert found["slope"] == pytest.approx(mirrored.slope, rel=1e-12)
    # the mirrored line has 2 n - 2 degrees of freedom and twice the sum of squares
    half = stats.t.ppf(0.975, 16) * mirrored.stderr * np.sqrt(2 * (34 - 2) / 32)
    assert found["slope_high"] - found["slope"] == pytest.approx(half, rel=1e-10)
    assert found["r2_correlation"] == pytest.approx(stats.pearsonr(WRIGHT, MINI)[0] ** 2)
    error = MINI - WRIGHT
    assert found["r2"] == pytest.approx(1 - (error**2).mean() / WRIGHT.var())
    assert found["rmse"] ** 2 == pytest.approx(found["bias"] ** 2 + error.var())
    assert found["mean_error_percent"] == pytest.approx(100 * np.mean(error / WRIGHT))


@pytest.mark.parametrize("n", [5, 30])
def test_intervals_hold_the_truth_as_often_as_they_say(n):
    """Normal differences: 95 % intervals of bias and limits hold the true ones (Carkeet 2015)."""
    rng, trials = np.random.default_rng(1), 1500
    truth = {"bias": 1.0, "lower_limit": 1.0 - 1.96 * 2, "upper_limit": 1.0 + 1.96 * 2}
    held = dict.fromkeys(truth, 0)
    for _ in range(trials):
        x = rng.normal(30.0, 5.0, n)
        found = agreement(x, x + rng.normal(1.0, 2.0, n))
        for name, value in truth.items():
            held[name] += found[f"{name}_low"] <= value <= found[f"{name}_high"]
    for name, count in held.items():
        assert abs(count / trials - 0.95) < 3.5 * np.sqrt(0.95 * 0.05 / trials), name


def test_many_pairs_are_as_the_normal_law_says():
    """SE of a limit tends to s sqrt(1 / n + 1.96^2 / (2 n)) (Bland and Altman 1999, section 2)."""
    rng = np.random.default_rng(2)
    x = rng.normal(size=20_000)
    found = agreement(x, x + rng.normal(size=20_000))
    half = (found["upper_limit_high"] - found["upper_limit_low"]) / 2
    assert half == pytest.approx(1.96 * found["sd"] * np.sqrt((1 + 1.96**2 / 2) / 20_000), rel=0.01)


def test_repeated_measures():
    """Between and within parts of the differences are those put in (Bland and Altman 2007)."""
    rng = np.random.default_rng(3)
    subjects = np.repeat(np.arange(400), rng.integers(1, 6, 400))
    d = 1.0 + rng.normal(0, 3.0, 400)[subjects] + rng.normal(0, 1.5, len(subjects))
    x = rng.normal(50, 5, len(d))
    found = agreement(x, x + d, subjects)
    assert found["sd_between"] == pytest.approx(3.0, rel=0.08)
    assert found["sd_within"] == pytest.approx(1.5, rel=0.05)
    assert found["sd"] == pytest.approx(np.hypot(3.0, 1.5), rel=0.06)
    assert found["upper_limit_low"] < 1 + 1.96 * np.hypot(3, 1.5) < found["upper_limit_high"]
    # a subject's repetitions say little about other subjects: the bias is less sure
    alone = agreement(x, x + d)
    assert found["bias_high"] - found["bias_low"] > 1.4 * (alone["bias_high"] - alone["bias_low"])


def test_balanced_repeated_measures_by_hand():
    """Two pairs for each of three subjects, d = 0 2 | 3 5 | 9 11.

    Means 1, 4, 10 about 5: msb = 2 (16 + 1 + 25) / 2 = 42, msw = 6 / 3 = 2; between
    variance (42 - 2) / 2 = 20, total 22.
    """
    d = np.array([0, 2, 3, 5, 9, 11.0])
    found = agreement(np.full(6, 100.0), 100.0 + d, list("aabbcc"))
    assert found["bias"] == pytest.approx(5.0)
    assert found["sd_between"] ** 2 == pytest.approx(20.0)
    assert found["sd"] ** 2 == pytest.approx(22.0)
    assert found["bias_high"] - 5.0 == pytest.approx(stats.t.ppf(0.975, 2) * np.sqrt(42 / 6))


def test_repeated_intervals_hold_the_truth():
    """20 subjects with 1 to 4 pairs: the intervals of the limits hold them 90 to 98 % of times."""
    rng, trials, held = np.random.default_rng(4), 600, 0
    for _ in range(trials):
        subjects = np.repeat(np.arange(20), rng.integers(1, 5, 20))
        d = rng.normal(0, 2.0, 20)[subjects] + rng.normal(0, 1.0, len(subjects))
        found = agreement(np.full(len(d), 9.0), 9.0 + d, subjects)
        held += found["upper_limit_low"] <= 1.96 * np.sqrt(5) <= found["upper_limit_high"]
    assert 0.90 <= held / trials <= 0.98, held / trials


def test_gaps_and_few_pairs():
    """Pairs with a NaN are left out; what cannot be said is NaN, never an error."""
    found = agreement([1.0, np.nan, 3.0, 4.0], [1.5, 2.0, np.nan, 4.0])
    assert found["n"] == 2 and found["bias"] == 0.25
    assert agreement([], [])["n"] == 0
    one = agreement([2.0], [3.0])
    assert one["bias"] == 1.0 and np.isnan(one["sd"]) and set(one) == set(FIGURES)
    same = agreement([1.0, 2.0, 3.0], [1.0, 2.0, 3.0])
    assert same["r2"] == 1.0 and same["upper_limit_high"] == 0.0
    assert np.isnan(agreement([0.0, 1.0], [1.0, 1.0])["mean_error_percent"])
