"""Designs in what constraints leave of the box."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.distance import pdist

from surrogate.designs.box_behnken import box_behnken
from surrogate.designs.center_points import center_points
from surrogate.designs.central_composite import central_composite
from surrogate.designs.criteria import log_determinant
from surrogate.designs.csv import csv
from surrogate.designs.fractional_factorial import fractional_factorial
from surrogate.designs.full_factorial import full_factorial
from surrogate.designs.halton import halton
from surrogate.designs.latin_hypercube import latin_hypercube
from surrogate.designs.model import Model
from surrogate.designs.optimal import d_optimal
from surrogate.designs.plackett_burman import plackett_burman
from surrogate.designs.sobol import sobol
from surrogate.errors import DesignError
from surrogate.space.constraint_text import parse
from surrogate.space.discrete import integers
from surrogate.space.distributions import uniform
from surrogate.space.space import Parameter, Space


def box(names, *texts, integer=()):
    parameters = tuple(
        Parameter(name, integers((0, 8)) if name in integer else uniform(0.0, 1.0))
        for name in names
    )
    units = dict.fromkeys(names, "")
    return Space(parameters, None, tuple(parse(text, units) for text in texts))


FILLING = {
    "maximin": lambda space, runs, seed: latin_hypercube(space, runs=runs, seed=seed),
    "random": lambda space, runs, seed: latin_hypercube(
        space, runs=runs, criterion="random", seed=seed
    ),
    "sobol": lambda space, runs, seed: sobol(space, runs=runs, seed=seed),
    "halton": lambda space, runs, seed: halton(space, runs=runs, seed=seed),
    "d_optimal": lambda space, runs, seed: d_optimal(space, runs=runs, starts=1, seed=seed),
}
SPACES = {
    "triangle": box("ab", "a + b <= 0.6"),
    "mixture": box("abc", "a + b + c = 1"),
    "mixture with a limit": box("abcx", "a + b + c = 1", "a <= 0.4 + 0.1*x"),
    "ring": box("ab", "(a - 0.5)^2 + (b - 0.5)^2 >= 0.16"),
    "integers": box("anm", "n + m <= 9", "a * n <= 4", integer="nm"),
    "narrow": box("abcd", "max(a, b, c, d) <= 0.15"),
}


@pytest.mark.parametrize("kind", SPACES)
@pytest.mark.parametrize("method", FILLING)
@settings(deadline=None, max_examples=3)
@given(runs=st.integers(8, 25), seed=st.integers(0, 1000))
def test_points_keep_the_constraints(kind, method, runs, seed):
    coded = FILLING[method](SPACES[kind], runs, seed)
    assert coded.shape == (runs, SPACES[kind].size)
    assert SPACES[kind].contains(coded).all()


@pytest.mark.parametrize("kind", ["triangle", "mixture", "ring", "narrow"])
def test_maximin_points_lie_further_apart_than_the_best_of_many_random_ones(kind):
    space = SPACES[kind]
    found = pdist(latin_hypercube(space, runs=20, seed=1)).min()
    draws = space.sample(200 * 20, seed=3).reshape(200, 20, space.size)
    best = max(pdist(coded).min() for coded in draws)
    assert found >= best


@pytest.mark.parametrize("method", ["sobol", "halton"])
def test_a_sequence_grows_without_losing_runs(method):
    small, large = (FILLING[method](SPACES["triangle"], n, 4) for n in (12, 50))
    assert np.array_equal(large[:12], small)


@pytest.mark.parametrize("method", FILLING)
def test_the_same_seed_gives_the_same_points(method):
    first, second = (FILLING[method](SPACES["mixture"], 10, 7) for _ in range(2))
    assert np.array_equal(first, second)


@pytest.mark.parametrize(
    "method",
    [
        full_factorial,
        lambda space: fractional_factorial(space, resolution=3),
        plackett_burman,
        central_composite,
        box_behnken,
        lambda space: center_points(space, np.zeros((1, 3))),
    ],
)
def test_a_design_that_is_cut_says_by_what_and_what_to_do(method):
    space = box("abc", "a + b + c <= 1.2")
    with pytest.raises(DesignError, match=r"'a \+ b \+ c <= 1.2' cuts \d+ of the \d+ points of"):
        method(space)
    with pytest.raises(DesignError, match="use d_optimal or latin_hypercube"):
        method(space)


def test_a_design_that_is_not_cut_stands():
    assert len(full_factorial(box("abc", "a + b + c <= 3"))) == 8


def test_a_linear_d_optimal_design_takes_the_corners():
    """On a triangle det(F'F) is largest with a third of the runs at each corner."""
    space = box("ab", "a + b <= 0.6")
    physical = space.decode(d_optimal(space, runs=9, seed=0))
    found = np.round(np.column_stack([physical["a"], physical["b"]]), 6)
    corners, counts = np.unique(found, axis=0, return_counts=True)
    assert corners == pytest.approx(np.array([[0, 0], [0, 0.6], [0.6, 0]]), abs=1e-5)
    assert counts.tolist() == [3, 3, 3]


def test_a_d_optimal_mixture_is_scheffes_simplex_lattice():
    """Quadratic in three components: the {3, 2} lattice (Kiefer 1961), to within 1 %."""
    space = box("abc", "a + b + c = 1")
    coded = d_optimal(space, runs=6, model="quadratic", seed=0)
    lattice = [[1, 0, 0], [0, 1, 0], [0, 0, 1], [0.5, 0.5, 0], [0.5, 0, 0.5], [0, 0.5, 0.5]]
    model = Model(space, "quadratic")
    assert model.size == 6
    best = log_determinant(model.matrix(2.0 * np.array(lattice) - 1.0))
    assert log_determinant(model.matrix(coded)) >= best - 0.01 * 6


def test_rows_of_a_file_that_break_a_constraint_are_told(tmp_path):
    (tmp_path / "points.csv").write_text("a,b\n0.1,0.2\n0.5,0.4\n0.6,0.1\n")
    with pytest.raises(DesignError, match=r"points.csv:3: the point breaks .*\n.*csv:4: the point"):
        csv(SPACES["triangle"], path="points.csv", folder=tmp_path)


def test_printed_digits_of_a_mixture_are_forgiven(tmp_path):
    (tmp_path / "points.csv").write_text("a,b,c\n0.333,0.333,0.333\n0.5,0.5,0\n")
    coded = csv(SPACES["mixture"], path="points.csv", folder=tmp_path)
    assert SPACES["mixture"].contains(coded).all()
    assert coded == pytest.approx(2.0 * np.array([[1 / 3] * 3, [0.5, 0.5, 0.0]]) - 1.0, abs=3e-3)
    (tmp_path / "points.csv").write_text("a,b,c\n0.3,0.3,0.3\n")
    with pytest.raises(DesignError, match="csv:2: the point breaks"):
        csv(SPACES["mixture"], path="points.csv", folder=tmp_path)
