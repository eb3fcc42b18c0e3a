"""Methods of reliability against closed forms: the linear limit state, the parabola, a ring."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import integrate, stats

from surrogate.errors import StudyError
from surrogate.reliability.crude import crude
from surrogate.reliability.form import form
from surrogate.reliability.importance import importance
from surrogate.reliability.limit_state import LimitState, coded_of, state_of
from surrogate.reliability.problem import Failure
from surrogate.reliability.subset import population, subset
from surrogate.space.constraint_text import parse
from surrogate.space.distributions import distribution
from surrogate.space.space import Parameter, Space

#: Of a single interval that is to cover: it misses once in a thousand.
SURE = 0.999


def linear(beta: float, size: int = 3) -> LimitState:
    """g = beta - a . u with |a| = 1: the probability is Phi(-beta)."""
    a = np.arange(1.0, size + 1.0)
    a /= np.linalg.norm(a)
    return LimitState(size, lambda u: beta - u @ a)


def parabola(beta: float = 3.0, bend: float = 0.2) -> tuple[LimitState, float]:
    """g = beta - u1 + bend u2^2, with its probability by quadrature."""
    state = LimitState(2, lambda u: beta - u[:, 0] + bend * u[:, 1] ** 2)
    found = integrate.quad(lambda v: stats.norm.pdf(v) * stats.norm.sf(beta + bend * v**2), -10, 10)
    return state, float(found[0])


@pytest.mark.parametrize("beta", [-1.0, 0.5, 2.0])
def test_crude_covers_the_linear_limit_state(beta: float) -> None:
    found = crude(linear(beta), samples=100_000, confidence=SURE, seed=1)
    truth = stats.norm.sf(beta)
    assert found.low <= truth <= found.high
    assert found.probability == pytest.approx(truth, rel=0.05)


def test_crude_without_failures_still_has_an_upper_end() -> None:
    found = crude(linear(9.0), samples=1000)
    assert found.probability == found.low == 0.0
    assert found.high == pytest.approx(1.0 - 0.025 ** (1 / 1000), rel=1e-9)


@pytest.mark.parametrize("beta", [-1.5, 1.0, 3.0, 5.0])
def test_form_is_exact_for_the_linear_limit_state(beta: float) -> None:
    found = form(linear(beta))
    assert found.found
    assert found.beta == pytest.approx(beta, abs=1e-6)
    assert found.importance == pytest.approx(np.array([1.0, 4.0, 9.0]) / 14.0, abs=1e-5)


def test_form_says_when_there_is_no_design_point() -> None:
    found = form(LimitState(2, lambda u: 1.0 + (u**2).sum(axis=1)))
    assert not found.found
    assert np.isnan(found.probability)


def test_form_finds_the_parabola_and_importance_sampling_corrects_it() -> None:
    state, truth = parabola()
    tangent = form(state)
    assert tangent.beta == pytest.approx(3.0, abs=1e-6)
    assert tangent.probability > 1.2 * truth
    found = importance(state, tangent.design_point, confidence=SURE, seed=3)
    assert found.low <= truth <= found.high
    assert found.probability == pytest.approx(truth, rel=0.04)


def test_form_agrees_with_openturns() -> None:
    ot = pytest.importorskip("openturns")
    function = ot.SymbolicFunction(["x", "y"], ["6 - x - 0.3*y + 0.15*(x - y)^2 + 0.05*x*y"])
    normal = ot.Normal(2)
    event = ot.ThresholdEvent(
        ot.CompositeRandomVector(function, ot.RandomVector(normal)), ot.LessOrEqual(), 0.0
    )
    solver = ot.AbdoRackwitz()
    solver.setStartingPoint([1.0, 1.0])
    algorithm = ot.FORM(solver, event)
    algorithm.run()
    theirs = algorithm.getResult()

    def g(u: np.ndarray) -> np.ndarray:
        x, y = u.T
        return 6 - x - 0.3 * y + 0.15 * (x - y) ** 2 + 0.05 * x * y

    ours = form(LimitState(2, g))
    assert ours.beta == pytest.approx(theirs.getHasoferReliabilityIndex(), abs=1e-4)
    point = np.array(theirs.getStandardSpaceDesignPoint())
    assert ours.design_point == pytest.approx(point, abs=1e-2)


@pytest.mark.parametrize("beta", [2.0, 4.75])
def test_subset_covers_rare_failures(beta: float) -> None:
    found = subset(linear(beta), confidence=SURE, seed=2)
    truth = stats.norm.sf(beta)
    assert found.probability == pytest.approx(truth, rel=0.25)
    assert found.low <= truth <= found.high


def test_interval_of_subset_covers_as_often_as_it_says() -> None:
    truth = stats.norm.sf(3.0)
    hits = 0
    for seed in range(60):
        found = subset(linear(3.0, 2), samples=500, repeats=8, seed=seed)
        hits += found.low <= truth <= found.high
    assert 51 <= hits  # 95 % of 60 is 57; fewer than 51 has probability 0.003 (binomial)


def test_subset_finds_failures_all_around() -> None:
    state = LimitState(2, lambda u: 5.0 - np.linalg.norm(u, axis=1))
    found = subset(state, confidence=SURE, seed=1)
    truth = float(np.exp(-12.5))
    assert found.low <= truth <= found.high


def test_population_stands_for_the_whole_space() -> None:
    points = population(linear(4.0, 2), samples=4000, seed=1)
    assert points.weight.sum() == pytest.approx(1.0)
    failed = linear(4.0, 2).g(points.u) <= 0.0
    assert points.probability(failed) == pytest.approx(stats.norm.sf(4.0), rel=0.3)
    assert points.probability(linear(1.0, 2).g(points.u) <= 0.0) == pytest.approx(
        stats.norm.sf(1.0), rel=0.1
    )


def test_the_same_seed_gives_the_same_answer() -> None:
    assert subset(linear(3.0), samples=300, seed=5) == subset(linear(3.0), samples=300, seed=5)
    assert crude(linear(1.0), seed=5) == crude(linear(1.0), seed=5)


def test_dependent_inputs_keep_their_copula() -> None:
    laws = [Parameter(n, distribution("normal", mean=0.0, std=1.0)) for n in ("a", "b")]
    space = Space(tuple(laws), ((1.0, 0.8), (0.8, 1.0)))

    def total(X: np.ndarray) -> np.ndarray:
        physical = space.decode(X)
        return np.asarray(physical["a"] + physical["b"])

    found = form(state_of(Failure("f", "y", 6.0), space, total))
    assert found.beta == pytest.approx(6.0 / np.sqrt(3.6), abs=1e-3)
    below = form(state_of(Failure("f", "y", -6.0, sign=-1), space, total))
    assert below.beta == pytest.approx(6.0 / np.sqrt(3.6), abs=1e-3)


def test_constraints_are_refused_with_a_cure() -> None:
    laws = [Parameter(n, distribution("uniform", range=(0.0, 1.0))) for n in ("a", "b")]
    space = Space(tuple(laws), constraints=(parse("a + b <= 1", {"a": "", "b": ""}),))
    with pytest.raises(StudyError, match="drop the constraints"):
        coded_of(space, np.zeros((1, 2)))
