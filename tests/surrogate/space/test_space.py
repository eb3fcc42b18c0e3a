"""Parameters and spaces: coding there and back, laws, quadrature, copula."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from surrogate.errors import StudyError
from surrogate.space.distributions import distribution, uniform
from surrogate.space.space import Parameter, Space

LAWS = {
    "uniform": uniform(0.059, 0.137),
    "normal": distribution("normal", mean=5.0, std=1.0),
    "truncated": distribution("normal", mean=5.0, std=1.0, range=(2.0, 8.0)),
    "lognormal": distribution("lognormal", mean=2.0, std=0.5),
    "triangular": distribution("triangular", mode=0.2, range=(0.0, 1.0)),
    "gamma": distribution("gamma", a=2.0, scale=3.0),
}


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_decoding_gives_back_the_physical_value(law):
    """decode(encode(x)) = x to rounding, for values through the whole law."""
    parameter = Parameter("x", law)
    x = law.ppf(np.linspace(1e-4, 1.0 - 1e-4, 501))
    np.testing.assert_allclose(parameter.decode(parameter.encode(x)), x, rtol=1e-11)


@given(st.floats(-1.0, 1.0), st.floats(-1e6, 1e6), st.floats(1e-6, 1e6))
def test_equation_8_there_and_back(coded, lower, width):
    """Chassagne 2018, equation 8, inverted: rounding of the bounds is all that is lost."""
    parameter = Parameter("x", uniform(lower, lower + width))
    physical = float(parameter.decode(coded))
    scale = max(abs(lower), abs(lower + width))
    assert physical == pytest.approx(lower + (coded + 1.0) / 2.0 * width, abs=4e-16 * scale)


def test_equation_8_on_table_2():
    """Table II: tension 0.059..0.137 N/mm has centre 0.098 and its ends at -1 and 1."""
    parameter = Parameter("tension", LAWS["uniform"])
    np.testing.assert_array_equal(parameter.decode([-1.0, 1.0]), [0.059, 0.137])
    np.testing.assert_allclose(parameter.encode([0.059, 0.098, 0.137]), [-1, 0, 1], atol=1e-14)


def test_unbounded_parameters_are_uniform_when_coded():
    """Probability transform: a normal value codes to 2 Phi(z) - 1."""
    parameter = Parameter("x", LAWS["normal"])
    z = np.array([-3.0, -1.0, 0.0, 0.5, 3.0])
    np.testing.assert_allclose(
        parameter.encode(5.0 + z), 2.0 * stats.norm.cdf(z) - 1.0, rtol=1e-14, atol=1e-16
    )


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_quadrature_integrates_polynomials_of_the_coded_value(law):
    """A Gauss rule of order 6 gives moments to degree 11; against adaptive integration."""
    from scipy.integrate import quad

    parameter = Parameter("x", law)
    nodes, weights = parameter.quadrature(6)
    assert len(nodes) == 6
    for power in range(12):
        exact = quad(
            lambda u, k=power: float(parameter.quantile(u)) ** k,
            0,
            1,
            epsabs=1e-12,
            epsrel=1e-12,
            limit=400,
        )[0]
        assert (weights * nodes**power).sum() == pytest.approx(exact, abs=2e-9)


#: Mean and second moment of laws that are far from flat on their range.
SKEWED = {
    "loguniform": (
        distribution("loguniform", a=1e-6, b=1.0),
        lambda k: (1.0 - 1e-6**k) / (k * np.log(1e6)),
    ),
    "arcsine": (distribution("beta", a=0.5, b=0.5), lambda k: stats.beta(0.5, 0.5).moment(k)),
    "peak at 0": (distribution("beta", a=0.1, b=2.0), lambda k: stats.beta(0.1, 2.0).moment(k)),
    "narrow": (
        distribution("normal", mean=5.01, std=5e-4, range=(2.0, 8.0)),
        lambda k: [5.01, 5.01**2 + 25e-8][k - 1],
    ),
    "decaying": (
        distribution("expon", scale=1e-3, range=(0.0, 10.0)),
        lambda k: [1e-3, 2e-6][k - 1],
    ),
    "long tail": (
        distribution("lognormal", mean=1.0, std=5.0, range=(0.0, 1e9)),
        lambda k: [1.0, 26.0][k - 1],
    ),
}


@pytest.mark.parametrize("name", SKEWED)
def test_quadrature_of_laws_far_from_flat(name):
    """Mean and variance in closed form: a logarithmic scale, poles, peaks and long tails."""
    law, moment = SKEWED[name]
    parameter = Parameter("x", law)
    nodes, weights = parameter.quadrature(8)
    values = parameter.decode(nodes)
    variance = weights @ (values - weights @ values) ** 2
    assert weights @ values == pytest.approx(moment(1), rel=1e-6)
    assert variance == pytest.approx(moment(2) - moment(1) ** 2, rel=1e-5)


def test_truncated_normal_is_scipy_truncnorm():
    """The truncated law against scipy.stats.truncnorm."""
    law, exact = LAWS["truncated"], stats.truncnorm(-3.0, 3.0, 5.0, 1.0)
    x = np.linspace(2.0, 8.0, 41)
    np.testing.assert_allclose(law.cdf(x), exact.cdf(x), atol=1e-14)
    np.testing.assert_allclose(law.pdf(x), exact.pdf(x), rtol=1e-12)
    np.testing.assert_allclose(law.ppf([0.1, 0.5, 0.9]), exact.ppf([0.1, 0.5, 0.9]), rtol=1e-12)


def test_lognormal_words_are_moments_of_the_quantity():
    """mean and std are those of the quantity itself, not of its logarithm."""
    law = LAWS["lognormal"]
    assert law.base.mean() == pytest.approx(2.0, rel=1e-12)
    assert law.base.std() == pytest.approx(0.5, rel=1e-12)


def test_gaussian_copula_has_its_spearman_correlation():
    """Spearman's rho of a Gaussian copula is 6 / pi asin(r / 2)."""
    space = Space(
        (Parameter("a", LAWS["uniform"]), Parameter("b", LAWS["lognormal"])),
        ((1.0, 0.7), (0.7, 1.0)),
    )
    points = space.decode(space.sample(200_000, seed=3))
    rho = stats.spearmanr(points["a"], points["b"]).statistic
    assert rho == pytest.approx(6.0 / np.pi * np.arcsin(0.35), abs=0.005)
    assert stats.kstest(points["a"], stats.uniform(0.059, 0.078).cdf).pvalue > 1e-3


