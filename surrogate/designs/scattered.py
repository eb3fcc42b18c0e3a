"""Points of a region that lie far apart: selected one by one from many, then exchanged.

Each point is the candidate farthest from those taken before (Kennard and Stone 1969). Their
smallest distance is at least half of the largest that so many candidates allow (Gonzalez 1985,
doi 10.1016/0304-3975(85)90224-5). Exchanges then move one of the closest pair to the emptiest
place as long as that helps. Distances are those of probabilities, so that the points follow
the law of the parameters.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import spatial

from surrogate.space.space import Space

Coded = NDArray[np.float64]

#: Candidates for each point, at least and at most so many, and candidates times points.
CANDIDATES, FEWEST, MOST, LARGEST_WORK = 40, 2_000, 200_000, 2e8
#: Exchanges for each point; designs with a larger table of distances are left as they are.
EXCHANGES, LARGEST_TABLE = 4, 4_000_000


def scattered(
    space: Space,
    runs: int,
    rng: np.random.Generator,
    effort: float = 1.0,
    kept: Coded | None = None,
) -> Coded:
    """`runs` coded points (run, parameter) of a space, constraints kept, far apart.

    kept: points (run, parameter) that are there already, to keep away from.
    """
    wanted = np.clip(effort * CANDIDATES * runs, FEWEST, max(FEWEST, effort * MOST))
    count = int(max(runs, min(wanted, effort * LARGEST_WORK / runs)))
    coded = space.sample(count, seed=int(rng.integers(2**31)))
    places = _places(space, coded)
    there = _places(space, np.empty((0, space.size)) if kept is None else kept)
    taken = _farthest(places, runs, there)
    return coded[_exchanged(places, taken, there, round(EXCHANGES * runs))]


def _places(space: Space, coded: Coded) -> Coded:
    """Probabilities (point, parameter) of coded points."""
    return np.column_stack([p.probability(coded[:, j]) for j, p in enumerate(space.parameters)])


def _farthest(places: Coded, runs: int, there: Coded) -> NDArray[np.intp]:
    """Numbers of `runs` of the places, each the farthest from those before and those there.

    The first is the outermost where none is there.
    """
    taken = np.empty(runs, dtype=np.intp)
    nearest = _squared(places, places.mean(axis=0))
    if len(there):
        nearest = np.asarray(spatial.KDTree(there).query(places)[0]) ** 2
    for k in range(runs):
        taken[k] = int(nearest.argmax())
        if k == 0 and not len(there):
            nearest = np.full(len(places), np.inf)
        np.minimum(nearest, _squared(places, places[taken[k]]), out=nearest)
    return taken


def _exchanged(
    places: Coded, taken: NDArray[np.intp], there: Coded, exchanges: int
) -> NDArray[np.intp]:
    """The same after exchanges that make the smallest distance larger."""
    points = np.vstack([places[taken], there])
    if len(points) < 3 or len(points) * len(places) > LARGEST_TABLE:
        return taken
    table = spatial.distance.cdist(places, points, "sqeuclidean")
    for _ in range(exchanges):
        apart = table[taken]
        np.fill_diagonal(apart, np.inf)
        pair = np.unravel_index(int(apart.argmin()), apart.shape)
        nearest, second = np.partition(table, 1, axis=1)[:, :2].T
        moves = []
        for leaving in (int(number) for number in pair if number < len(taken)):
            without = np.where(table[:, leaving] <= nearest, second, nearest)
            entering = int(without.argmax())
            moves.append((float(without[entering]), leaving, entering))
        reached, leaving, entering = max(moves)
        if reached <= float(apart[pair]) * (1.0 + 1e-9):
            break
        taken[leaving] = entering
        table[:, leaving] = _squared(places, places[entering])
    return taken


def _squared(a: Coded, b: Coded) -> Coded:
    """Squared distances over the last axis."""
    return np.asarray(((a - b) ** 2).sum(axis=-1))
