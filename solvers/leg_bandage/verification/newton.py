"""Newton's method on constrained unknowns u = basis q, for the verification problems."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.sparse import coo_array, csr_array, eye_array
from scipy.sparse.linalg import splu

from surrogate.errors import SolverError

from ..algebra.system import Part


def newton(
    parts: Sequence[Part], basis: csr_array, load=0.0, start=None, tolerance=1e-9, limit=40
) -> tuple[np.ndarray, list[float]]:
    """Balance of the parts' internal forces with a dead load.

    basis  (n_dofs, n_free) sparse: u = basis q; load (n_dofs,) N; start (n_dofs,) mm
    Returns u (n_dofs,) and the largest correction of each iteration, mm.
    Raises SolverError when the corrections stay above `tolerance` (mm).
    """
    u = np.zeros(basis.shape[0]) if start is None else start.copy()
    corrections: list[float] = []
    while not corrections or corrections[-1] > tolerance:
        if len(corrections) == limit:
            raise SolverError(
                f"no balance after {limit} iterations, last correction {corrections[-1]:.2g} mm; "
                "apply the load in more steps"
            )
        answers = [part.linearise(u) for part in parts]
        residual = basis.T @ (sum(r for r, _ in answers) - load)
        tangent = basis.T @ tangent_matrix(parts, [t() for _, t in answers], len(u)) @ basis
        du = basis @ splu(tangent.tocsc()).solve(-residual)
        for part in parts:
            if hasattr(part, "advance"):
                part.advance(du)
        u += du
        corrections.append(float(np.abs(du).max()))
    return u, corrections


def tangent_matrix(parts: Sequence[Part], values: Sequence[np.ndarray], n_dofs: int) -> csr_array:
    """The parts' tangents (n_dofs, n_dofs) from their triplet values."""
    tangents = (
        coo_array((v, (part.rows, part.cols)), shape=(n_dofs, n_dofs)).tocsr()
        for part, v in zip(parts, values, strict=True)
    )
    return sum(tangents, csr_array((n_dofs, n_dofs)))


def held(n_dofs: int, fixed: np.ndarray) -> csr_array:
    """Basis that leaves all dofs free but the fixed ones."""
    free = np.setdiff1d(np.arange(n_dofs), fixed)
    return eye_array(n_dofs, format="csc")[:, free].tocsr()
