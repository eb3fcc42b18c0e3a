"""Design methods that search, and count how often."""

import numpy as np

from surrogate.designs.design import searching

#: Rows of each design that was searched for.
calls: list[int] = []


def rows(space, *, runs, **_):
    """Number of points of `counted` and `judged`."""
    return runs


def scatter(space, *, runs: int, seed: int | None = None):
    """Random points, and a call to be counted."""
    calls.append(runs)
    return space.sample(runs, seed=seed)


@searching(rows, spread=True)
def counted(space, *, runs: int, seed: int | None = None):
    """A search of which only the number of points can be wrong."""
    return scatter(space, runs=runs, seed=seed)


@searching(rows)
def judged(space, *, runs: int, seed: int | None = None):
    """A search that a study must judge before its runs begin."""
    return scatter(space, runs=runs, seed=seed)


@searching(rows)
def one_point(space, *, runs: int, seed: int | None = None):
    """A search whose points are all the same."""
    return np.zeros((runs, space.size))
