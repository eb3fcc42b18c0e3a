"""Maximin Latin hypercubes by exchanges within a column.

Criterion: phi = sum over pairs of (squared distance)^-q, q = 10, that is Morris and
Mitchell's phi_p with p = 20 (1995, equation 2.2): near enough to the smallest distance, and
smooth. Search: enhanced stochastic evolution, Jin, Chen and Sudjianto 2005.
"""

from __future__ import annotations

import numpy as np

#: Rounds between changes of the threshold, and rounds in all.
ROUNDS_PER_STAGE = 25
ROUNDS = 8000
#: Of all pairs of runs, this share is tried for exchange in a round, up to the largest number.
SHARE_TRIED, MOST_TRIED = 0.15, 40
#: Work of a round is tried exchanges x runs x parameters; this much in all at most.
LARGEST_WORK = 2e9


def maximin(ranks: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Ranks (run, parameter) of a Latin hypercube whose points lie far apart.

    ranks: the integers 0..runs-1 in each column, in any order. Deterministic for a given
    generator: the search is bounded by rounds, not by time.
    """
    runs, parameters = ranks.shape
    if runs < 3 or parameters < 2:
        return ranks
    x = ranks.astype(float)
    tried = int(np.clip(SHARE_TRIED * runs * (runs - 1) / 2, 1, MOST_TRIED))
    rounds = int(np.clip(LARGEST_WORK / (tried * runs * parameters), 200, ROUNDS))
    best, best_phi = x.copy(), _phi(x)
    phi, threshold = best_phi, 0.005
    for _ in range(rounds // ROUNDS_PER_STAGE):
        accepted, improved, start = 0, 0, best_phi
        for step in range(ROUNDS_PER_STAGE):
            column = step % parameters
            pair, change = _best_exchange(x, column, tried, rng)
            # Relative to the present value: phi falls by orders of magnitude on the way.
            if change <= threshold * phi * rng.random():
                x[pair, column] = x[pair[::-1], column]
                phi += change
                accepted += 1
                if phi < best_phi:
                    best, best_phi, improved = x.copy(), phi, improved + 1
        phi = _phi(x)
        threshold *= _heating(
            accepted / ROUNDS_PER_STAGE, improved / ROUNDS_PER_STAGE, best_phi < start
        )
    return best.astype(int)


def _heating(accepted: float, improved: float, better: bool) -> float:
    """Factor on the threshold: Jin et al. 2005, section 3.3, improving and exploring."""
    if better:
        return 0.8 if accepted > 0.1 and improved < accepted else 1.0 / 0.8
    return 1.0 / 0.7 if accepted < 0.1 else 0.9 if accepted > 0.8 else 1.0


def _phi(x: np.ndarray) -> float:
    """Sum over pairs of the inverse power of their squared distance; x (run, parameter)."""
    return sum(
        _inverse_power(((x[i + 1 :] - x[i]) ** 2).sum(axis=1)).sum() for i in range(len(x) - 1)
    )


def _inverse_power(squared: np.ndarray) -> np.ndarray:
    """squared^-10 by multiplication: the power function would take most of the time."""
    a = 1.0 / squared
    b = a * a
    c = b * b
    return c * c * b


def _best_exchange(x: np.ndarray, column: int, tried: int, rng) -> tuple[np.ndarray, float]:
    """Of `tried` random pairs of runs, the one best exchanged in `column`; the change of phi.

    Only distances from those two runs change; that between them does not.
    """
    runs = len(x)
    first = rng.integers(runs, size=tried)
    second = (first + rng.integers(1, runs, size=tried)) % runs
    norms = (x * x).sum(axis=1)
    mine = np.concatenate([first, second])
    other = np.concatenate([second, first])
    # Ranks are whole numbers, so this way to write distances is exact.
    squared = norms[mine, None] + norms - 2.0 * (x[mine] @ x.T)
    values = x[:, column]
    shift = values[other] ** 2 - values[mine] ** 2
    after = squared + shift[:, None] - 2.0 * np.outer(values[other] - values[mine], values)
    row = np.arange(len(mine))
    for distances in (squared, after):
        distances[row, mine] = distances[row, other] = np.inf
    change = (_inverse_power(after) - _inverse_power(squared)).sum(axis=1)
    change = change[:tried] + change[tried:]
    best = int(np.argmin(change))
    return np.array([first[best], second[best]]), float(change[best])
