"""Exact indices of sums of products against closed forms from the literature."""

import numpy as np
import pytest

from surrogate.regressors import anova
from surrogate.space.distributions import distribution, uniform
from surrogate.space.space import Parameter, Space


def of_products(coefficients, functions, space, order=40):
    """Indices of sum_t c_t prod_j functions[t][j](coded x_j)."""
    rules = anova.quadratures(space, space.size, order)
    factors = [
        np.array([np.broadcast_to(term[j](nodes), nodes.shape) for term in functions])
        for j, (nodes, _) in enumerate(rules)
    ]
    return anova.sobol_indices(coefficients, factors, [w for _, w in rules])


def one(x):
    return 1.0


def test_ishigami():
    """Ishigami and Homma 1990, a = 7, b = 0.1: S = 0.3139, 0.4424, 0; S13 = 0.2437."""
    space = Space(tuple(Parameter(f"x{j}", uniform(-np.pi, np.pi)) for j in range(3)))
    sine = lambda x: np.sin(np.pi * x)  # noqa: E731
    indices = of_products(
        [1.0, 7.0, 0.1],
        [
            (sine, one, one),
            (one, lambda x: sine(x) ** 2, one),
            (sine, one, lambda x: (np.pi * x) ** 4),
        ],
        space,
    )
    assert indices.mean == pytest.approx(3.5, rel=1e-12)
    assert indices.variance == pytest.approx(13.844587940719254, rel=1e-12)
    np.testing.assert_allclose(
        indices.first_order, [0.31390519114781146, 0.4424111447900409, 0], atol=1e-12
    )
    np.testing.assert_allclose(
        indices.total, [0.5575888552099592, 0.4424111447900409, 0.24368366406214773], atol=1e-12
    )
    assert indices.second_order[0, 2] == pytest.approx(0.24368366406214773, rel=1e-12)
    assert abs(indices.second_order[[0, 1], [1, 2]]).max() < 1e-12


def test_product_function():
    """prod (1 + a_i x_i): V_i = a_i^2 / 3 and V + 1 = prod (1 + V_i) (Sobol' 1993)."""
    a = np.array([0.9, 0.5, 0.1])
    space = Space(tuple(Parameter(f"x{j}", uniform(0, 1)) for j in range(3)))
    term = tuple(lambda x, a=a_j: 1 + a * x for a_j in a)
    indices = of_products([1.0], [term], space)
    part = a**2 / 3
    total = np.prod(1 + part) - 1
    np.testing.assert_allclose(indices.first_order, part / total, rtol=1e-12)
    np.testing.assert_allclose(
        indices.total, part * np.prod(1 + part) / (1 + part) / total, rtol=1e-12
    )
    np.testing.assert_allclose(
        indices.second_order[0], [0, *part[0] * part[1:] / total], rtol=1e-12
    )


def test_any_law_and_levels():
    """f = x + g(level) + x g(level): a truncated normal x (mean 0) and three levels."""
    space = Space(
        (
            Parameter("x", distribution("normal", mean=0, std=1, range=(-2, 2))),
            Parameter("level", levels=("a", "b", "c")),
        )
    )
    level = lambda t: np.select([t < -0.5, t > 0.5], [1.0, 3.0], -4.0)  # noqa: E731
    coded = lambda x: 2 * x  # noqa: E731
    indices = of_products([1.0, 1.0, 1.0], [(coded, one), (one, level), (coded, level)], space)
    phi, mass = np.exp(-2) / np.sqrt(2 * np.pi), 0.9544997361036416
    v_x, v_level = 1 - 2 * 2 * phi / mass, 26 / 3
    variance = v_x + v_level + v_x * v_level
    assert indices.variance == pytest.approx(variance, rel=1e-11)
    np.testing.assert_allclose(
        indices.first_order, [v_x / variance, v_level / variance], rtol=1e-11
    )
    assert indices.second_order[0, 1] == pytest.approx(v_x * v_level / variance, rel=1e-11)


def test_constant_has_no_indices():
    space = Space((Parameter("x", uniform(0, 1)), Parameter("y", uniform(0, 1))))
    indices = of_products([3.0, -1.0], [(one, one), (one, one)], space)
    assert indices.mean == pytest.approx(2.0) and indices.variance == 0.0
    assert not indices.first_order.any() and not indices.total.any()


def test_no_digits_are_lost_when_terms_cancel():
    """1e8 (x + 1) - 1e8 + y: large terms that cancel leave Var = (1e16 + 1) / 3 split exactly."""
    space = Space((Parameter("x", uniform(0, 1)), Parameter("y", uniform(0, 1))))
    small = lambda x: 1e-8 * x + 1  # noqa: E731
    indices = of_products([1e8, -1e8, 1.0], [(small, one), (one, one), (one, lambda x: x)], space)
    np.testing.assert_allclose(indices.first_order, [0.5, 0.5], atol=1e-7)
