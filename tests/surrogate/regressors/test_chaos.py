"""Polynomial chaos: orthonormality, exact recovery, indices, honest choice of terms."""

import numpy as np
import pytest
from scipy.stats import qmc
from sklearn.utils.estimator_checks import check_estimator

from surrogate.designs.regular_fraction import matrix as two_level
from surrogate.errors import FitError
from surrogate.regressors.chaos import PolynomialChaos
from surrogate.regressors.orthogonal import basis, hyperbolic
from surrogate.regressors.polynomial import Quadratic
from surrogate.regressors.pursuit import best_count, pursue
from surrogate.space.distributions import distribution, uniform
from surrogate.space.space import Parameter, Space

LAWS = {
    "uniform": uniform(2, 5),
    "normal": distribution("normal", mean=0, std=1),
    "truncated": distribution("normal", mean=1, std=1, range=(-2, 2)),
    "triangular": distribution("triangular", mode=0.2, range=(0, 1)),
    "beta": distribution("beta", a=2, b=5, range=(0, 1)),
}
MIXED = Space(
    (
        Parameter("t", LAWS["truncated"]),
        Parameter("cloth", levels=("p", "q", "r")),
        Parameter("u", LAWS["triangular"]),
    )
)


@pytest.mark.parametrize("law", LAWS)
def test_polynomials_are_orthonormal(law):
    """E[P_i P_j] = 1 where i = j and 0 elsewhere, by a rule of twice the order."""
    parameter = Parameter("x", LAWS[law])
    nodes, weights = parameter.quadrature(24)
    values = basis(parameter, 10).values(nodes)
    np.testing.assert_allclose((values * weights) @ values.T, np.eye(11), atol=1e-9)


def test_uniform_polynomials_are_legendres():
    """P_n is sqrt(2 n + 1) times Legendre's polynomial."""
    x = np.linspace(-1, 1, 31)
    legendre = np.polynomial.legendre.legvander(x, 6) * np.sqrt(2 * np.arange(7) + 1)
    np.testing.assert_allclose(
        basis(Parameter("x", uniform(0, 3)), 6).values(x), legendre.T, atol=1e-12
    )
    np.testing.assert_allclose(basis(None, 6).values(x), legendre.T, atol=1e-12)


def test_contrasts_are_orthonormal():
    values = basis(Parameter("x", levels=tuple("abcde")), 3).values(np.linspace(-1, 1, 5))
    np.testing.assert_allclose(values @ values.T / 5, np.eye(5), atol=1e-14)


def test_sizes_of_index_sets():
    """q = 1 gives binomial(d + p, p) terms; q -> 0 only main effects, d p + 1."""
    sizes = ((1, 2, 3),) * 4
    assert len(hyperbolic(sizes, 3, 1.0)) == 35
    assert len(hyperbolic(sizes, 3, 0.1)) == 13
    assert hyperbolic(sizes, 1, 0.75)[0] == ()


def test_pursuit_is_forward_least_squares():
    """Each column taken is the one whose addition leaves the smallest residual."""
    rng = np.random.default_rng(0)
    matrix, y = np.column_stack([np.ones(30), rng.normal(size=(30, 12))]), rng.normal(size=30)
    order = pursue(matrix, y, 6)
    for k in range(1, 6):
        left = [
            np.inf
            if j in order[:k]
            else np.linalg.lstsq(matrix[:, [*order[:k], j]], y, rcond=None)[1][0]
            for j in range(13)
        ]
        assert order[k] == int(np.argmin(left))


def test_error_of_the_choice_is_that_of_refits():
    """best_count's error: terms chosen and fitted without each fold, by brute force."""
    rng = np.random.default_rng(1)
    matrix = np.column_stack([np.ones(25), rng.normal(size=(25, 8))])
    y = matrix[:, 1] - matrix[:, 4] + 0.5 * rng.normal(size=25)
    folds = np.arange(25) % 5
    count, error = best_count(matrix, y, folds)
    squares = 0.0
    for k in range(5):
        rest = folds != k
        order = pursue(matrix[rest], y[rest], count)
        c = np.linalg.lstsq(matrix[rest][:, order], y[rest], rcond=None)[0]
        squares += ((y[~rest] - matrix[~rest][:, order] @ c) ** 2).sum()
    assert error == pytest.approx(squares / ((y - y.mean()) ** 2).sum(), rel=1e-9)


