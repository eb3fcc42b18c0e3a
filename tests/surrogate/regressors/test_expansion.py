"""Sums of products of orthonormal functions: against `anova`, which knows no orthonormality."""

import numpy as np
import pytest

from surrogate.regressors import anova
from surrogate.regressors.expansion import Products, moved_indices

NODES, WEIGHTS = np.polynomial.legendre.leggauss(12)
WEIGHTS = WEIGHTS / 2.0


def orthonormal_functions(size):
    """Six functions (6, m) orthonormal on [-1, 1], whose means are not zero."""
    root = np.sqrt(WEIGHTS)[:, None]
    powers = np.exp(NODES)[:, None] * NODES[:, None] ** np.arange(6)
    return (np.linalg.qr(root * powers)[0] / root).T[:size]


@pytest.mark.parametrize("groups", [None, [[0, 2], [1], [3]], [[1, 3], [0]]])
def test_indices_equal_those_of_sums_of_products(groups):
    """Mean and deviations of 40 random terms in four inputs, each sum measured by `anova`."""
    rng = np.random.default_rng(0)
    functions = orthonormal_functions(6)
    numbers = np.unique(rng.integers(0, 6, (40, 4)), axis=0)
    mean = rng.normal(size=len(numbers))
    deviations = 0.3 * rng.normal(size=(len(numbers), 3))
    factors = [functions[own] for own in numbers.T]

    def indices(coefficients):
        return anova.sobol_indices(coefficients, factors, [WEIGHTS] * 4, groups)

    products = Products(numbers, (functions @ WEIGHTS)[numbers])
    found = moved_indices(indices(mean), products, mean, deviations, groups)
    for one, deviation in zip(found, deviations.T, strict=True):
        expected = indices(mean + deviation)
        for name in ("first_order", "total", "second_order", "variance", "mean"):
            np.testing.assert_allclose(getattr(one, name), getattr(expected, name), atol=1e-11)
