"""Shapley effects against closed forms, independent and dependent."""

from itertools import permutations
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.special import ndtri

from surrogate.fitting.fit import fit
from surrogate.regressors.anova import SobolIndices
from surrogate.regressors.chaos import PolynomialChaos
from surrogate.regressors.gaussian_process import GaussianProcess
from surrogate.regressors.polynomial import Quadratic
from surrogate.sensitivity import shapley as module
from surrogate.sensitivity.conditional import Pairs
from surrogate.sensitivity.shapley import shapley
from surrogate.space.distributions import distribution, uniform
from surrogate.space.space import Parameter, Space


def gaussian_space(correlation):
    normal = distribution("normal", mean=0.0, std=1.0)
    names = [f"x{j}" for j in range(len(correlation))]
    return Space(tuple(Parameter(name, normal) for name in names), tuple(map(tuple, correlation)))


def linear(beta):
    """beta' z with z the standard normal scores that coded = 2 F(z) - 1 stands for."""
    return lambda coded: ndtri(np.clip((coded + 1.0) / 2.0, 1e-15, 1 - 1e-15)) @ np.asarray(beta)


def exact_linear_gaussian(beta, covariance):
    """Shapley effects of beta' z from Var(beta' z | z outside S), by all orders."""
    beta, d = np.asarray(beta, dtype=float), len(beta)

    def cost(subset):
        inside, outside = list(subset), [j for j in range(d) if j not in subset]
        rest = covariance[np.ix_(inside, inside)]
        if outside:
            shift = covariance[np.ix_(inside, outside)]
            rest = rest - shift @ np.linalg.solve(covariance[np.ix_(outside, outside)], shift.T)
        return beta[inside] @ rest @ beta[inside]

    effects = np.zeros(d)
    orders = list(permutations(range(d)))
    for order in orders:
        for k, i in enumerate(order):
            effects[i] += cost(order[: k + 1]) - (cost(order[:k]) if k else 0.0)
    return effects / len(orders) / (beta @ covariance @ beta)


def test_two_correlated_gaussian_inputs(reference):
    """Owen and Prieur 2017, section 4.1: rho = 1/2, beta = (1, 1): 1/2 each; 3/4 and 1/4."""
    facts = reference["dependent_inputs"]["linear_gaussian_2_rho_0.5"]
    effects = shapley(linear(facts["beta"]), gaussian_space(facts["cov"]), seed=1).isel(output=0)
    np.testing.assert_allclose(effects["shapley"], facts["shapley"], atol=3e-3)
    np.testing.assert_allclose(
        effects["closed_first_order"], list(facts["closed_first"].values()), atol=4e-3
    )
    np.testing.assert_allclose(
        effects["independent_total"], list(facts["total_independent"].values()), atol=4e-3
    )


@pytest.mark.parametrize("rho", [-0.7, 0.0, 0.9])
def test_three_inputs_of_which_two_are_correlated(rho):
    """Linear Gaussian model with beta = (1, 2, 1) and rho between the last two, any sign."""
    covariance = np.eye(3)
    covariance[1, 2] = covariance[2, 1] = rho
    exact = exact_linear_gaussian([1.0, 2.0, 1.0], covariance)
    effects = shapley(linear([1.0, 2.0, 1.0]), gaussian_space(covariance), confidence=0.999)
    assert (np.abs(effects["shapley"][0] - exact) <= effects["shapley_sampling"][0]).all()
    assert float(effects["shapley_sampling"].max()) < 0.02


def test_input_that_acts_only_through_its_correlation_gets_a_share():
    """beta = (1, 0) with rho = 0.8: effects (1 - rho^2 / 2, rho^2 / 2), indices of it 0 and 1."""
    effects = shapley(linear([1.0, 0.0]), gaussian_space([[1.0, 0.8], [0.8, 1.0]])).isel(output=0)
    np.testing.assert_allclose(effects["shapley"], [0.68, 0.32], atol=4e-3)
    np.testing.assert_allclose(effects["independent_total"][1], 0.0, atol=1e-12)


def test_partners_have_the_joint_law_and_keep_what_is_outside():
    """Correlations of redrawn points are the copula's; other coordinates do not move."""
    covariance = np.array([[1.0, 0.6, 0.3], [0.6, 1.0, -0.2], [0.3, -0.2, 1.0]])
    space = gaussian_space(covariance)
    pairs = Pairs.of(space, np.random.default_rng(2).random((200_000, 6)))
    moved = pairs.partners((0, 2))
    np.testing.assert_array_equal(moved[:, 1], pairs.points()[:, 1])
    scores = ndtri((moved + 1.0) / 2.0)
    np.testing.assert_allclose(np.cov(scores.T), covariance, atol=0.015)
    fresh = np.corrcoef(scores[:, 0], pairs.scores[:, 0])[0, 1]
    assert fresh == pytest.approx(0.36, abs=0.01)


