"""Orthogonal arrays of mixed levels."""

import numpy as np
import pytest

from surrogate.designs.orthogonal_array import balanced, orthogonal_array
from surrogate.errors import DesignError
from surrogate.space.discrete import listed
from surrogate.space.space import Parameter, Space


def numbered(coded):
    return np.column_stack([np.unique(column, return_inverse=True)[1] for column in coded.T])


@pytest.mark.parametrize(
    "levels, runs",
    [
        ([3] * 4, 9),
        ([2] * 7, 8),
        ([2] * 11, 12),
        ([4, 2, 2, 2, 2], 8),
        ([2] + [3] * 7, 18),
        ([6, 3, 3, 3], 18),
        ([4, 4, 2, 2, 2, 2, 2], 16),
        ([5] * 6, 25),
        ([2] * 11 + [3] * 12, 36),
        ([2] * 5 + [5] * 3, None),
    ],
)
def test_every_pair_of_levels_is_there_equally_often(cube, levels, runs):
    """The smallest published array for these levels (Hedayat, Sloane and Stufken 1999, ch. 12)."""
    space = cube(len(levels))
    asked = dict(zip(space.names, levels, strict=True))
    if runs is None:
        with pytest.raises(DesignError, match="5 with 2, 3 with 5"):
            orthogonal_array(space, levels=asked)
        return
    coded = orthogonal_array(space, levels=asked)
    assert len(coded) == runs
    assert [len(np.unique(column)) for column in coded.T] == levels
    assert balanced(numbered(coded))


def test_what_is_not_balanced_is_seen():
    """Two equal columns are not."""
    assert not balanced(np.array([[0, 0], [0, 0], [1, 1], [1, 1]]))
    assert balanced(np.array([[0, 0], [0, 1], [1, 0], [1, 1]]))


def test_levels_follow_from_the_parameters(mixed):
    """Named levels are taken as they are; ranges have three, two values two."""
    space = Space((*mixed.parameters, Parameter("plies", listed((1.0, 2.0)))))
    coded = orthogonal_array(space)
    assert coded.shape == (18, 5) or coded.shape == (36, 5)
    assert [len(np.unique(column)) for column in coded.T] == [3, 2, 3, 3, 2]
    assert balanced(numbered(coded))


def test_a_number_of_runs_may_be_asked_for(cube):
    """A larger array; one that is not there is refused with those that are."""
    assert len(orthogonal_array(cube(3), levels=2, runs=12)) == 12
    with pytest.raises(DesignError, match="arrays have 4, 8, 9, 12"):
        orthogonal_array(cube(3), levels=2, runs=10)
