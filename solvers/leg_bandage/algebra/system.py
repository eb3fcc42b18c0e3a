"""From mechanical parts to one sparse system.

The parts never change their patterns, so the way from their triplets to compressed columns
is worked out once and kept over all Newton iterations, as is the order of elimination.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Protocol

import numpy as np
import numpy.typing as npt
from scipy.sparse import csc_array, csr_array
from threadpoolctl import ThreadpoolController

from .direct import with_values
from .reused_factors import ReusedFactors

# Dense products split over threads differ in their last digits; parts are fast on one.
DENSE = ThreadpoolController().select(internal_api="openblas")


Tangent = Callable[[], np.ndarray]


class Part(Protocol):
    """A piece of the mechanical model that acts on the shared vector of unknowns u.

    rows, cols  (nnz,) int32 triplet pattern; it never changes for the life of the part
    """

    rows: np.ndarray
    cols: np.ndarray

    def linearise(self, u: np.ndarray) -> tuple[np.ndarray, Tangent]:
        """Internal force (n_dofs,) at u, and what gives the consistent tangent's values (nnz,).

        A state that turns out to be in balance needs no tangent.
        """


class System:
    """The sum of parts on the dofs that are free.

    parts   mechanical parts; n_dofs is the length of u
    fixed   dofs that do not move
    solver  `superlu`, `pardiso`, or `auto`: pardiso where it works
    """

    def __init__(
        self, parts: Sequence[Part], n_dofs: int, fixed: npt.ArrayLike = (), solver: str = "auto"
    ):
        self.parts, self.n_dofs = tuple(parts), n_dofs
        free = np.ones(n_dofs, dtype=bool)
        free[np.asarray(fixed, dtype=int)] = False
        self.free = np.flatnonzero(free)
        number = np.where(free, np.cumsum(free) - 1, -1).astype(np.int32)
        rows = number[np.concatenate([part.rows for part in self.parts])]
        cols = number[np.concatenate([part.cols for part in self.parts])]
        pattern, self._slots = compress(rows, cols, len(self.free))
        self.factors = ReusedFactors(solver, pattern)

    def linearise(self, u: np.ndarray) -> tuple[np.ndarray, Tangent]:
        """Sum of the parts' residuals (n_dofs,), and their tangents' values, one after another.

        Give the values to `pack`. The digits do not depend on the number of threads. What is
        returned does not hold this system, which may go before it.
        """
        with DENSE.limit(limits=1):
            answers = [part.linearise(u) for part in self.parts]

        def tangent():
            with DENSE.limit(limits=1):
                return np.concatenate([values() for _, values in answers])

        return sum((residual for residual, _ in answers), np.zeros(self.n_dofs)), tangent

    def pack(self, values: np.ndarray) -> np.ndarray:
        """Values of the tangent of `linearise` summed into the stored entries, for `solve`."""
        return np.bincount(self._slots, values, minlength=self.factors.pattern.nnz + 1)[:-1]

    def solve(self, packed: np.ndarray, rhs: np.ndarray) -> np.ndarray:
        """Solution (n_dofs,) of tangent x = rhs with x = 0 on the fixed dofs.

        packed is a tangent from `pack`. Raises SolverError when it is singular.
        """
        answer = np.zeros(self.n_dofs)
        answer[self.free] = self.factors.solve(packed, rhs[self.free])
        return answer

    def matrix(self, packed: np.ndarray) -> csc_array:
        """The packed tangent as a sparse matrix over the free dofs."""
        return with_values(self.factors.pattern, packed)


def compress(rows: np.ndarray, cols: np.ndarray, n: int) -> tuple[csc_array, np.ndarray]:
    """Pattern of summed triplets and the slot of each triplet in its data.

    rows, cols  (nnz,) indices; a triplet with a negative one belongs to no slot
    Returns an (n, n) matrix without values and int slots (nnz,): triplets that belong to no
    slot get the number of stored entries, one past the last slot.
    """
    kept = np.flatnonzero((rows >= 0) & (cols >= 0))
    order = kept[_stable_order(rows[kept], n)]
    order = order[_stable_order(cols[order], n)]
    row, col = rows[order], cols[order]
    first = np.ones(len(order), dtype=bool)
    first[1:] = (row[1:] != row[:-1]) | (col[1:] != col[:-1])
    slots = np.full(len(rows), np.count_nonzero(first), dtype=np.int64)
    slots[order] = np.cumsum(first) - 1
    starts = np.searchsorted(col[first], np.arange(n + 1)).astype(np.int32)
    indices = row[first].astype(np.int32)
    return csc_array((np.ones(len(indices)), indices, starts), shape=(n, n)), slots


def _stable_order(keys: np.ndarray, n: int) -> np.ndarray:
    """Order that sorts integer keys in 0 .. n - 1, ties kept in place: a counting sort.

    SciPy's compiled transposition does the counting: key k of entry i stands at (i, k).
    """
    count = len(keys)
    entries = csr_array((np.ones(count, np.int8), keys, np.arange(count + 1)), shape=(count, n))
    return entries.tocsc().indices
