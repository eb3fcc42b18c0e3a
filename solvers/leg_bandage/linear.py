"""From mechanical parts to one sparse system, and its direct solution.

The parts never change their patterns, so the way from their triplets to the compressed
columns, and the fill-reducing order of the unknowns, are worked out once and kept over all
Newton iterations. SuperLU (SciPy) always works; MKL Pardiso, when `pypardiso` is installed,
is several times faster.
"""

from __future__ import annotations

import importlib
import importlib.util
import weakref
from collections.abc import Sequence
from typing import Protocol

import numpy as np
from scipy.sparse import csc_array, csr_array
from scipy.sparse.linalg import splu

from surrogate.errors import SolverError, nearest

ANALYSE, FACTORISE, SOLVE = 11, 22, 33
# Pardiso's iparm, numbered from 1: own settings, METIS order, two refinement steps, small
# pivots raised at 1e-8, no scaling, transposed solves (columns are stored), no matching.
PARDISO_SETTINGS = {1: 1, 2: 2, 8: 2, 10: 8, 11: 0, 12: 2, 13: 0, 18: 0, 21: 0, 24: 0, 27: 0}


class Part(Protocol):
    """A piece of the mechanical model that acts on the shared vector of unknowns u.

    rows, cols  (nnz,) int32 triplet pattern; it never changes for the life of the part
    """

    rows: np.ndarray
    cols: np.ndarray

    def linearise(self, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Internal force (n_dofs,) and consistent tangent values (nnz,) at u."""


class System:
    """The sum of parts on the dofs that are free.

    parts   mechanical parts; n_dofs is the length of u
    fixed   dofs that do not move
    solver  `superlu`, `pardiso`, or `auto`: pardiso when installed
    """

    def __init__(
        self, parts: Sequence[Part], n_dofs: int, fixed: np.ndarray = (), solver: str = "auto"
    ):
        self.parts, self.n_dofs = tuple(parts), n_dofs
        free = np.ones(n_dofs, dtype=bool)
        free[np.asarray(fixed, dtype=int)] = False
        self.free = np.flatnonzero(free)
        number = np.where(free, np.cumsum(free) - 1, -1).astype(np.int32)
        rows = number[np.concatenate([part.rows for part in self.parts])]
        cols = number[np.concatenate([part.cols for part in self.parts])]
        pattern, self._slots = compress(rows, cols, len(self.free))
        self.factors = direct_solver(solver, pattern)

    def linearise(self, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Sum of the parts' residuals (n_dofs,) and of their tangents, the latter kept packed.

        Give the second value to `factorise` or to `matrix`.
        """
        answers = [part.linearise(u) for part in self.parts]
        values = np.concatenate([values for _, values in answers])
        packed = np.bincount(self._slots, values, minlength=self.factors.nnz + 1)[:-1]
        return sum(residual for residual, _ in answers), packed

    def factorise(self, packed: np.ndarray) -> None:
        """Factorise the tangent that `linearise` packed."""
        self.factors.factorise(packed)

    def solve(self, rhs: np.ndarray) -> np.ndarray:
        """Solution (n_dofs,) of tangent x = rhs with x = 0 on the fixed dofs."""
        answer = np.zeros(self.n_dofs)
        answer[self.free] = self.factors.solve(rhs[self.free])
        return answer

    def matrix(self, packed: np.ndarray) -> csc_array:
        """The packed tangent as a sparse matrix over the free dofs."""
        return self.factors.matrix(packed)


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


class SuperLU:
    """SciPy's SuperLU with a symmetric minimum-degree order that is found once."""

    def __init__(self, pattern: csc_array):
        self._pattern, self._order, self._lu = pattern, None, None
        self._ordered = False
        self.nnz = pattern.nnz

    def matrix(self, packed: np.ndarray) -> csc_array:
        """The matrix with these values, (n, n)."""
        return _with_values(self._pattern, packed)

    def factorise(self, packed: np.ndarray) -> None:
        """LU factors of the matrix with these values."""
        if self._order is None:
            self._lu = self._factors(self.matrix(packed), "MMD_AT_PLUS_A")
            self._keep_order(np.argsort(self._lu.perm_c))
        else:
            permuted = csc_array((packed[self._take], *self._permuted), shape=self._pattern.shape)
            self._lu = self._factors(permuted, "NATURAL")
            self._ordered = True

    def solve(self, rhs: np.ndarray) -> np.ndarray:
        """Solution for a right-hand side (n,)."""
        if not self._ordered:
            return self._lu.solve(rhs)
        answer = np.empty_like(rhs)
        answer[self._order] = self._lu.solve(rhs[self._order])
        return answer

    def _keep_order(self, order: np.ndarray) -> None:
        """Remember the pattern in that order, so that later factorisations need not look."""
        numbered = self.matrix(np.arange(1.0, self.nnz + 1))
        permuted = numbered[order][:, order].tocsc()
        permuted.sort_indices()
        self._order = order
        self._take = permuted.data.astype(np.int64) - 1
        self._permuted = permuted.indices, permuted.indptr

    @staticmethod
    def _factors(matrix: csc_array, order: str):
        try:
            return splu(matrix, permc_spec=order, diag_pivot_thresh=0.0,
                        options={"SymmetricMode": True})
        except RuntimeError as error:
            raise SolverError(
                f"the tangent is singular ({error}); hold more dofs or take a smaller step"
            ) from error


class Pardiso:
    """MKL Pardiso through `pypardiso`: order and symbolic factors are found once.

    Matching and scaling depend on the values, which the kept symbolic factors do not allow:
    they are off. Sequences of two refinement steps make up for that.
    """

    def __init__(self, pattern: csc_array):
        self._engine = importlib.import_module("pypardiso").PyPardisoSolver(mtype=11)
        for number, value in PARDISO_SETTINGS.items():
            self._engine.set_iparm(number, value)
        weakref.finalize(self, self._engine.free_memory, everything=True)
        self._matrix, self.nnz = pattern.copy(), pattern.nnz
        self._run(ANALYSE, np.zeros(pattern.shape[0]))

    def matrix(self, packed: np.ndarray) -> csc_array:
        """The matrix with these values, (n, n)."""
        return _with_values(self._matrix, packed)

    def factorise(self, packed: np.ndarray) -> None:
        """LU factors of the matrix with these values."""
        self._matrix = self.matrix(packed)
        self._run(FACTORISE, np.zeros(self._matrix.shape[0]))

    def solve(self, rhs: np.ndarray) -> np.ndarray:
        """Solution for a right-hand side (n,)."""
        return self._run(SOLVE, np.ascontiguousarray(rhs, dtype=float))

    def _run(self, phase: int, rhs: np.ndarray) -> np.ndarray:
        self._engine.set_phase(phase)
        try:
            return self._engine._call_pardiso(self._matrix, rhs)
        except importlib.import_module("pypardiso.pardiso_wrapper").PyPardisoError as error:
            raise SolverError(
                f"the tangent is singular ({error}); hold more dofs or take a smaller step"
            ) from error


ENGINES = {"superlu": SuperLU, "pardiso": Pardiso}


def direct_solver(name: str, pattern: csc_array) -> SuperLU | Pardiso:
    """The engine of that name for a pattern; `auto` is pardiso when it is installed."""
    installed = importlib.util.find_spec("pypardiso") is not None
    if name == "auto":
        name = "pardiso" if installed else "superlu"
    if name not in ENGINES:
        raise SolverError(f"linear solver: {nearest(name, [*ENGINES, 'auto'])}")
    if name == "pardiso" and not installed:
        raise SolverError(
            "linear solver pardiso needs pypardiso: pip install 'surrogate-studies[fast]', "
            "or take 'superlu'"
        )
    return ENGINES[name](pattern)


def _with_values(pattern: csc_array, values: np.ndarray) -> csc_array:
    return csc_array((values, pattern.indices, pattern.indptr), shape=pattern.shape)
