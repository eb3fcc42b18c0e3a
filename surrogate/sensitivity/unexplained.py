"""The share of the variance that a set of inputs leaves unexplained, dependent inputs included.

c(S) / Var f = E[Var(f | x outside S)] / Var f: half the mean square of f(X) - f(X'), with X'
redrawn inside S given the rest (as for Shapley effects), over that with all inputs redrawn.
For independent inputs it is the total index of S.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from surrogate.estimator import Array, Predictor
from surrogate.sensitivity.conditional import Pairs
from surrogate.sensitivity.draws import SAMPLES, Functions, Values
from surrogate.sensitivity.model import Seed
from surrogate.sensitivity.pick_freeze import ROUNDING, jackknife, unit_blocks
from surrogate.space.space import Space


@dataclass(frozen=True)
class Unexplained:
    """c(S) / Var f of any function, S the inputs numbered `redrawn`; each answer is (1,)."""

    space: Space
    redrawn: tuple[int, ...]
    seed: Seed = 0
    closed = False

    def of(self, estimator: Predictor) -> Values:
        """The share of one estimator, of all components of an array together."""
        return _share(self._squares(estimator.predict, SAMPLES).sum(axis=1))

    def of_functions(self, functions: Functions, pairs: int = SAMPLES) -> list[Values]:
        """The same for each column of functions(coded) (run, count)."""
        return [_share(part) for part in self._squares(functions, pairs).T]

    def sampled(self, functions: Functions, runs: int, scramblings: int) -> tuple[Values, Values]:
        """The share of functions(coded) (run, ...) as a whole, and its standard error."""
        parts = []
        for generator in np.random.default_rng(self.seed).spawn(scramblings):
            u = next(unit_blocks(2 * self.space.size, runs, runs, generator))
            parts.append(self.squares(functions, u).sum(axis=1))
        return jackknife(_share, np.stack(parts))

    def _squares(self, functions: Functions, pairs: int) -> Array:
        generator = np.random.default_rng(self.seed)
        u = next(unit_blocks(2 * self.space.size, pairs, pairs, generator))
        return self.squares(functions, u)

    def squares(self, functions: Functions, u: Array) -> Array:
        """c(S) and Var of each component, (2, component), from u (run, 2 parameters)."""
        pairs = Pairs.of(self.space, u)
        values = np.asarray(functions(pairs.points())).reshape(len(u), -1)
        everything = tuple(range(self.space.size))
        moved = (
            np.asarray(functions(pairs.partners(inside))).reshape(len(u), -1)
            for inside in (self.redrawn, everything)
        )
        found = np.stack([((values - other) ** 2).mean(axis=0) / 2.0 for other in moved])
        varies = found[1] > ROUNDING * (values**2).mean(axis=0)
        return np.asarray(found * varies)


def _share(parts: Array) -> Values:
    """The ratio of parts (2,) as an array (1,); 0 where nothing varies."""
    return (np.atleast_1d(parts[0] / parts[1] if parts[1] > 0.0 else 0.0),)
