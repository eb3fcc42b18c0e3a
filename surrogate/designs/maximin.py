"""Maximin Latin hypercubes by exchanges within a column.

Criterion: phi = sum over pairs of (squared distance)^-16, that is Morris and Mitchell's
phi_p with p = 32 (1995, equation 2.2): near to the smallest distance, and smooth. Search:
exchanges as in Jin, Chen and Sudjianto 2005, but of points that lie close to others: an
exchange of two points that are far from all others cannot help. Worse designs are
accepted by a threshold that falls to zero (Dueck and Scheuer 1990).

Ranks and squared distances are whole numbers and potentials are rounded to whole numbers,
so every sum is exact and the design is the same on every processor.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ranks = NDArray[np.int64]

#: Exchanges by default: so many a run, with exchanges x runs at most this, but at least so many.
EXCHANGES, LARGEST_WORK, FEWEST = 12, 2.5e6, 500
#: Designs of fewer runs are the best of several searches, which share the exchanges.
SEVERAL = 50
#: An exchange is the best of this many; its first point has the largest potential of this share.
TRIED, DRAWN = 40, 0.03
#: An exchange may raise phi by this share of the first point's potential, at the start.
THRESHOLD = 0.1
#: Larger designs are left as they are: a search that they would notice takes hours.
LARGEST = 10_000
#: Potential of the closest pair, and potential at which it is measured anew.
UNIT, FADED = 2.0**36, 2.0**26
#: Rows of the distance matrix that are in memory at a time.
ROWS = 256


def maximin(ranks: Ranks, rng: np.random.Generator, effort: float = 1.0) -> Ranks:
    """Ranks (run, parameter) of a Latin hypercube whose points lie far apart.

    ranks: different integers in each column, 0..runs-1 or other positions. effort: how many
    times the usual number of exchanges. The search is bounded by exchanges, not by time, so
    that the same generator gives the same search.
    """
    runs, parameters = ranks.shape
    if runs < 3 or parameters < 2 or runs > LARGEST:
        return ranks
    usual = max(FEWEST, min(EXCHANGES * runs, LARGEST_WORK / runs))
    starts = max(1, SEVERAL // runs)
    best = Search(ranks.astype(float))
    for start in range(starts):
        begun = Search(rng.permuted(best.x, axis=0) if start else best.x.copy())
        found = _searched(begun, max(1, round(effort * usual / starts)), rng)
        best = max(best, found, key=lambda search: search.quality)
    return best.x.astype(np.int64)


def _searched(search: Search, exchanges: int, rng: np.random.Generator) -> Search:
    """The search after so many exchanges, with a threshold that falls to zero."""
    interval = max(100, len(search.x))
    for step in range(exchanges):
        if step % interval == 0 or search.faded:
            search.measure()
        search.exchange(THRESHOLD * (1.0 - step / exchanges), rng)
    search.measure()
    return search


class Search:
    """A design and the potential of each point, its share of phi in units of the closest pair.

    x           ranks, (run, parameter)
    closest     squared distance of the closest pair when it was last measured
    potentials  sum over the other points of UNIT (closest / squared distance)^16, (run,)
    """

    x: Floats
    closest: float
    potentials: Floats

    def __init__(self, x: Floats) -> None:
        self.x, self.norms = x, (x * x).sum(axis=1)
        self.measure()

    @property
    def faded(self) -> bool:
        """Whether the points have moved so far apart that the unit is too coarse."""
        return bool(self.potentials.max() < FADED)

    @property
    def quality(self) -> tuple[float, float]:
        """Larger is better: the smallest distance, then phi; right after `measure` only."""
        return self.closest, -float(self.potentials.sum())

    def measure(self) -> None:
        """Find the closest pair and the potentials in its units."""
        runs = len(self.x)
        parts = [np.arange(start, min(start + ROWS, runs)) for start in range(0, runs, ROWS)]
        self.closest = min(float(self._squared(part).min()) for part in parts)
        self.potentials = np.concatenate(
            [self._potential(self._squared(part)).sum(axis=1) for part in parts]
        )

    def exchange(self, threshold: float, rng: np.random.Generator) -> None:
        """Exchange a value of a crowded point with the best of some points, if that is good.

        threshold: by which share of the point's potential phi may rise.
        """
        runs, parameters = self.x.shape
        drawn = rng.integers(runs, size=max(2, round(DRAWN * runs)))
        first = drawn[np.argmax(self.potentials[drawn])]
        column = rng.integers(parameters)
        others = rng.integers(runs - 1, size=min(TRIED, runs - 1))
        others += others >= first
        values = self.x[:, column]
        own, theirs = values[first], values[others]
        before = self._squared(np.append(others, first))
        shift = (theirs**2 - own**2)[:, None] - 2.0 * np.outer(theirs - own, values)
        tried = np.arange(len(others))
        between = before[tried, first]
        after = np.stack([before[-1] + shift, before[:-1] - shift])
        after[0, tried, others] = after[1, tried, first] = between
        potential = self._potential(after)
        sums = potential.sum(axis=2)
        change = sums.sum(axis=0) - self.potentials[first] - self.potentials[others]
        best = int(np.argmin(change))
        if change[best] < threshold * self.potentials[first] * rng.random():
            second = others[best]
            self.potentials += potential[:, best].sum(axis=0)
            self.potentials -= self._potential(before[[best, -1]]).sum(axis=0)
            self.potentials[[first, second]] = sums[:, best]
            self.norms[[first, second]] += (theirs[best] ** 2 - own**2) * np.array([1.0, -1.0])
            self.x[[first, second], column] = theirs[best], own

    def _squared(self, mine: NDArray[np.int64]) -> Floats:
        """Squared distances of the points `mine` to all points; infinite to themselves."""
        products = self.x[mine] @ self.x.T
        squared = self.norms[mine, None] + self.norms - 2.0 * products
        squared[np.arange(len(mine)), mine] = np.inf
        return np.asarray(squared)

    def _potential(self, squared: Floats) -> Floats:
        """Of pairs at these squared distances; by multiplication, which is exact everywhere."""
        power = self.closest / squared
        for _ in range(4):
            power *= power
        power *= UNIT
        return np.rint(power, out=power)
