"""RBD-FAST, quantile and target indices beside closed forms."""

import numpy as np
import pytest

from surrogate.errors import StudyError
from surrogate.sensitivity.quantile import quantile
from surrogate.sensitivity.rbd_fast import rbd_fast
from surrogate.sensitivity.target import target
from surrogate.space.distributions import distribution, uniform
from surrogate.space.space import Parameter, Space


def normals(count=3):
    return Space(
        tuple(Parameter(f"x{i}", distribution("normal", mean=0.0, std=1.0)) for i in range(count))
    )


def uniforms(count=3):
    return Space(tuple(Parameter(f"x{i}", uniform(0.0, 1.0)) for i in range(count)))


def weighted(space, *weights):
    """Sum of weights times physical values; inputs beyond the weights do nothing."""

    def f(coded):
        physical = space.decode(coded)
        return sum(w * np.asarray(physical[f"x{i}"]) for i, w in enumerate(weights))

    return f


def inside(found, name, expected):
    low, high = found[f"{name}_low"].values[0], found[f"{name}_high"].values[0]
    return (low <= np.array(expected) + 1e-12) & (np.array(expected) <= high + 1e-12)


def test_rbd_fast_gives_first_order_indices():
    """Ishigami's: 0.3139, 0.4424, 0 (a = 7, b = 0.1)."""
    space = Space(tuple(Parameter(f"x{i}", uniform(-np.pi, np.pi)) for i in range(3)))

    def ishigami(coded):
        x = space.decode(coded)
        x0, x1, x2 = (np.asarray(x[f"x{i}"]) for i in range(3))
        return np.sin(x0) + 7.0 * np.sin(x1) ** 2 + 0.1 * x2**4 * np.sin(x0)

    found = rbd_fast(ishigami, space, samples=4096, seed=0)
    np.testing.assert_allclose(
        found["first_order_rbd"].values[0], [0.3139, 0.4424, 0.0], atol=0.015
    )


@pytest.mark.parametrize("probability", [0.5, 0.9])
def test_quantile_share_of_a_sum_of_normals(probability):
    """The loss at a quantile of a normal law is in proportion to its deviation: with the share
    s of the variance known, sqrt(1 - s) of it is left, whatever the quantile."""
    space = normals()
    found = quantile(
        weighted(space, 2.0, 1.0), space, probability=probability, samples=2**14, seed=0
    )
    exact = 1.0 - np.sqrt(1.0 - np.array([0.8, 0.2, 0.0]))
    np.testing.assert_allclose(found["quantile_share"].values[0], exact, atol=0.02)


def test_a_quantile_has_parameters_of_its_own():
    """x0 moves the middle, x1 the tail only, above 0.8: the larger quantile is more of x1's."""
    space = uniforms(2)

    def f(coded):
        x = space.decode(coded)
        return np.asarray(x["x0"]) + 5.0 * np.maximum(0.0, np.asarray(x["x1"]) - 0.8)

    middle, tail = (
        quantile(f, space, probability=p, seed=0)["quantile_share"].values[0] for p in (0.3, 0.98)
    )
    assert middle[0] > 2.0 * middle[1] and tail[1] > 2.0 * tail[0]


def test_target_of_a_corner():
    """Z = [x0 + x1 > 1.5] on the square: p = 1/8, and Var P(Z | x0) in closed form.

    P(Z | x0) = x0 - 0.5 above 0.5, so that its mean square is 1/24.
    """
    space = uniforms(3)
    found = target(weighted(space, 1.0, 1.0), space, above=1.5, seed=0)
    p = 1.0 / 8.0
    first = (1.0 / 24.0 - p**2) / (p * (1 - p))
    expected = np.array([first, first, 0.0])
    np.testing.assert_allclose(found["first_order"].values[0], expected, atol=0.01)
    np.testing.assert_allclose(found["total"].values[0], [1 - first, 1 - first, 0.0], atol=0.01)
    assert inside(found, "first_order", expected).all()
    assert found["probability"].values[0] == pytest.approx(p, abs=0.003)
    below = target(weighted(space, -1.0, -1.0), space, below=-1.5, seed=0)
    np.testing.assert_allclose(below["total"].values, found["total"].values, atol=0.01)


def test_what_never_happens_has_no_indices():
    """Nowhere above, no limit for this output, both limits."""
    space = uniforms(2)
    f = weighted(space, 1.0, 1.0)
    nowhere = target(f, space, above=3.0)
    assert "nowhere above 3" in nowhere["refused"].item()
    assert np.isnan(nowhere["total"]).all()
    assert "No limit is given" in target(f, space, above={"other": 1.0})["refused"].item()
    with pytest.raises(StudyError, match="above: or below:"):
        target(f, space)


def test_the_surrogate_error_widens_the_interval_of_a_target(gaussian_fits):
    """Few runs, wide; many runs, narrow; both hold the function's own indices."""
    few, many, truth, space = gaussian_fits
    exact = target(truth, space, above=0.8, seed=0)["total"].values[0]
    widths = []
    for one in (few, many):
        found = target(one, space, above=0.8, seed=0)
        assert inside(found, "total", exact).all()
        widths.append((found["total_high"] - found["total_low"]).values.mean())
    assert widths[1] < 0.5 * widths[0]


@pytest.fixture(scope="module")
def gaussian_fits():
    from surrogate.fitting.fit import fit
    from surrogate.regressors.gaussian_process import GaussianProcess

    space = uniforms(2)

    def truth(coded):
        x = space.decode(coded)
        return np.sin(3.0 * np.asarray(x["x0"])) * (0.4 + np.asarray(x["x1"]))

    few, many = (
        fit(space, coded, truth(coded), GaussianProcess())
        for coded in (space.sample(8, seed=3), space.sample(60, seed=4))
    )
    return few, many, truth, space


@pytest.mark.parametrize(
    "options, said",
    [
        ({"probability": 1.0}, "probability: 1"),
        ({"probability": 0.999, "samples": 4096}, "samples"),
    ],
)
def test_quantiles_that_cannot_be(options, said):
    """Ends of the law, too few points in the tail of a slice."""
    space = uniforms(2)
    with pytest.raises(StudyError, match=said):
        quantile(weighted(space, 1.0, 1.0), space, **options)
