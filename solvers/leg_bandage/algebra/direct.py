"""Direct solution of sparse systems: single-precision factors, double-precision answers.

LU factors in single precision take half the time and memory of double ones. The answer is
refined against the matrix in double precision, x += solve(b - A x), which gains four to five
digits a step here (Wilkinson 1963; Carson and Higham 2018). Where it does not converge the
factors are made anew in double precision.

SuperLU (SciPy) always works; MKL Pardiso, when `pypardiso` is installed, is several times
faster. Both keep what depends on the pattern alone.
"""

from __future__ import annotations

import importlib
import os
import weakref
from functools import cache
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path
from typing import Any

import numpy as np
from scipy.sparse import csc_array
from scipy.sparse.linalg import splu

from surrogate.errors import SolverError, nearest

TOLERANCE, GOOD_ENOUGH, REFINEMENTS = 1e-12, 1e-9, 8
ANALYSE, FACTORISE, SOLVE = 11, 22, 33
# Pardiso's iparm, numbered from 1: own settings, METIS order, no refinement of its own, no
# scaling, transposed solves (columns are stored), no matching, work shared as for two threads
# whatever their number (34: the same digits always); then precision (28) and the power of
# ten below which pivots are raised (10).
PARDISO_SETTINGS = {1: 1, 2: 2, 8: 0, 11: 0, 12: 2, 13: 0, 18: 0, 21: 0, 24: 0, 27: 0, 34: 2}
PARDISO_PRECISION: dict[type, dict[int, int]] = {
    np.float32: {28: 1, 10: 8},
    np.float64: {28: 0, 10: 13},
}


class DirectSolver:
    """Factors of matrices that share one pattern, and refined solutions with them.

    name     `superlu`, `pardiso`, or `auto`: pardiso when it works here
    pattern  (n, n) with sorted indices; its values do not matter
    """

    def __init__(self, name: str, pattern: csc_array):
        self.engine = engine_class(name)
        self.pattern, self.matrix = pattern, None
        self._factors: dict[type, Any] = {np.float32: self.engine(pattern, np.float32)}
        self._precision: type = np.float32

    def factorise(self, values: np.ndarray) -> None:
        """Single-precision LU factors of the matrix with these values (nnz,)."""
        self.matrix = with_values(self.pattern, values)
        self._precision = np.float32
        self._factors[np.float32].factorise(self.matrix)

    def solve(self, rhs: np.ndarray) -> np.ndarray:
        """Solution for a right-hand side (n,); SolverError when the matrix is singular."""
        answer, left = self._refined(rhs)
        if not left < GOOD_ENOUGH and self._precision is np.float32:
            self._precision = np.float64
            if np.float64 not in self._factors:
                self._factors[np.float64] = self.engine(self.pattern, np.float64)
            self._factors[np.float64].factorise(self.matrix)
            answer, left = self._refined(rhs)
        if not np.isfinite(left):
            raise SolverError(_singular("the solution is not finite"))
        return answer

    def rough(self, rhs: np.ndarray) -> np.ndarray:
        """The factors applied once to a right-hand side (n,), unrefined: a preconditioner."""
        scale = np.abs(rhs).max() or 1.0
        return scale * self._factors[self._precision].solve(rhs / scale).astype(float)

    def _refined(self, rhs: np.ndarray) -> tuple[np.ndarray, float]:
        """Solution and what is left of the right-hand side, as a share of it."""
        size = np.abs(rhs).max()
        answer, residual, left = np.zeros_like(rhs), rhs, 1.0
        if size == 0:
            return answer, 0.0
        for _ in range(REFINEMENTS):
            scale = np.abs(residual).max()
            better = answer + scale * self._factors[self._precision].solve(residual / scale)
            residual = rhs - self.matrix @ better
            now = float(np.abs(residual).max() / size)
            if not now < left:
                break
            answer, left = better, now
            if left < TOLERANCE:
                break
        return answer, left


class SuperLU:
    """SciPy's SuperLU with a symmetric minimum-degree order that is found once."""

    def __init__(self, pattern: csc_array, precision: type):
        self._precision, self._ordered = precision, False
        self._order: np.ndarray | None = None

    def factorise(self, matrix: csc_array) -> None:
        """LU factors of a matrix (n, n) with the pattern."""
        if self._order is None:
            self._lu = self._decompose(matrix, "MMD_AT_PLUS_A")
            self._keep_order(matrix, np.argsort(self._lu.perm_c))
        else:
            permuted = with_values(self._permuted, matrix.data[self._take])
            self._lu = self._decompose(permuted, "NATURAL")
            self._ordered = True

    def solve(self, rhs: np.ndarray) -> np.ndarray:
        """Solution for a right-hand side (n,), in the engine's precision."""
        rhs = rhs.astype(self._precision)
        if not self._ordered:
            return self._lu.solve(rhs)
        answer = np.empty_like(rhs)
        answer[self._order] = self._lu.solve(rhs[self._order])
        return answer

    def _keep_order(self, matrix: csc_array, order: np.ndarray) -> None:
        """Remember the pattern in that order, so that later factorisations need not look."""
        numbered = with_values(matrix, np.arange(1.0, matrix.nnz + 1))
        self._permuted = numbered[order][:, order].tocsc()
        self._permuted.sort_indices()
        self._order, self._take = order, self._permuted.data.astype(np.int64) - 1

    def _decompose(self, matrix: csc_array, order: str):
        try:
            return splu(
                matrix.astype(self._precision),
                permc_spec=order,
                diag_pivot_thresh=0.0,
                options={"SymmetricMode": True},
            )
        except RuntimeError as error:
            raise SolverError(_singular(error)) from error


