"""Lenth's method, Box and Cox's power, canonical analysis: beside published ones and theory."""

import numpy as np
import pytest
from scipy import stats

from surrogate.designs.central_composite import central_composite
from surrogate.designs.full_factorial import full_factorial
from surrogate.regressors.box_cox import box_cox
from surrogate.regressors.canonical import canonical
from surrogate.regressors.least_squares import least_squares
from surrogate.regressors.lenth import lenth, of_saturated
from surrogate.regressors.polynomial import Interactions, Linear, Quadratic
from surrogate.space.distributions import uniform
from surrogate.space.space import Parameter, Space


def cube(count):
    return Space(tuple(Parameter(f"x{i}", uniform(-1.0, 1.0)) for i in range(count)))


def test_lenth_by_hand():
    """Fifteen effects of which three are large: s0 = 1.5 x 0.8, PSE = 1.5 x 0.6."""
    effects = np.array([10, -8, 6, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.1, 1.2])
    found = lenth(effects)
    inner = np.abs(effects)[np.abs(effects) < 2.5 * 1.5 * np.median(np.abs(effects))]
    assert found.pse == pytest.approx(1.5 * np.median(inner))
    assert found.margin == pytest.approx(stats.t.ppf(0.975, 5.0) * found.pse)  # Lenth: 2.571 PSE
    assert (np.abs(effects) > found.margin).tolist() == [True] * 3 + [False] * 12


def test_lenth_errs_less_often_than_it_says():
    """Of 15 effects that are noise fewer than 5 % are beyond the margin, and in fewer than 5 % of
    the experiments one is beyond the simultaneous one: t is conservative (Ye and Hamada 2000,
    doi 10.1080/00224065.2000.11979971), but not without power."""
    rng = np.random.default_rng(0)
    noise = rng.standard_normal((4000, 15))
    found = [lenth(row) for row in noise]
    alone = np.mean([np.mean(np.abs(row) > f.margin) for row, f in zip(noise, found, strict=True)])
    together = np.mean(
        [(np.abs(row) > f.simultaneous).any() for row, f in zip(noise, found, strict=True)]
    )
    assert 0.02 < alone < 0.05
    assert 0.01 < together < 0.05


def test_only_saturated_orthogonal_fits_have_lenths_margin():
    """The 2^3 with one degree of freedom left has none; with all products it has."""
    space = cube(3)
    coded = full_factorial(space)
    y = 5 + 3 * coded[:, 0] + np.random.default_rng(1).normal(0, 0.1, 8)
    assert of_saturated(Interactions(space).fit(coded, y).model_) is None  # one degree is left
    signs = np.column_stack(
        [np.ones(8), coded, coded[:, [0]] * coded[:, [1]], coded[:, [0]] * coded[:, [2]],
         coded[:, [1]] * coded[:, [2]], coded.prod(axis=1)]
    )  # fmt: skip
    found = of_saturated(least_squares(signs, y, [str(k) for k in range(8)]))
    assert found is not None and 0.0 < found.margin < 3.0


@pytest.mark.parametrize(
    "power, words", [(0.0, "log y"), (0.5, "sqrt(y)"), (-1.0, "1 / y"), (1.0, "")]
)
def test_box_cox_finds_the_power_that_was_used(power, words):
    """y^power is a plane with a little noise; the interval holds the power, 1 needs none."""
    rng = np.random.default_rng(2)
    x = rng.uniform(-1, 1, (60, 3))
    plane = 3.0 + x @ [1.0, -0.5, 0.3] + rng.normal(0.0, 0.03, 60)
    y = np.exp(plane) if power == 0.0 else plane ** (1.0 / power)
    found = box_cox(Linear(cube(3)).fit(x, y).model_)
    assert found.low <= power <= found.high
    assert found.high - found.low < 1.0
    assert found.transformation == words


def test_box_cox_agrees_with_scipy_without_inputs():
    """Only the mean in the model: scipy's boxcox maximises the same likelihood."""
    y = stats.lognorm(0.8).rvs(200, random_state=3) + 0.2
    model = least_squares(np.ones((200, 1)), y, ["1"])
    _, best, interval = stats.boxcox(y, alpha=0.05)
    found = box_cox(model)
    assert found.best == pytest.approx(best, abs=0.0126)
    assert (found.low, found.high) == pytest.approx(interval, abs=0.026)


