"""A probability by a surrogate, with both parts of its error."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

from surrogate.estimator import Regressor
from surrogate.fitting.fit import Fit, fit
from surrogate.regressors.gaussian_process import GaussianProcess
from surrogate.regressors.polynomial import Linear
from surrogate.reliability.answer import reliability
from surrogate.space.distributions import distribution
from surrogate.space.space import Parameter, Space

LAW = distribution("normal", mean=0.0, std=1.0, range=(-6.0, 6.0))
SPACE = Space((Parameter("a", LAW), Parameter("b", LAW)))


def fitted(estimator: Regressor, noise: float) -> Fit:
    generator = np.random.default_rng(1)
    coded = generator.uniform(-0.8, 0.8, (40, 2))
    values = 6.0 * coded.sum(axis=1) + noise * generator.standard_normal(40)
    return fit(SPACE, coded, values, estimator)


@pytest.mark.parametrize("above", [True, False])
def test_both_parts_of_the_interval_are_told_and_cover(above: bool) -> None:
    one = fitted(Linear(), 0.5)
    found = reliability(one, 4.5 if above else -4.5, above=above, confidence=0.99)
    truth = stats.norm.sf(4.5 / np.sqrt(2.0))
    low, high = found.interval
    assert found.surrogate[0] < found.probability < found.surrogate[1]
    assert low <= min(found.surrogate[0], found.sampling.low)
    assert high >= max(found.surrogate[1], found.sampling.high)
    assert low <= truth <= high


def test_a_process_that_met_its_runs_leaves_the_error_of_sampling() -> None:
    found = reliability(fitted(GaussianProcess(), 0.0), 4.5)
    assert found.how == "posterior draws"
    assert found.probability == pytest.approx(stats.norm.sf(4.5 / np.sqrt(2.0)), rel=0.15)
    low, high = found.surrogate
    assert high - low < found.sampling.high - found.sampling.low
    assert found.tangent.beta == pytest.approx(4.5 / np.sqrt(2.0), abs=0.01)
