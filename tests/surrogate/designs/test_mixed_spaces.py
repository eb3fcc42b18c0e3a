"""Every design method on spaces with integers, listed values and levels gives allowed points."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.distance import pdist

from surrogate.designs.axial_points import axial_points
from surrogate.designs.box_behnken import box_behnken
from surrogate.designs.central_composite import central_composite
from surrogate.designs.criteria import log_determinant
from surrogate.designs.csv import csv
from surrogate.designs.fold_over import fold_over
from surrogate.designs.fractional_factorial import fractional_factorial
from surrogate.designs.full_factorial import full_factorial
from surrogate.designs.halton import halton
from surrogate.designs.latin_hypercube import latin_hypercube
from surrogate.designs.model import Model
from surrogate.designs.optimal import d_optimal
from surrogate.designs.plackett_burman import plackett_burman
from surrogate.designs.sobol import sobol
from surrogate.errors import DesignError
from surrogate.space.discrete import integers, listed
from surrogate.space.distributions import uniform
from surrogate.space.space import Parameter, Space

METHODS = {
    "full_factorial": lambda space, seed: full_factorial(space, center_points=1),
    "fractional_factorial": lambda space, seed: fractional_factorial(
        space, resolution=3, center_points=2
    ),
    "plackett_burman": lambda space, seed: plackett_burman(space, center_points=1),
    "central_composite": lambda space, seed: central_composite(space),
    "box_behnken": lambda space, seed: box_behnken(space),
    "d_optimal": lambda space, seed: d_optimal(
        space, runs=20, model="quadratic", starts=2, seed=seed
    ),
    "latin_hypercube": lambda space, seed: latin_hypercube(space, runs=11, seed=seed),
    "random": lambda space, seed: latin_hypercube(space, runs=11, criterion="random", seed=seed),
    "sobol": lambda space, seed: sobol(space, runs=11, seed=seed),
    "halton": lambda space, seed: halton(space, runs=11, seed=seed),
    "fold_over": lambda space, seed: fold_over(space, latin_hypercube(space, runs=9, seed=seed)),
    "axial_points": lambda space, seed: axial_points(space, np.zeros((1, 3)), alpha=0.6),
}

LAWS = st.one_of(
    st.just(uniform(0.0, 1.0)),
    st.tuples(st.integers(-5, 5), st.integers(2, 30)).map(lambda e: integers((e[0], sum(e)))),
    st.lists(st.integers(0, 100), min_size=3, max_size=6, unique=True).map(listed),
    st.just(integers((0, 12), "normal", mean=5.0, std=2.0)),
)


@pytest.mark.parametrize("name", METHODS)
@settings(deadline=None, max_examples=15)
@given(laws=st.tuples(LAWS, LAWS, LAWS), seed=st.integers(0, 100))
def test_points_are_allowed(name, laws, seed):
    space = Space(tuple(Parameter(f"p{j}", law) for j, law in enumerate(laws)))
    try:
        coded = METHODS[name](space, seed)
    except DesignError as error:
        assert name == "fold_over" and "adds nothing" in str(error)
        return
    assert space.contains(coded).all()


def grid(*sizes):
    return Space(tuple(Parameter(f"n{j}", integers((1, k))) for j, k in enumerate(sizes)))


@pytest.mark.parametrize(
    "sizes, runs", [((4, 5), 20), ((3, 3, 3), 20), ((8, 8), 16), ((6, 10), 30)]
)
@pytest.mark.parametrize("method", [latin_hypercube, sobol, halton])
def test_points_differ_where_they_can(method, sizes, runs):
    coded = method(grid(*sizes), runs=runs, seed=3)
    assert len(np.unique(coded, axis=0)) == runs


def test_maximin_keeps_its_distances_after_rounding():
    """No closer than the best of 200 rounded random Latin hypercubes."""
    space = Space((*grid(8, 12).parameters, Parameter("x", uniform(0.0, 1.0))))
    found = pdist(latin_hypercube(space, runs=24, seed=1)).min()
    draws = (latin_hypercube(space, runs=24, criterion="random", seed=s) for s in range(200))
    assert found >= max(pdist(coded).min() for coded in draws)


def test_maximin_takes_the_values_evenly():
    coded = latin_hypercube(grid(4, 6), runs=24, seed=0)
    for column, k in zip(coded.T, (4, 6), strict=True):
        assert np.unique(column, return_counts=True)[1].tolist() == [24 // k] * k


@pytest.mark.parametrize("method", [sobol, halton])
def test_a_sequence_of_whole_numbers_grows_without_losing_runs(method):
    space = grid(9, 9)
    small, large = (method(space, runs=n, seed=5) for n in (20, 60))
    assert np.array_equal(large[:20], small)


def test_full_factorial_takes_allowed_values():
    space = Space((Parameter("pipe", listed([10, 12, 16, 20])), Parameter("n", integers((1, 9)))))
    physical = space.decode(full_factorial(space, levels={"pipe": 4, "n": 3}))
    assert sorted(set(physical["pipe"])) == [10, 12, 16, 20]
    assert sorted(set(physical["n"])) == [1, 5, 9]
    with pytest.raises(DesignError, match="5 are more than its 4 allowed values"):
        full_factorial(space, levels={"pipe": 5})


def test_d_optimal_beats_the_rounded_grid_of_a_range():
    """Allowed values 1, 2, 6: the quadratic is best estimated from all three, equally often."""
    space = Space((Parameter("n", listed([1, 2, 6])),))
    coded = d_optimal(space, runs=9, model="quadratic", seed=0)
    assert np.unique(coded, return_counts=True)[1].tolist() == [3, 3, 3]


def test_two_values_have_no_square_and_no_middle():
    space = Space(
        (*grid(2).parameters, Parameter("x", uniform(0, 1)), Parameter("y", uniform(0, 1)))
    )
    coded = d_optimal(space, runs=12, model="quadratic", seed=0)
    assert np.isfinite(log_determinant(Model(space, "quadratic").matrix(coded)))
    for method in (central_composite, box_behnken):
        with pytest.raises(DesignError, match="takes only 1 and 2"):
            method(space)


def test_a_file_with_a_value_that_is_not_allowed_is_told_with_its_line(tmp_path):
    (tmp_path / "points.csv").write_text("pipe\n12\n13\n")
    space = Space((Parameter("pipe", listed([10, 12, 16, 20])),))
    with pytest.raises(DesignError, match=r"points.csv:3: pipe: 13 is not allowed .*nearest is 12"):
        csv(space, path="points.csv", folder=tmp_path)
