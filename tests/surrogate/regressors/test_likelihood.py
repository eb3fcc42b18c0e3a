"""Priors of lengths, against SciPy's laws and by differences."""

import numpy as np
import pytest
from scipy import stats

from surrogate.regressors.likelihood import HEAVY_TAILED, NORMAL

LOGS = np.log([0.1, 1.0, 3.0, 20.0, 900.0])


@pytest.mark.parametrize("prior, law", [(NORMAL, stats.norm()), (HEAVY_TAILED, stats.t(3))])
def test_the_density_of_log_lengths(prior, law):
    """-2 log density of the logarithms, of median 3 and spread 1.5."""
    off = (LOGS - np.log(3.0)) / 1.5
    told = [prior.deviance(one[None]) - prior.deviance(np.log([3.0])) for one in LOGS]
    np.testing.assert_allclose(told, -2.0 * (law.logpdf(off) - law.logpdf(0.0)), atol=1e-12)


@pytest.mark.parametrize("prior", [NORMAL, HEAVY_TAILED])
def test_its_slope(prior):
    for j, one in enumerate(LOGS):
        up, down = (prior.deviance(one[None] + step) for step in (1e-5, -1e-5))
        assert prior.slope(LOGS)[j] == pytest.approx((up - down) / 2e-5, rel=1e-6, abs=1e-8)
