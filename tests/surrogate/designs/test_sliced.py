"""Sliced Latin hypercubes: one as a whole and one in each slice, with points far apart."""

import numpy as np
import pytest
from scipy.spatial.distance import pdist

from surrogate.designs.latin_hypercube import latin_hypercube
from surrogate.errors import DesignError, StudyError
from surrogate.space.distributions import distribution, uniform
from surrogate.space.space import Parameter, Space
from surrogate.study.study import Study


def space(levels=3, numbers=3):
    names = tuple(Parameter(f"x{j}", uniform(0, 1)) for j in range(numbers))
    return Space((names[0], Parameter("kind", levels=tuple("abcdef"[:levels])), *names[1:]))


@pytest.mark.parametrize("criterion", ["maximin", "random"])
@pytest.mark.parametrize(("levels", "runs"), [(2, 10), (3, 30), (5, 20)])
def test_the_whole_and_each_slice_are_latin_hypercubes(levels, runs, criterion):
    """Qian 2012, definition 1: n different slices of n in all, m of m in each level."""
    of = space(levels)
    design = latin_hypercube(of, runs=runs, slices="kind", criterion=criterion, seed=1)
    u, kind = (np.delete(design, 1, axis=1) + 1.0) / 2.0, design[:, 1]
    assert (np.sort(np.floor(u * runs), axis=0) == np.arange(runs)[:, None]).all()
    each = runs // levels
    for level in of["kind"].coded_levels:
        own = np.floor(u[np.isclose(kind, level)] * each)
        assert (np.sort(own, axis=0) == np.arange(each)[:, None]).all()


def test_points_lie_far_apart_as_a_whole_and_in_slices():
    """Against the mean of 20 random ones, 3 slices of 10 in 3 columns: 1.8 and 1.5 times."""

    def distances(design):
        points, kind = np.delete(design, 1, axis=1), design[:, 1]
        return pdist(points).min(), min(pdist(points[kind == k]).min() for k in np.unique(kind))

    random = np.mean(
        [
            distances(latin_hypercube(space(), runs=30, slices="kind", criterion="random", seed=k))
            for k in range(20)
        ],
        axis=0,
    )
    found = np.mean(
        [distances(latin_hypercube(space(), runs=30, slices="kind", seed=k)) for k in range(5)],
        axis=0,
    )
    assert found[0] > 1.8 * random[0] and found[1] > 1.5 * random[1]


def test_it_is_near_the_distance_of_a_latin_hypercube_without_slices():
    numbers = Space(tuple(Parameter(f"x{j}", uniform(0, 1)) for j in range(3)))
    free = pdist(latin_hypercube(numbers, runs=30, seed=1)).min()
    tied = pdist(
        np.delete(latin_hypercube(space(), runs=30, slices="kind", seed=1), 1, axis=1)
    ).min()
    assert tied > 0.8 * free


def test_laws_are_kept_in_each_slice():
    normal = Parameter("load", distribution("normal", mean=5.0, std=1.0), unit="N")
    of = Space((normal, Parameter("kind", levels=("a", "b"))))
    design = latin_hypercube(of, runs=200, slices="kind", seed=0)
    for level in (-1.0, 1.0):
        loads = of.decode(design[design[:, 1] == level])["load"]
        assert loads.mean() == pytest.approx(5.0, abs=0.05)
        assert loads.std() == pytest.approx(1.0, abs=0.05)


def test_the_same_seed_gives_the_same_points():
    one, two = (latin_hypercube(space(), runs=12, slices="kind", seed=4) for _ in range(2))
    assert (one == two).all()


@pytest.mark.parametrize(
    ("of", "options", "told"),
    [
        (space(), {"runs": 30, "slices": "x1"}, "slices: 'x1' is no parameter with levels; .*kind"),
        (space(), {"runs": 31, "slices": "kind"}, "runs: 31 do not divide into 3 .* take 30"),
        (space(), {"runs": 3, "slices": "kind"}, "take 6"),
    ],
)
def test_mistakes_are_told(of, options, told):
    with pytest.raises(DesignError, match=told):
        latin_hypercube(of, **options)


def test_a_study_tells_mistakes_at_their_place():
    words = {
        "study": "demo",
        "solver": "ishigami",
        "parameters": {"X1": [-1, 1], "X2": [-1, 1]},
        "designs": {"train": {"method": "latin_hypercube", "runs": 20, "slices": "X1"}},
        "surrogates": {"gp": "gaussian_process"},
    }
    with pytest.raises(StudyError, match="designs.train.*slices: 'X1' is no parameter with levels"):
        Study.from_mapping(words)
