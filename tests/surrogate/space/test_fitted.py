"""Fitted laws against closed forms, simulated data of each law, and scipy's own kernels."""

import numpy as np
import pytest
from scipy import stats

from surrogate.errors import StudyError
from surrogate.space.fitted import KernelSmoothed, data_law, fitted_laws

SAMPLES = {
    "normal": stats.norm(3.0, 2.0),
    "lognormal": stats.lognorm(0.8, scale=4.0),
    "uniform": stats.uniform(1.0, 4.0),
    "triangular": stats.triang(0.3, 1.0, 5.0),
    "weibull_min": stats.weibull_min(0.5, scale=2.0),
    "gamma": stats.gamma(1.5, scale=2.0),
    "beta": stats.beta(0.4, 0.5, 1.0, 3.0),
}


def test_normal_law_is_mean_and_spread_by_hand():
    """-2 ln L = n ln(2 pi s^2) + n; AICc adds 4 + 12 / (n - 3)."""
    x = stats.norm(3, 2).rvs(40, random_state=1)
    found = {one.name: one for one in fitted_laws(x)}["normal"]
    by_hand = 40 * (np.log(2 * np.pi * x.var()) + 1) + 4 + 12 / 37
    assert found.aicc == pytest.approx(by_hand, rel=1e-12)
    assert found.ks == pytest.approx(stats.kstest(x, stats.norm(x.mean(), x.std()).cdf)[0])


@pytest.mark.parametrize("name", SAMPLES)
def test_the_law_that_made_the_data_is_found(name):
    """Averaged over samples no law has a smaller AICc: the true one is nearest in information."""
    laws = [
        {one.name: one.aicc for one in fitted_laws(SAMPLES[name].rvs(400, random_state=seed))}
        for seed in range(8)
    ]
    common = set.intersection(*map(set, laws))
    means = {one: np.mean([law[one] for law in laws]) for one in common}
    assert min(means, key=means.__getitem__) == name


def test_a_law_of_positive_values_is_left_out_for_negative_ones():
    names = {one.name for one in fitted_laws(stats.norm.rvs(size=50, random_state=0))}
    assert not names & {"lognormal", "gamma", "weibull_min"}


def test_too_few_values_are_a_sentence():
    with pytest.raises(StudyError, match="needs 8 different values .* the data have 3"):
        fitted_laws([1.0, 2.0, 3.0, 3.0, np.nan])


def test_the_datas_own_law_is_that_of_scipys_kernels():
    x = stats.gamma(2).rvs(60, random_state=3)
    law = KernelSmoothed.of(x)
    scipy = stats.gaussian_kde(x, bw_method=law.width / x.std(ddof=1))
    at = np.linspace(0, 8, 30)
    assert law.pdf(at) == pytest.approx(scipy(at), rel=1e-12)
    below = [scipy.integrate_box_1d(-np.inf, b) for b in at]
    assert law.cdf(at) == pytest.approx(below, abs=1e-12)
    u = np.array([1e-6, 0.01, 0.5, 0.99, 1 - 1e-6])
    assert law.cdf(law.ppf(u)) == pytest.approx(u, rel=1e-9)
    assert law.sf(law.isf(u)) == pytest.approx(u, rel=1e-9)


def test_the_datas_own_law_is_a_distribution_of_a_study():
    x = stats.gamma(2).rvs(60, random_state=3)
    law = data_law(x)
    assert law.bounded and law == data_law(x) and law != data_law(x + 1)
    u = np.linspace(0.01, 0.99, 9)
    assert law.cdf(law.ppf(u)) == pytest.approx(u, rel=1e-9)