@pytest.mark.parametrize("name", ["ishigami", "piston"])
def test_independent_effects_lie_between_first_order_and_total(name, textbook):
    """S_i <= Sh_i <= T_i and sum Sh = 1 (Owen 2014); Ishigami's in closed form."""
    case = textbook(name)
    effects = shapley(case.function, case.space, confidence=0.999).isel(output=0)
    half = effects["shapley_sampling"].values
    assert (effects["shapley"] >= case.first_order - half).all()
    assert (effects["shapley"] <= case.total + half).all()
    assert float(effects["shapley"].sum()) == pytest.approx(1.0, abs=1e-3)
    if name == "ishigami":
        exact = list(case.facts["shapley"].values())
        assert (np.abs(effects["shapley"] - exact) <= half).all()


def test_second_order_surrogate_has_closed_form_effects():
    """f = x + 2 x y: V_x = 1/3, V_xy = 4/9; the interaction is shared equally."""
    space = Space((Parameter("x", uniform(-1.0, 1.0)), Parameter("y", uniform(-1.0, 1.0))))
    coded = space.sample(20, seed=3)
    surrogate = fit(
        space,
        coded,
        coded[:, 0] + 2.0 * coded[:, 0] * coded[:, 1],
        Quadratic(),
        surrogate="tested",
        output="y",
    )
    effects = shapley(surrogate, space).isel(output=0)
    assert effects.attrs["computed"] == "closed form"
    np.testing.assert_allclose(effects["shapley"], [5 / 7, 2 / 7], atol=1e-9)


def test_random_orders_agree_with_all_subsets(monkeypatch, textbook):
    """Above `ALL_SUBSETS` inputs; here forced on the eight of the G function."""
    case = textbook("sobol_g")
    monkeypatch.setattr(module, "ALL_SUBSETS", 2)
    effects = shapley(case.function, case.space, samples=2**11, confidence=0.999).isel(output=0)
    variances = np.array([1.0 / (3.0 * (1.0 + a) ** 2) for a in case.facts["a"]])
    exact = [
        sum(np.prod(variances[list(s)]) / len(s) for s in subsets_with(i, 8)) for i in range(8)
    ] / (np.prod(1.0 + variances) - 1.0)
    assert (np.abs(effects["shapley"] - exact) <= effects["shapley_sampling"] + 1e-6).all()


def subsets_with(i, d):
    """All subsets of range(d) that hold i."""
    return [tuple(j for j in range(d) if mask >> j & 1) for mask in range(2**d) if mask >> i & 1]


def test_gaussian_process_shows_its_own_part(textbook):
    """Posterior draws widen the interval beyond sampling."""
    case = textbook("ishigami")
    coded = case.space.sample(60, seed=4)
    surrogate = fit(
        case.space, coded, case.function(coded), GaussianProcess(), surrogate="tested", output="y"
    )
    effects = shapley(surrogate, case.space, samples=2**10, draws=20)
    assert (effects["shapley_surrogate"] > 0.0).all()
    assert effects.attrs["surrogate_part"].startswith("posterior draws")


@pytest.mark.parametrize("ripple", [0.0, 4e-16])
def test_constant_output_has_no_shares(ripple):
    """No variance to share, nor is rounding shared out."""
    effects = shapley(lambda x: 3.0 + ripple * x[:, 0], gaussian_space(np.eye(2)))
    assert (effects["shapley"] == 0.0).all() and (effects["shapley_high"] == 0.0).all()


def test_draws_of_higher_order_than_the_fit():
    """A fit of second order has refits with terms of third order, or with none at all."""
    space = Space(tuple(Parameter(f"x{j}", uniform(0.0, 1.0)) for j in range(3)))
    coded = space.sample(25, seed=1)
    noise = 0.3 * np.random.default_rng(0).standard_normal(25)
    values = coded[:, 0] + 0.5 * coded[:, 1] ** 2 + 0.3 * coded[:, 0] * coded[:, 2] + noise
    effects = shapley(fit(space, coded, values, PolynomialChaos()), space)
    assert effects.attrs["computed"] == "closed form"
    assert effects["shapley"].sum() == pytest.approx(1.0, abs=1e-9)
    assert (effects["shapley_surrogate"] > 0.0).all()


def test_closed_effects_are_exact_up_to_third_order():
    """Owen 2014, theorem 1: each share of the variance is split evenly among its inputs."""
    second = np.array([[0.0, 0.1, 0.0], [0.1, 0.0, 0.05], [0.0, 0.05, 0.0]])
    indices = SobolIndices(np.array([0.3, 0.2, 0.05]), np.array([0.7, 0.65, 0.4]), second, 1.0, 0.0)
    effects = module._closed(SimpleNamespace(sobol_indices=lambda: indices))[0]
    np.testing.assert_allclose(effects, [0.35 + 0.1, 0.275 + 0.1, 0.075 + 0.1], rtol=1e-12)
