"""Points that share some coordinates, the others redrawn given them.

Dependence comes from a Gaussian copula, from constraints, or both. With constraints the
conditional law is that of the copula restricted to what is left: draws of it that break a
constraint are rejected; where that fails, points walk from X, which lies inside.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import special

from surrogate.estimator import Array
from surrogate.space.region import Region, step
from surrogate.space.space import Space

Rows = NDArray[np.intp]

#: Draws that break a constraint are tried again so often; steps of a walk for each input.
TRIES, STEPS = 60, 10


@dataclass(frozen=True)
class Pairs:
    """Points X of the space's joint law, and for any set of inputs partners X'.

    X' agrees with X outside the set; inside it is drawn anew given what is outside. With
    z = standard normal scores of correlation R this is z'_S = R_SC R_CC^-1 z_C + L e_S,
    L L' = R_SS - R_SC R_CC^-1 R_CS, C the complement of S.

    scores, fresh  (run, parameter): scores z of X, and independent standard normal e
    inside         coded X, (run, parameter), where there are constraints
    """

    space: Space
    scores: Array
    fresh: Array
    inside: Array | None = None

    @classmethod
    def of(cls, space: Space, u: Array) -> Pairs:
        """From uniform numbers u (run, 2 parameters)."""
        normal = special.ndtri(u)
        d = space.size
        root = np.linalg.cholesky(_correlation(space))
        found = cls(space, normal[:, :d] @ root.T, normal[:, d:])
        return found if space.region is None else found._inside(space.region)

    def _inside(self, region: Region) -> Pairs:
        """The same with points outside the region drawn anew, and scores that agree."""
        coded, kept = region.moved(self._coded(self.scores))
        scores, rng = self.scores.copy(), self._rng(0)
        root = np.linalg.cholesky(_correlation(self.space))
        lost = np.flatnonzero(~kept)
        share, inside = region.found
        for _ in range(TRIES):
            if not len(lost):
                break
            tried = rng.standard_normal((len(lost), self.space.size)) @ root.T
            moved, kept = region.moved(self._coded(tried))
            coded[lost[kept]], scores[lost[kept]] = moved[kept], tried[kept]
            lost = lost[~kept]
        if len(lost):  # a small region: points of the law that is left, by walking
            u = region.walk(inside[rng.integers(len(inside), size=len(lost))], rng)
            scores[lost] = special.ndtri(u) @ root.T
            coded[lost] = region.points(u)[0]
        for j in region.dependent:
            scores[:, j] = special.ndtri(np.clip(0.5 * (coded[:, j] + 1.0), 1e-15, 1.0 - 1e-15))
        return Pairs(self.space, scores, self.fresh, coded)

    def _rng(self, *purpose: int) -> np.random.Generator:
        """Random numbers besides, the same for the same points and purpose."""
        seed = np.abs(self.fresh[0] * 1e9).astype(np.int64).tolist()
        return np.random.default_rng([*purpose, *seed])

    def points(self) -> Array:
        """Coded points X (run, parameter)."""
        return self._coded(self.scores) if self.inside is None else self.inside

    def partners(self, redrawn: tuple[int, ...]) -> Array:
        """Coded points X' (run, parameter) with the inputs numbered `redrawn` drawn anew."""
        moved = self._redrawn(redrawn, self.fresh)
        if self.inside is None or self.space.region is None:
            return self._coded(moved)
        return self._kept(self.space.region, redrawn, moved, self.inside)

    def _kept(self, region: Region, redrawn: tuple[int, ...], moved: Array, inside: Array) -> Array:
        """Partners that keep the constraints: draws that do not are rejected, then walk."""
        partners, left, rng = inside.copy(), np.arange(len(inside)), self._rng(1, *redrawn)
        for _ in range(TRIES):
            coded, kept = self._tried(region, redrawn, moved, left)
            partners[left[kept]] = coded[kept]
            left = left[~kept]
            if not len(left):
                return partners
            fresh = rng.standard_normal((len(left), self.space.size))
            moved = self._redrawn(redrawn, fresh, left)
        u = special.ndtr(self._residuals(redrawn, left))
        for _ in range(STEPS * len(redrawn)):
            u = step(u, lambda v, rows: self._at(region, redrawn, v, left[rows])[1], rng)
        coded, kept = self._at(region, redrawn, u, left)
        partners[left[kept]] = coded[kept]
        return partners

    def _tried(
        self, region: Region, redrawn: tuple[int, ...], scores: Array, rows: Rows
    ) -> tuple[Array, NDArray[np.bool_]]:
        """Coded points of scores, coordinates that are not redrawn as they were; which hold."""
        assert self.inside is not None
        coded, columns = self.inside[rows].copy(), list(redrawn)
        coded[:, columns] = self._coded(scores)[:, columns]
        return region.moved(coded, redrawn)

    def _at(
        self, region: Region, redrawn: tuple[int, ...], u: Array, rows: Rows
    ) -> tuple[Array, NDArray[np.bool_]]:
        """The same from uniform numbers u (run, redrawn) of the conditional law."""
        fresh = np.zeros((len(rows), self.space.size))
        fresh[:, list(redrawn)] = special.ndtri(u)
        return self._tried(region, redrawn, self._redrawn(redrawn, fresh, rows), rows)

    def _redrawn(self, redrawn: tuple[int, ...], fresh: Array, rows: Rows | None = None) -> Array:
        """Scores with those numbered `redrawn` drawn anew from standard normal `fresh`."""
        scores = self.scores if rows is None else self.scores[rows]
        shift, root, inside, outside = self._conditional(redrawn)
        moved = scores.copy()
        moved[:, inside] = scores[:, outside] @ shift.T + fresh[:, inside] @ root.T
        return moved

    def _residuals(self, redrawn: tuple[int, ...], rows: Rows) -> Array:
        """The standard normal e (run, redrawn) that give the scores of X themselves."""
        shift, root, inside, outside = self._conditional(redrawn)
        scores = self.scores[rows]
        rest = scores[:, inside] - scores[:, outside] @ shift.T
        return np.asarray(np.linalg.solve(root, rest.T).T)

    def _conditional(self, redrawn: tuple[int, ...]) -> tuple[Array, Array, list[int], list[int]]:
        """R_SC R_CC^-1, L, S and C."""
        R, inside = _correlation(self.space), list(redrawn)
        outside = [j for j in range(self.space.size) if j not in redrawn]
        shift = R[np.ix_(inside, outside)] @ np.linalg.inv(R[np.ix_(outside, outside)])
        rest = R[np.ix_(inside, inside)] - shift @ R[np.ix_(outside, inside)]
        root = np.asarray(np.linalg.cholesky(rest), dtype=float)
        return shift, root, inside, outside

    def _coded(self, scores: Array) -> Array:
        return Space(self.space.parameters).quantile(special.ndtr(scores))


def points(space: Space, u: Array) -> Array:
    """Coded points (run, parameter) of the joint law, constraints kept, of u (run, parameter)."""
    if space.region is None:
        return space.quantile(u)
    return Pairs.of(space, np.hstack([u, u])).points()


def _correlation(space: Space) -> Array:
    return np.eye(space.size) if space.correlation is None else np.asarray(space.correlation)
