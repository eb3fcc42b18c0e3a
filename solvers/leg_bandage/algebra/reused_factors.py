"""Newton's linear systems with factors that are kept as long as they serve.

A tangent changes little from one iteration to the next once contact has settled. The LU
factors of an earlier tangent then precondition GMRES (Saad and Schultz 1986) on the present
one so well that some iterations, each a pair of triangular solves, replace a factorisation
that costs thirty to a hundred of them. New factors are made when the old ones take more
than `WORTH` iterations; the answer satisfies the present system to `SHARE` in either case.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import csc_array

from .direct import DirectSolver, with_values

SHARE = 1e-3
"""What may be left of the right-hand side: Newton's own error is larger."""
WORTH, MOST = 20, 30
"""GMRES iterations after which the next system gets factors of its own; and this one."""


class ReusedFactors:
    """Solutions of systems that share one pattern and change slowly.

    name     `superlu`, `pardiso`, or `auto`: pardiso where it works
    pattern  (n, n) with sorted indices; its values do not matter
    """

    def __init__(self, name: str, pattern: csc_array):
        self.direct, self.factorisations = DirectSolver(name, pattern), 0
        self._last = MOST + 1

    @property
    def pattern(self) -> csc_array:
        """The pattern that all matrices share."""
        return self.direct.pattern

    def solve(self, values: np.ndarray, rhs: np.ndarray) -> np.ndarray:
        """Answer (n,) of the matrix with these values (nnz,); SolverError when singular."""
        if self._last <= WORTH:
            matrix = with_values(self.pattern, values)
            answer, self._last = gmres(matrix, rhs, self.direct.rough)
            if self._last <= MOST:
                return answer
        self.direct.factorise(values)
        self.factorisations += 1
        self._last = 0
        return self.direct.solve(rhs)


def gmres(matrix, rhs, precondition) -> tuple[np.ndarray, int]:
    """Right-preconditioned GMRES from zero, by modified Gram-Schmidt (Saad 2003, alg. 9.5).

    Unlike SciPy's, which stops on the preconditioned residual and then restarts, it stops when
    |rhs - matrix x| is SHARE of |rhs|. Returns x and the iterations taken, MOST + 1 when MOST
    did not do.
    """
    size = np.linalg.norm(rhs)
    if size == 0:
        return np.zeros_like(rhs), 0
    basis, moved = [rhs / size], []
    hessenberg, target = np.zeros((MOST + 1, MOST)), np.eye(MOST + 1, 1).ravel() * size
    for k in range(MOST):
        moved.append(precondition(basis[k]))
        new = matrix @ moved[k]
        for i, old in enumerate(basis):
            hessenberg[i, k] = old @ new
            new -= hessenberg[i, k] * old
        hessenberg[k + 1, k] = np.linalg.norm(new)
        part = hessenberg[: k + 2, : k + 1]
        share, _, _, _ = np.linalg.lstsq(part, target[: k + 2])
        left = np.linalg.norm(part @ share - target[: k + 2])
        if left <= SHARE * size:
            return np.tensordot(share, np.array(moved), 1), k + 1
        if not np.isfinite(left):
            break
        basis.append(new / hessenberg[k + 1, k])
    return np.zeros_like(rhs), MOST + 1
