"""Nested designs of several levels."""

import numpy as np
import pytest

from surrogate.designs.latin_hypercube import latin_hypercube
from surrogate.designs.nested import nested
from surrogate.errors import DesignError
from surrogate.space.distributions import uniform
from surrogate.space.space import Parameter, Space

CUBE = Space(tuple(Parameter(name, uniform(0, 1)) for name in "abc"))


def rows(points):
    return set(map(tuple, points.round(12)))


def test_the_points_of_each_level_are_points_of_the_cheaper_one():
    """Three levels; the truth is the maximin Latin hypercube of that size."""
    coded = nested(CUBE, runs={"low": 40, "middle": 20, "true": 8}, seed=3)
    low, middle, true = coded[:40], coded[40:60], coded[60:]
    assert rows(true) <= rows(middle) <= rows(low)
    assert [len(rows(one)) for one in (low, middle, true)] == [40, 20, 8]
    np.testing.assert_array_equal(true, latin_hypercube(CUBE, runs=8, seed=3))


def test_more_cheap_runs_keep_those_that_are_done():
    small = nested(CUBE, runs={"cheap": 20, "true": 8}, seed=3)
    large = nested(CUBE, runs={"cheap": 50, "true": 8}, seed=3)
    assert rows(small) <= rows(large)


@pytest.mark.parametrize(
    ("runs", "sentence"),
    [
        ({"cheap": 5, "true": 8}, "runs of cheap: 5 must be 8 or more"),
        (20, "must give a number of runs for each level"),
        ({"true": 20}, "must give a number of runs for each level"),
        ({"cheap": 20, "true": 0}, "runs of true"),
    ],
)
def test_wrong_numbers_of_runs(runs, sentence):
    with pytest.raises(DesignError, match=sentence):
        nested(CUBE, runs=runs)
