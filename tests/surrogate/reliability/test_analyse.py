"""A probability of failure by a surrogate, with both parts of its interval."""

import numpy as np
import pytest
from scipy import stats
from sklearn.linear_model import LinearRegression

from surrogate.designs.latin_hypercube import latin_hypercube
from surrogate.fitting.fit import fit
from surrogate.regressors.gaussian_process import GaussianProcess
from surrogate.regressors.polynomial import Linear, Polynomial
from surrogate.reliability.analyse import analyse
from surrogate.reliability.problem import Failure
from surrogate.space.constraint_text import parse
from surrogate.space.distributions import distribution, uniform
from surrogate.space.space import Parameter, Space

NORMAL = tuple(Parameter(f"x{k}", distribution("normal", mean=1.0, std=2.0)) for k in (1, 2))
SPACE = Space(NORMAL)


def learnt(space, of, estimator, runs=40, seed=1):
    coded = latin_hypercube(space, runs=runs, seed=seed)
    values = of(*space.decode(coded).values())
    return fit(space, coded, values, estimator, output="y")


def test_a_sum_of_normal_inputs():
    """y = x1 + x2 is normal with mean 2 and variance 8; correlated by 0.5 it has variance 12."""
    process = GaussianProcess(normal_scores=True)
    for correlation, variance in ((None, 8.0), (((1.0, 0.5), (0.5, 1.0)), 12.0)):
        space = Space(NORMAL, correlation)
        limit = 2.0 + 3.5 * variance**0.5
        one = analyse(Failure("f", "y", limit), space, learnt(space, np.add, process))
        assert one.estimate.method == "subset"
        assert one.probability == pytest.approx(stats.norm.sf(3.5), rel=0.15)
        assert one.low < one.probability < one.high
        point = one.design_point
        assert point.beta == pytest.approx(3.5, abs=0.02)
        assert sum(point.inputs.values()) == pytest.approx(limit, rel=5e-3)
        assert sum(point.factors.values()) == pytest.approx(1.0)


def test_below_is_the_other_side():
    one = analyse(
        Failure("f", "y", -2.0, sign=-1),
        SPACE,
        learnt(SPACE, np.add, GaussianProcess(normal_scores=True)),
    )
    truth = stats.norm.cdf(-4.0 / 8.0**0.5)
    assert one.estimate.method == "crude"
    assert one.probability == pytest.approx(truth, rel=0.08)
    assert "below -2" in str(one)


def test_a_surrogate_that_knows_little_has_a_wide_interval():
    """Few runs: far from the truth, and the intervals hold it all the same."""

    def bent(x, y):
        return np.sin(x) * y + x

    space = Space((Parameter("x", uniform(-3, 3)), Parameter("y", uniform(-3, 3))))
    truth = float((bent(**space.decode(space.sample(400_000, seed=3))) > 4.5).mean())
    few, many = (
        [
            analyse(
                Failure("f", "y", 4.5), space, learnt(space, bent, GaussianProcess(), runs, seed)
            )
            for seed in range(count)
        ]
        for runs, count in ((16, 6), (60, 2))
    )
    assert sum(one.low <= truth <= one.high for one in few) >= 5
    assert min(np.diff(one.error)[0] for one in few) > 1.5 * np.diff(many[0].error)[0]
    for one in (*few, *many):
        assert one.low <= one.error[0] <= one.probability <= one.error[1] <= one.high
    for one in many:
        assert one.how == "posterior draws"
        assert one.probability == pytest.approx(truth, rel=0.15)


def test_a_surrogate_without_a_joint_law_is_judged_by_the_ends_of_its_interval():
    """y = a is uniform on [0, 10], so that a fifth lies above 8; 0.05 sin(..) is unknown."""
    space = Space((Parameter("a", uniform(0, 10)), Parameter("b", uniform(0, 1))))
    plain = learnt(space, lambda a, b: a + 0.05 * np.sin(40.0 * b), LinearRegression())
    one = analyse(Failure("f", "y", 8.0, method="crude"), space, plain)
    assert one.how == "ends of the surrogate's interval"
    assert one.probability == pytest.approx(0.2, abs=0.015)
    assert one.error[0] < 0.2 < one.error[1]


def test_constraints_are_kept():
    """x uniform on [0, 10] with x <= 5: above 4 lies a fifth."""
    parameters = (Parameter("x", uniform(0, 10)), Parameter("z", uniform(0, 1)))
    space = Space(parameters, None, (parse("x <= 5", {"x": "", "z": ""}),))
    one = analyse(Failure("f", "y", 4.0), space, learnt(space, lambda x, z: x, Polynomial()))
    assert one.probability == pytest.approx(0.2, abs=0.005)
    assert one.design_point is None


def test_levels_of_a_parameter_have_no_design_point():
    space = Space((Parameter("k", levels=("a", "b")), Parameter("x", uniform(0, 1))))

    def of(k, x):
        return x + (k == "b")

    one = analyse(Failure("f", "y", 1.5), space, learnt(space, of, GaussianProcess()))
    assert one.probability == pytest.approx(0.25, abs=0.02)
    assert one.design_point is None


@pytest.mark.parametrize("above", [True, False])
def test_both_parts_of_the_interval_cover_a_noisy_plane(above):
    law = distribution("normal", mean=0.0, std=1.0, range=(-6.0, 6.0))
    space = Space((Parameter("a", law), Parameter("b", law)))
    generator = np.random.default_rng(1)
    coded = generator.uniform(-0.8, 0.8, (40, 2))
    values = 6.0 * coded.sum(axis=1) + 0.5 * generator.standard_normal(40)
    one = fit(space, coded, values, Linear())
    asked = Failure("f", "y", 4.5 if above else -4.5, 1 if above else -1)
    found = analyse(asked, space, one, confidence=0.99)
    assert found.error[0] < found.probability < found.error[1]
    assert found.low <= min(found.error[0], found.sampling[0])
    assert found.high >= max(found.error[1], found.sampling[1])
    assert found.low <= stats.norm.sf(4.5 / np.sqrt(2.0)) <= found.high