def test_levels_code_evenly_and_come_back():
    """k names lie evenly on [-1, 1]."""
    parameter = Parameter("fabric", levels=("a", "b", "c"))
    np.testing.assert_array_equal(parameter.encode(["c", "a", "b"]), [1.0, -1.0, 0.0])
    assert list(parameter.decode([1.0, -1.0, 0.0])) == ["c", "a", "b"]
    u = (np.arange(999) + 0.5) / 999
    assert [(parameter.quantile(u) == code).sum() for code in (-1, 0, 1)] == [333] * 3


#: Laws with two ends, in the words of a study, and the same law of scipy on [2, 6].
WITH_ENDS = {
    "loguniform": ({}, stats.loguniform(2.0, 6.0)),
    "reciprocal": ({}, stats.reciprocal(2.0, 6.0)),
    "beta": ({"a": 2.0, "b": 5.0}, stats.beta(2.0, 5.0, 2.0, 4.0)),
    "arcsine": ({}, stats.arcsine(2.0, 4.0)),
    "cosine": ({}, stats.cosine(4.0, 2.0 / np.pi)),
    "semicircular": ({}, stats.semicircular(4.0, 2.0)),
    "trapezoid": ({"c": 0.25, "d": 0.5}, stats.trapezoid(0.25, 0.5, 2.0, 4.0)),
    "triang": ({"c": 0.25}, stats.triang(0.25, 2.0, 4.0)),
    "triangular": ({"mode": 3.0}, stats.triang(0.25, 2.0, 4.0)),
    "truncnorm": ({"loc": 5.0, "scale": 2.0}, stats.truncnorm(-1.5, 0.5, 5.0, 2.0)),
    "truncexpon": ({"scale": 2.0}, stats.truncexpon(2.0, 2.0, 2.0)),
    "truncpareto": ({"b": 3.0}, stats.truncpareto(3.0, 3.0, 0.0, 2.0)),
    "truncweibull_min": ({"c": 2.0}, stats.truncweibull_min(2.0, 2.0, 6.0)),
}


