"""Shares of the variance of groups of parameters."""

from __future__ import annotations

import numpy as np
import pytest

from surrogate.errors import StudyError
from surrogate.fitting.fit import fit
from surrogate.regressors.chaos import PolynomialChaos
from surrogate.regressors.gaussian_process import GaussianProcess
from surrogate.regressors.polynomial import Quadratic
from surrogate.sensitivity.shapley import shapley
from surrogate.sensitivity.sobol import sobol
from surrogate.space.distributions import uniform
from surrogate.space.space import Parameter, Space

SPACE = Space(tuple(Parameter(name, uniform(-1.0, 1.0)) for name in "abcd"))
GROUPS = {"one": ["a", "b"], "two": ["c"]}
#: Parts of the variance of `polynomial`: V_a, V_ab, V_bc, V_d.
PARTS = np.array([1 / 3, 4 / 9, 1 / 9, 1 / 12])


def polynomial(x):
    """a + 2 a b + b c + d / 2 on uniform [-1, 1]: the square of a product is 1/9 on average."""
    return x[:, 0] + 2.0 * x[:, 0] * x[:, 1] + x[:, 1] * x[:, 2] + 0.5 * x[:, 3]


def fitted(estimator, values=polynomial):
    coded = SPACE.sample(60, seed=3)
    return fit(SPACE, coded, values(coded), estimator, surrogate="tested")


@pytest.mark.parametrize("estimator", [Quadratic(), PolynomialChaos(max_degree=3)])
def test_closed_and_total_index_of_a_group_in_closed_form(estimator):
    """Sobol' 1993: closed S_G sums the parts inside G, T_G the parts that touch G."""
    found = sobol(fitted(estimator), SPACE, groups=GROUPS, draws=5).isel(output=0)
    np.testing.assert_allclose(
        found["group_first_order"], [PARTS[:2].sum() / PARTS.sum(), 0.0], atol=1e-9
    )
    np.testing.assert_allclose(
        found["group_total"], [PARTS[:3].sum() / PARTS.sum(), PARTS[2] / PARTS.sum()], atol=1e-9
    )
    assert (found["group_total_sampling"] == 0.0).all()
    assert found["members"].values.tolist() == ["a, b", "c"]


def test_interaction_of_two_groups():
    """The part b c is what the groups {a, b} and {c} make together, and d is apart."""
    second = fitted(Quadratic()).estimator.sobol_indices([[0, 1], [2], [3]]).second_order
    exact = np.zeros((3, 3))
    exact[0, 1] = exact[1, 0] = PARTS[2] / PARTS.sum()
    np.testing.assert_allclose(second, exact, atol=1e-9)


def test_groups_of_one_have_the_indices_of_their_inputs():
    """With each input a group of its own nothing changes, for a process and its draws."""
    process = fitted(GaussianProcess()).estimator
    alone = [[j] for j in range(SPACE.size)]
    for one in (process, process.posterior_draws(1, seed=2)[0]):
        for name in ("first_order", "total", "second_order", "variance"):
            np.testing.assert_allclose(
                getattr(one.sobol_indices(alone), name),
                getattr(one.sobol_indices(), name),
                atol=1e-6,
                rtol=1e-6,
            )


def test_exact_and_sampled_indices_of_groups_agree():
    """Pick-freeze with whole groups estimates what the closed form of a process gives."""
    one = fitted(GaussianProcess())
    exact = sobol(one, SPACE, groups=GROUPS, draws=0).isel(output=0)
    sampled = sobol(one, SPACE, groups=GROUPS, draws=0, exact=False, confidence=0.999).isel(
        output=0
    )
    for name in ("group_first_order", "group_total"):
        assert (np.abs(exact[name] - sampled[name]) <= sampled[f"{name}_sampling"] + 1e-4).all()
        assert float(sampled[f"{name}_sampling"].max()) < 0.02


def test_fields_have_indices_of_groups():
    """Of a field with two places, the variance-weighted indices (Lamboni et al. 2011)."""

    def values(x):
        return np.column_stack([x[:, 0] + x[:, 1], 2.0 * x[:, 3]])

    found = sobol(fitted(Quadratic(), values), SPACE, groups=GROUPS, draws=3).isel(output=0)
    np.testing.assert_allclose(found["group_total"], [1 / 3, 0.0], atol=1e-9)


@pytest.mark.parametrize("estimator", [Quadratic(), GaussianProcess()])
def test_shapley_effect_of_a_group_is_the_sum_of_its_members(estimator):
    """Shapley effects add up; half of V_bc goes to b and half to c."""
    found = shapley(fitted(estimator), SPACE, groups=GROUPS, samples=2**10, draws=10).isel(output=0)
    np.testing.assert_allclose(found["group_shapley"][0], found["shapley"][:2].sum(), atol=1e-12)
    exact = np.array([PARTS[:2].sum() + PARTS[2] / 2, PARTS[2] / 2]) / PARTS.sum()
    assert (found["group_shapley_low"] - 1e-9 <= exact).all()
    assert (found["group_shapley_high"] + 1e-9 >= exact).all()


def test_the_sum_of_a_group_is_surer_than_its_members():
    """Sampling errors of members cancel: all inputs in one group have the share 1 exactly."""
    found = shapley(polynomial, SPACE, groups={"all": list("abcd")}, samples=2**8).isel(output=0)
    np.testing.assert_allclose(found["group_shapley"], [1.0], atol=1e-12)
    assert float(found["group_shapley_sampling"].max()) < 1e-12
    assert float(found["shapley_sampling"].max()) > 1e-6


def test_groups_that_overlap_or_are_unknown_are_refused():
    """Every mistake in one error."""
    with pytest.raises(StudyError) as caught:
        sobol(polynomial, SPACE, groups={"one": ["a", "e"], "two": ["a"], "three": []})
    assert len(caught.value.mistakes) == 3