class Pardiso:
    """MKL Pardiso through `pypardiso`: order and symbolic factors are found once.

    Matching and scaling depend on the values, which the kept symbolic factors do not allow:
    they are off.
    """

    def __init__(self, pattern: csc_array, precision: type):
        module = pypardiso()
        # Spares each further engine a search of the whole installation for the library.
        os.environ.setdefault("PYPARDISO_MKL_RT", module.ps.libmkl._name)
        self._engine = module.PyPardisoSolver(mtype=11)
        for number, value in (PARDISO_SETTINGS | PARDISO_PRECISION[precision]).items():
            self._engine.set_iparm(number, value)
        weakref.finalize(self, self._engine.free_memory, everything=True)
        self._from_one = [index.astype(np.int32) + 1 for index in (pattern.indptr, pattern.indices)]
        self._values: np.ndarray = pattern.data.astype(precision)
        self._run(ANALYSE, np.zeros(pattern.shape[0]))

    def factorise(self, matrix: csc_array) -> None:
        """LU factors of a matrix (n, n) with the pattern."""
        self._values = matrix.data.astype(self._values.dtype)
        self._run(FACTORISE, np.zeros(matrix.shape[0]))

    def solve(self, rhs: np.ndarray) -> np.ndarray:
        """Solution for a right-hand side (n,), in the engine's precision."""
        return self._run(SOLVE, rhs)

    def _run(self, phase: int, rhs: np.ndarray) -> np.ndarray:
        """MKL's `pardiso`; pypardiso's own call would number the pattern from one each time."""
        engine, rhs = self._engine, rhs.astype(self._values.dtype)
        answer, failed = np.zeros_like(rhs), np.zeros(1, np.int32)
        one, kind, stage, size, quiet = np.array(
            [[1], [engine.mtype], [phase], [len(rhs)], [0]], np.int32
        )
        given = (
            engine.pt,
            one,
            one,
            kind,
            stage,
            size,
            self._values,
            *self._from_one,
            engine.perm,
            one,
            engine.iparm,
            quiet,
            rhs,
            answer,
            failed,
        )
        pardiso = engine._mkl_pardiso
        pardiso(
            *(
                array.ctypes.data_as(pointer)
                for array, pointer in zip(given, pardiso.argtypes, strict=True)
            )
        )
        if failed[0]:
            raise SolverError(_singular(f"Pardiso's error {failed[0]}"))
        return answer


ENGINES = {"superlu": SuperLU, "pardiso": Pardiso}


def engine_class(name: str) -> type:
    """The engine of that name; `auto` is pardiso where it works, superlu elsewhere.

    Raises SolverError for a name that is unknown, and for pardiso where it does not work.
    """
    if name not in (*ENGINES, "auto"):
        raise SolverError(f"linear solver: {nearest(name, [*ENGINES, 'auto'])}")
    if name == "superlu":
        return SuperLU
    if not isinstance(pypardiso(), Exception):
        return Pardiso
    if name == "auto":
        return SuperLU
    raise SolverError(
        f"linear solver pardiso does not work here ({pypardiso()}): pip install "
        "'surrogate-studies[fast]'; if MKL lies elsewhere, set PYPARDISO_MKL_RT to the path "
        "of its library libmkl_rt; or take 'superlu'"
    )


@cache
def pypardiso() -> Any:
    """The package, told where MKL is; or why it does not work here: its search takes seconds."""
    library = mkl_library()
    if library is not None:
        os.environ.setdefault("PYPARDISO_MKL_RT", str(library))
    try:
        return importlib.import_module("pypardiso")
    except (ImportError, OSError) as error:
        return error


def mkl_library() -> Path | None:
    """MKL's library as the package `mkl` installed it, whatever the number in its name.

    pypardiso looks for it under the prefix of this Python only.
    """
    try:
        files = distribution("mkl").files or ()
    except PackageNotFoundError:
        return None
    found = (Path(str(file.locate())) for file in files if "mkl_rt" in file.name)
    return next((path for path in found if path.is_file()), None)


def with_values(pattern: csc_array, values: np.ndarray) -> csc_array:
    """A matrix that shares its pattern's index arrays."""
    return csc_array((values, pattern.indices, pattern.indptr), shape=pattern.shape)


def _singular(reason) -> str:
    return f"the tangent is singular ({reason}); hold more dofs or take a smaller step"