@pytest.mark.parametrize("name", WITH_ENDS)
def test_a_range_sets_the_ends_of_a_law_that_has_ends(name):
    """Same density as scipy's law with the ends written out, and exactly the range's ends."""
    words, expected = WITH_ENDS[name]
    law = distribution(name, range=(2.0, 6.0), **words)
    assert law.support == (2.0, 6.0)
    x = np.linspace(2.05, 5.95, 40)
    np.testing.assert_allclose(law.pdf(x), expected.pdf(x), rtol=1e-10)
    np.testing.assert_allclose(law.cdf(x), expected.cdf(x), rtol=1e-10)


def test_a_range_over_eight_decades():
    """Log-uniform: median at the geometric mean of the ends."""
    law = distribution("loguniform", range=(1e-16, 1e-8))
    assert law.support == (1e-16, 1e-8)
    assert float(law.ppf(0.5)) == pytest.approx(1e-12, rel=1e-9)


def test_ends_of_their_own_are_cut_by_a_range():
    """Where the words say where a law ends, or where it stands, a range truncates it."""
    inside = distribution("loguniform", a=1.0, b=100.0, range=(10.0, 1000.0))
    assert inside.support == (10.0, 100.0)
    moved = distribution("beta", a=2.0, b=2.0, loc=0.0, scale=10.0, range=(0.0, 5.0))
    assert moved.support == (0.0, 5.0) and float(moved.pdf(5.0)) == pytest.approx(0.3)


@pytest.mark.parametrize(
    "build, words",
    [
        (lambda: uniform(3.0, 1.0), "upside down"),
        (lambda: distribution("normal", mean=0.0, std=-1.0), "above 0"),
        (lambda: distribution("normal", mean=0.0), "needs 'std'"),
        (lambda: distribution("normal", mean=0.0, std=1.0, sdt=1.0), "does not take 'sdt'"),
        (lambda: distribution("nromal", mean=0.0, std=1.0), "did you mean 'normal'"),
        (lambda: distribution("normal", mean=0.0, std=1.0, range=(50.0, 60.0)), "no probability"),
        (lambda: distribution("triangular", mode=5.0, range=(0.0, 1.0)), "outside range"),
        (lambda: distribution("lognormal", mean=-1.0, std=1.0), "above 0"),
        (lambda: distribution("loguniform"), r"write {distribution: loguniform, range: \[small"),
        (lambda: distribution("loguniform", a=1.0), "needs 'b'"),
        (lambda: distribution("loguniform", range=(0.0, 1.0)), r"\[0, 1\] .* must be above 0"),
        (
            lambda: distribution("beta", range=(0.0, 1.0)),
            "needs 'a', 'b'; write {distribution: beta, a: .., b: .., range:",
        ),
        (lambda: Parameter("x", levels=("a", "a")), "two or more different"),
        (lambda: Space((Parameter("x", LAWS["uniform"]),) * 2), "must all differ"),
        (
            lambda: Space(
                (Parameter("x", LAWS["uniform"]), Parameter("y", LAWS["uniform"])),
                ((1.0, 1.0), (1.0, 1.0)),
            ),
            "positive definite",
        ),
        (lambda: Space((Parameter("x", LAWS["uniform"]),)).decode([[0.0, 0.0]]), "2 columns"),
        (lambda: Parameter("x", levels=("blue", "red")).encode(["bleu"]), "did you mean 'blue'"),
    ],
)
def test_mistakes_are_sentences(build, words):
    """Each mistake is a StudyError that names the cure."""
    with pytest.raises(StudyError, match=words):
        build()