def test_the_truncation_is_chosen():
    """Sums of functions of one input want no interactions; products of four want more."""
    x = 2 * qmc.LatinHypercube(4, seed=0).random(80) - 1
    alone = PolynomialChaos().fit(x, np.exp(x).sum(axis=1) + np.cos(3 * x[:, 0]))
    assert alone.hyperbolic_ == 0.5
    product = PolynomialChaos().fit(x, (x[:, 0] + x[:, 1] * x[:, 2]) * x[:, 3] * x[:, 0])
    assert product.hyperbolic_ > 0.5 and product.error_ < 1e-20


def test_the_chosen_truncation_predicts_better():
    """Ishigami's interaction needs degrees that q = 0.75 leaves out: a fifth of its error."""
    new = np.random.default_rng(1).uniform(-1, 1, (1000, 3))
    errors = {}
    for q in (None, 0.75):
        found = []
        for seed in range(3):
            x = 2 * qmc.LatinHypercube(3, seed=seed).random(120) - 1
            model = PolynomialChaos(hyperbolic=q).fit(x, ishigami(x))
            found.append(np.sqrt(np.mean((model.predict(new) - ishigami(new)) ** 2)))
        errors[q] = np.median(found)
    assert errors[None] < 0.2 * errors[0.75]


def ishigami(coded):
    """Ishigami and Homma 1990 at coded points."""
    a, b, c = np.pi * coded.T
    return np.sin(a) + 7 * np.sin(b) ** 2 + 0.1 * c**4 * np.sin(a)


def test_errors_of_more_terms_than_a_fold_has():
    """A fold whose columns are used up keeps its error; the others go on."""
    rng = np.random.default_rng(3)
    matrix = np.column_stack([np.ones(12), rng.normal(size=(12, 3)), np.zeros(12)])
    matrix[9, 4] = 1.0  # seen by all folds but the last
    y, folds = rng.normal(size=12), np.arange(12) // 3
    count, error = best_count(matrix, y, folds)
    found = []
    for k in range(1, 6):
        squares = 0.0
        for fold in range(4):
            rest = folds != fold
            order = pursue(matrix[rest], y[rest], k)
            c = np.linalg.lstsq(matrix[rest][:, order], y[rest], rcond=None)[0]
            squares += ((y[~rest] - matrix[~rest][:, order] @ c) ** 2).sum()
        found.append(squares)
    assert count == int(np.argmin(found)) + 1
    assert error == pytest.approx(min(found) / ((y - y.mean()) ** 2).sum(), rel=1e-9)


def test_recovers_a_sparse_polynomial():
    """A cubic with four terms in six inputs from 60 of its 84 or more candidates' runs."""
    x = 2 * qmc.LatinHypercube(6, seed=0).random(60) - 1
    y = 1 + x[:, 0] ** 3 - 2 * x[:, 1] * x[:, 2] + 0.5 * x[:, 4] ** 2
    fitted = PolynomialChaos(hyperbolic=1.0, max_degree=4).fit(x, y)
    new = np.random.default_rng(0).uniform(-1, 1, (200, 6))
    expected = 1 + new[:, 0] ** 3 - 2 * new[:, 1] * new[:, 2] + 0.5 * new[:, 4] ** 2
    np.testing.assert_allclose(fitted.predict(new), expected, atol=1e-10)
    assert np.sum(np.abs(fitted.coef_) > 1e-10) == 5


def test_ishigami_indices():
    """Ishigami and Homma 1990, from 120 runs: all indices to 0.01."""
    space = Space(tuple(Parameter(f"x{j}", uniform(-np.pi, np.pi)) for j in range(3)))
    x = 2 * qmc.LatinHypercube(3, seed=1).random(120) - 1
    indices = PolynomialChaos(hyperbolic=1.0, space=space).fit(x, ishigami(x)).sobol_indices()
    np.testing.assert_allclose(indices.first_order, [0.31390519, 0.44241114, 0], atol=0.01)
    np.testing.assert_allclose(indices.total, [0.55758886, 0.44241114, 0.24368366], atol=0.01)
    assert indices.second_order[0, 2] == pytest.approx(0.24368366, abs=0.01)
    assert indices.variance == pytest.approx(13.844587940719254, rel=0.01)
    assert indices.mean == pytest.approx(3.5, rel=0.01)


