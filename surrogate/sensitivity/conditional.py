"""Points that share some coordinates, the others redrawn given them, under a Gaussian copula."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import special

from surrogate.estimator import Array
from surrogate.space.space import Space


@dataclass(frozen=True)
class Pairs:
    """Points X of the space's joint law, and for any set of inputs partners X'.

    X' agrees with X outside the set; inside it is drawn anew given what is outside. With
    z = standard normal scores of correlation R this is z'_S = R_SC R_CC^-1 z_C + L e_S,
    L L' = R_SS - R_SC R_CC^-1 R_CS, C the complement of S.

    scores, fresh  (run, parameter): scores z of X, and independent standard normal e
    """

    space: Space
    scores: Array
    fresh: Array

    @classmethod
    def of(cls, space: Space, u: Array) -> Pairs:
        """From uniform numbers u (run, 2 parameters)."""
        normal = special.ndtri(u)
        d = space.size
        root = np.linalg.cholesky(_correlation(space))
        return cls(space, normal[:, :d] @ root.T, normal[:, d:])

    def points(self) -> Array:
        """Coded points X (run, parameter)."""
        return self._coded(self.scores)

    def partners(self, redrawn: tuple[int, ...]) -> Array:
        """Coded points X' (run, parameter) with the inputs numbered `redrawn` drawn anew."""
        R, inside = _correlation(self.space), list(redrawn)
        outside = [j for j in range(self.space.size) if j not in redrawn]
        shift = R[np.ix_(inside, outside)] @ np.linalg.inv(R[np.ix_(outside, outside)])
        rest = R[np.ix_(inside, inside)] - shift @ R[np.ix_(outside, inside)]
        moved = self.scores.copy()
        moved[:, inside] = (
            self.scores[:, outside] @ shift.T + self.fresh[:, inside] @ np.linalg.cholesky(rest).T
        )
        return self._coded(moved)

    def _coded(self, scores: Array) -> Array:
        return Space(self.space.parameters).quantile(special.ndtr(scores))


def _correlation(space: Space) -> Array:
    return np.eye(space.size) if space.correlation is None else np.asarray(space.correlation)