def test_powers_mean_nothing():
    """Negative values, hardly any spread, an exact fit."""
    x = np.random.default_rng(0).uniform(-1, 1, (20, 2))
    noise = np.random.default_rng(1).normal(0, 0.1, 20)
    assert box_cox(Linear(cube(2)).fit(x, x[:, 0] + noise).model_) is None
    assert box_cox(Linear(cube(2)).fit(x, 100.0 + x[:, 0] + noise).model_) is None
    assert box_cox(Linear(cube(2)).fit(x, 3.0 + x[:, 0]).model_) is None


def of(coded, y, count=2):
    one = Quadratic(cube(count)).fit(coded, y)
    return canonical(one.terms_, one.columns_, one.model_)


def test_the_chemical_process_of_montgomery():
    """Yield of example 11.2 (Montgomery 2012, table 11.6): stationary point (0.389, 0.306),
    eigenvalues -0.9634 and -1.4143, a maximum, in factorial units."""
    root = 2.0**0.5
    star = [(root, 0), (-root, 0), (0, root), (0, -root)]
    x = np.array([(-1, -1), (-1, 1), (1, -1), (1, 1), *[(0, 0)] * 5, *star])
    y = np.array([76.5, 77.0, 78.0, 79.5, 79.9, 80.3, 80.0, 79.7, 79.8, 78.4, 75.6, 78.5, 77.0])
    found = of(x, y)
    np.testing.assert_allclose(found.stationary, [0.389, 0.306], atol=6e-4)
    np.testing.assert_allclose(found.values, [-1.4143, -0.9634], atol=6e-4)
    assert found.kind == "maximum" and found.inside
    np.testing.assert_allclose(80.21, 79.94 + found.at(found.stationary), atol=6e-3)


@pytest.mark.parametrize(
    "squares, kind",
    [
        ([[1.0, 0.2], [0.2, 2.0]], "minimum"),
        ([[1.0, 0.0], [0.0, -1.0]], "saddle"),
        ([[-1.0, 0.0], [0.0, 0.001]], "ridge"),
    ],
)
def test_kinds(squares, kind):
    """Known quadratics with a little noise; what cannot be told from zero is a ridge."""
    rng = np.random.default_rng(4)
    x = np.vstack([central_composite(cube(2)), rng.uniform(-1, 1, (20, 2))])
    y = x @ [0.5, -0.3] + np.einsum("ni,ij,nj->n", x, squares, x) + rng.normal(0, 0.01, len(x))
    assert of(x, y).kind == kind


def test_errors_of_eigenvalues_cover():
    """In 95 % of 400 noisy experiments the interval holds the eigenvalue, within the 99 % band."""
    rng = np.random.default_rng(5)
    x = np.vstack([central_composite(cube(2)), rng.uniform(-1, 1, (10, 2))])
    true = np.array([-2.0, -0.5])
    exact = x @ [0.3, 0.2] + x**2 @ true
    held = [
        np.abs(found.values - true) <= found.errors
        for found in (of(x, exact + rng.normal(0, 0.1, len(x))) for _ in range(400))
    ]
    assert np.mean(held) == pytest.approx(0.95, abs=2.6 * np.sqrt(0.95 * 0.05 / 800) + 0.01)


@pytest.mark.parametrize("largest", [True, False])
@pytest.mark.parametrize("radius", [0.3, 1.0, 2.0])
def test_the_ridge_is_the_best_point_at_its_distance(largest, radius):
    """Beside a fine search on the circle."""
    rng = np.random.default_rng(6)
    x = np.vstack([central_composite(cube(2)), rng.uniform(-1, 1, (20, 2))])
    found = of(x, x @ [0.5, -0.3] + x[:, 0] ** 2 - 0.7 * x[:, 0] * x[:, 1])
    point = found.ridge(radius, largest=largest)
    assert np.linalg.norm(point) == pytest.approx(radius)
    angles = np.linspace(0, 2 * np.pi, 40_001)
    values = [found.at(radius * np.array([np.cos(a), np.sin(a)])) for a in angles]
    best = max(values) if largest else min(values)
    assert found.at(point) == pytest.approx(best, abs=1e-6)


def test_what_is_no_full_quadratic_has_no_canonical_form():
    """A plane, squares that the runs do not tell."""
    x = full_factorial(cube(2))
    assert of(x, x @ [1.0, 2.0]) is None
    plane = Linear(cube(2)).fit(x, x @ [1.0, 2.0])
    assert canonical(plane.terms_, plane.columns_, plane.model_) is None
