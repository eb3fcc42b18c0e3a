"""Processes that take unbounded inputs by their normal scores."""

import numpy as np
import pytest
from scipy import stats

from surrogate.designs.latin_hypercube import latin_hypercube
from surrogate.errors import FitError
from surrogate.fitting.fit import fit
from surrogate.regressors.columns import columns_of, expand, scored
from surrogate.regressors.gaussian_process import GaussianProcess
from surrogate.space.distributions import distribution, uniform
from surrogate.space.space import Parameter, Space

SPACE = Space(
    (
        Parameter("a", distribution("normal", mean=3.0, std=2.0)),
        Parameter("b", distribution("normal", mean=0.0, std=1.0)),
        Parameter("c", uniform(0.0, 1.0)),
    )
)


def learnt(normal_scores):
    coded = latin_hypercube(SPACE, runs=40, seed=1)
    x = SPACE.decode(coded)
    return fit(SPACE, coded, x["a"] + x["b"], GaussianProcess(normal_scores=normal_scores))


def test_the_score_is_half_of_the_deviation():
    z = np.array([-6.0, -2.0, 0.0, 2.0, 6.0])
    coded = np.column_stack([2.0 * stats.norm.cdf(z) - 1.0] * 2 + [np.linspace(-1, 1, 5)])
    columns = expand(coded, scored(columns_of(SPACE, 3), SPACE))
    assert columns[:, 0] == pytest.approx(z / 2.0, abs=1e-6)
    assert columns[:, 2].tolist() == coded[:, 2].tolist()  # bounded: as it is
    assert np.isfinite(
        expand(np.array([[-1.0, 1.0, 1.0]]), scored(columns_of(SPACE, 3), SPACE))
    ).all()


def test_the_far_ends_are_predicted():
    far = SPACE.encode({"a": [3.0 + 8.0], "b": [3.0], "c": [0.5]})
    by_score, by_probability = (abs(learnt(one).predict(far)[0] - 14.0) for one in (True, False))
    assert by_score < 0.5
    assert by_probability > 2.0


def test_indices_are_those_of_the_law():
    found = learnt(True).estimator.sobol_indices()
    assert found.first_order == pytest.approx([0.8, 0.2, 0.0], abs=0.01)
    values = [
        one.predict(SPACE.sample(500, seed=1))
        for one in learnt(True).estimator.posterior_draws(5, seed=1)
    ]
    assert np.std(values[0]) == pytest.approx(5.0**0.5, rel=0.1)


def test_it_has_no_portable_form():
    with pytest.raises(FitError, match="normal scores"):
        learnt(True).portable()