def test_indices_equal_those_of_the_same_polynomial():
    """A quadratic on three laws, levels included: squares of coefficients are the exact indices."""
    x = MIXED.sample(80, seed=2)
    y = 1 + x[:, 0] * x[:, 2] + x[:, 2] ** 2 + np.where(x[:, 1] == 0, 2 * x[:, 0] + 1, 0.0)
    chaos = PolynomialChaos(hyperbolic=1.0, max_degree=2, space=MIXED).fit(x, y).sobol_indices()
    exact = Quadratic(MIXED).fit(x, y).sobol_indices()
    np.testing.assert_allclose(chaos.first_order, exact.first_order, atol=1e-9)
    np.testing.assert_allclose(chaos.total, exact.total, atol=1e-9)
    np.testing.assert_allclose(chaos.second_order, exact.second_order, atol=1e-9)
    assert chaos.variance == pytest.approx(exact.variance, rel=1e-9)
    assert chaos.mean == pytest.approx(exact.mean, rel=1e-9)


def test_noise_alone_is_not_taken_for_a_function():
    """Pure noise: few terms, and predictions no worse than 1.3 times the mean's error."""
    ratios = []
    for seed in range(10):
        rng = np.random.default_rng(seed)
        fitted = PolynomialChaos().fit(rng.uniform(-1, 1, (50, 4)), rng.normal(size=50))
        ratios.append(np.mean(fitted.predict(rng.uniform(-1, 1, (500, 4))) ** 2))
    assert np.median(ratios) < 0.3


def test_constant_output():
    x = np.random.default_rng(0).uniform(-1, 1, (10, 2))
    fitted = PolynomialChaos().fit(x, np.full(10, 4.0))
    np.testing.assert_allclose(fitted.predict(x), 4.0)
    assert fitted.indices_ == ((),) and fitted.sobol_indices().variance == 0.0


def test_correlated_inputs_have_no_closed_form():
    space = Space(tuple(Parameter(n, uniform(0, 1)) for n in "ab"), ((1.0, 0.3), (0.3, 1.0)))
    x = space.sample(20, seed=0)
    with pytest.raises(FitError, match="correlated"):
        PolynomialChaos(space=space).fit(x, x[:, 0]).sobol_indices()


def test_bad_options():
    with pytest.raises(ValueError, match="max_degree 0"):
        PolynomialChaos(max_degree=0).fit(np.ones((4, 1)), np.arange(4.0))


def test_scikit_learn_contract():
    """scikit-learn's own conformance suite."""
    check_estimator(PolynomialChaos(), on_skip=None)


def test_rounding_of_a_constant_is_no_term():
    """Values of 1/3, whose mean is off by a digit: one term, and no shares of a variance."""
    coded = np.random.default_rng(0).uniform(-1.0, 1.0, (25, 3))
    model = PolynomialChaos().fit(coded, np.full(25, 1.0 / 3.0))
    assert model.indices_ == ((),)
    assert model.sobol_indices().variance == 0.0 and not model.sobol_indices().total.any()


def test_rounding_does_not_choose_among_aliased_terms():
    """Eight runs of resolution III: main effects and products are one column, the first wins."""
    corners = two_level([1, 2, 4, 3, 5, 6, 7], 3)
    aliased = [corners[:, [0]] * corners[:, [1]], corners[:, [3]] * corners[:, [4]]]
    candidates = np.hstack([np.ones((8, 1)), np.sqrt(3.0) * corners, *(3.0 * x for x in aliased)])
    rng = np.random.default_rng(0)
    for _ in range(20):
        values, order = rng.standard_normal(8), rng.permutation(8)
        taken = pursue(candidates, values, 5)
        assert max(taken) <= 7
        assert pursue(candidates[order], values[order], 5) == taken
