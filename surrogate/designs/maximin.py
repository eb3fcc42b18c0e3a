"""Maximin Latin hypercubes by exchanges within a column.

Criterion: phi = sum over pairs of (squared distance)^-q, q = 10, that is Morris and
Mitchell's phi_p with p = 20 (1995, equation 2.2): near enough to the smallest distance, and
smooth. Search: enhanced stochastic evolution, Jin, Chen and Sudjianto 2005.
"""

from __future__ import annotations

import numpy as np

#: Exchanges tried at once, rounds between changes of temperature, and rounds in all.
TRIED = 40
ROUNDS_PER_STAGE = 100
ROUNDS = 6000
#: Work of one round is tried exchanges x runs x parameters; this many in all at most.
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
    rounds = int(np.clip(LARGEST_WORK / (TRIED * runs * parameters), 200, ROUNDS))
    best, best_phi = x.copy(), _phi(x)
    phi, threshold = best_phi, 0.005
    for _ in range(rounds // ROUNDS_PER_STAGE):
        accepted, improved, start = 0, 0, best_phi
        for step in range(ROUNDS_PER_STAGE):
            column = step % parameters
            pair, change = _best_exchange(x, column, rng)
            # Relative to the present value: phi falls by orders of magnitude on the way.
            if change <= threshold * phi * rng.random():
                x[pair, column] = x[pair[::-1], column]
                phi += change
                accepted += 1
                if phi < best_phi:
                    best, best_phi, improved = x.copy(), phi, improved + 1
        phi = _phi(x)
        threshold *= _heating(accepted / ROUNDS_PER_STAGE, improved / ROUNDS_PER_STAGE,
                              best_phi < start)
    return best.astype(int)


def _heating(accepted: float, improved: float, better: bool) -> float:
    """Factor on the threshold: Jin et al. 2005, section 3.3, improving and exploring."""
    if better:
        return 0.8 if accepted > 0.1 and improved < accepted else 1.0 / 0.8
    return 1.0 / 0.7 if accepted < 0.1 else 0.9 if accepted > 0.8 else 1.0


def _phi(x: np.ndarray) -> float:
    """Sum over pairs of the inverse power of their squared distance; x (run, parameter)."""
    return sum(_inverse_power(((x[i + 1:] - x[i]) ** 2).sum(axis=1)).sum()
               for i in range(len(x) - 1))


def _inverse_power(squared: np.ndarray) -> np.ndarray:
    """squared^-10 by multiplication: the power function would take most of the time."""
    a = 1.0 / squared
    b = a * a
    c = b * b
    return c * c * b


def _best_exchange(x: np.ndarray, column: int, rng) -> tuple[np.ndarray, float]:
    """The pair of runs whose values in `column` are best exchanged, and the change of phi.

    Only distances from those two runs change; that between them does not.
    """
    runs = len(x)
    first = rng.integers(runs, size=TRIED)
    second = (first + rng.integers(1, runs, size=TRIED)) % runs
    values = x[:, column]
    change = (_moved(x, values, first, second) + _moved(x, values, second, first))
    best = int(np.argmin(change))
    return np.array([first[best], second[best]]), float(change[best])


def _moved(x: np.ndarray, values: np.ndarray, mine: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Change of phi when runs `mine` take the values of runs `other` in one column; (tried,)."""
    squared = ((x[mine, None, :] - x[None, :, :]) ** 2).sum(axis=2)
    after = squared + (values[other, None] - values) ** 2 - (values[mine, None] - values) ** 2
    tried = np.arange(len(mine))
    for distances in (squared, after):
        distances[tried, mine] = distances[tried, other] = np.inf
    return (_inverse_power(after) - _inverse_power(squared)).sum(axis=1)
