"""Which level of fidelity to run next, and where: variance removed for a second of solver time.

A run of one level at x takes from the truth's variance at z, by that level's own process,

    f(z) c(x, z)^2 / (c(x, x) + t^2),

c its covariance given its runs, t^2 its nugget's variance, and f the product of the mean squares
of rho of all levels above (Le Gratiet and Garnier 2014, proposition 2). Averaged over the
parameters' law this is what `variance` takes for one level. A run of a level comes with those of
all cheaper ones at the point, which keeps designs nested; those that are done cost nothing. The
point and level with the most variance for a second are taken (Le Gratiet and Cannamela 2015,
"Cokriging-based sequential design strategies using fast cross-validation techniques for
multi-fidelity computer codes", Technometrics 57, 418-427, section 3).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from surrogate.adaptive.variance import covariances
from surrogate.regressors.level_process import LevelProcess

Array = NDArray[np.float64]
Truth = NDArray[np.bool_]
#: The processes of one output's levels, cheapest first.
Levels = Sequence[LevelProcess]


def gains(levels: Levels, X: Array, Z: Array) -> Array:
    """Variance of the truth, averaged over Z (k, d), that a run of each level alone takes.

    X (m, d) coded points; shape (m, levels), cheapest first.
    """
    columns, factor = [], np.ones(len(Z))
    for level in reversed(levels):
        run = level.parts(level.expanded(X))[-1] + level.variance_ * level.nugget_
        columns.append((covariances(level, X, Z) ** 2 @ factor) / len(Z) / run)
        if level.below is not None:
            rho, spread = level.rho(level.expanded(Z))
            factor = factor * (level.scale_ / (level.below.scale_ or 1.0)) ** 2 * (rho**2 + spread)
    return np.column_stack(columns[::-1])


def choose(
    outputs: Sequence[Levels],
    X: ArrayLike,
    Z: ArrayLike,
    seconds: ArrayLike,
    *,
    done: Truth | None = None,
    left: float = np.inf,
    least: int = 0,
) -> tuple[int, int] | None:
    """Number of the best candidate and of the level to run there, the cheapest being 0.

    outputs  the processes of each output's levels; their variances count as shares of the truth's
    X        coded candidates (m, d);  Z (k, d) points over which the variance is averaged
    seconds  of a run of each level, cheapest first
    done     (m, levels) which levels have a run at which candidate
    left     seconds that may be spent; None is returned when no choice is as cheap as that
    least    number of the cheapest level that may be chosen
    """
    X, Z, each = (np.asarray(one, dtype=float) for one in (X, Z, seconds))
    if any(len(each) != len(levels) for levels in outputs) or not (each > 0.0).all():
        raise ValueError(f"seconds {each.tolist()}: give one above 0 for each level")
    if not len(X):
        return None
    done = np.zeros((len(X), len(each)), dtype=bool) if done is None else done
    taken = np.zeros((len(X), len(each)))
    for levels in outputs:
        taken += gains(levels, X, Z) / (levels[-1].scale_ ** 2 or 1.0)
    removed = np.cumsum(np.where(done, 0.0, taken), axis=1)
    cost = np.cumsum(np.where(done, 0.0, each), axis=1)
    possible = ~done & (cost <= left) & (np.arange(len(each)) >= least)
    if not possible.any():
        return None
    worth = np.where(possible, removed / np.where(cost > 0.0, cost, 1.0), -np.inf)
    point, level = np.unravel_index(int(worth.argmax()), worth.shape)
    return int(point), int(level)
