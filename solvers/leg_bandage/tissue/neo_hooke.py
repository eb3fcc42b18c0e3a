"""Nearly incompressible neo-Hookean soft tissue on trilinear hexahedra.

Energy per undeformed volume (Chassagne et al. 2018, equation 4):

    U = c10 (I1bar - 3) + kappa / 2 (J - 1)^2,     I1bar = J^(-2/3) tr(F^T F)

A pressure p, constant in each element, carries the volume change (Simo, Taylor and Pister
1985): U(u, p) = c10 (I1bar - 3) + p (Jbar - 1) - p^2 / (2 kappa), with Jbar the mean of J
over the element. Newton treats p as an unknown of its own and condenses it element by
element, p <- kappa (Jbar - 1) + (kappa / V) g . du with g = d(V Jbar)/du: the residual
becomes that of p = kappa (Jbar - 1) and the tangent keeps the old p, which takes far fewer
iterations than putting p = kappa (Jbar - 1) into the energy. Units: N, mm, MPa.
"""

from __future__ import annotations

import numpy as np
from skfem import Basis, ElementHex1, MeshHex

from surrogate.errors import SolverError

from ..algebra.system import Tangent


class Tissue:
    """The leg's soft tissue as a mechanical part (fixed pattern, residual, tangent).

    mesh    hexahedra; the unknowns are dof = 3 * vertex + component
    c10     MPa, one number or one an element; the shear modulus is 2 c10
    kappa   bulk modulus, MPa
    n_dofs  length of the whole vector of unknowns (default: this mesh alone)

    `pressure` (n_elements,) is the independent unknown p in MPa, negative in compression.
    """

    def __init__(self, mesh: MeshHex, c10, kappa: float, n_dofs: int | None = None):
        basis = Basis(mesh, ElementHex1(), intorder=3)
        shapes = [np.asarray(field.grad) for (field,) in basis.basis]
        self.gradients = np.ascontiguousarray(np.transpose(np.array(shapes), (2, 3, 1, 0)))
        self.weights = np.ascontiguousarray(basis.dx)
        self.volumes = self.weights.sum(axis=1)
        self.c10 = np.broadcast_to(np.asarray(c10, dtype=float), self.volumes.shape)
        self.kappa = float(kappa)
        self._natural = self.volumes, self.c10
        self.n_dofs = 3 * mesh.nvertices if n_dofs is None else n_dofs
        vertices = mesh.t.T.astype(np.int32)
        self.dofs = (3 * vertices[:, None, :] + np.arange(3, dtype=np.int32)[:, None]).reshape(
            -1, 24
        )
        square = (len(vertices), 24, 24)
        self.rows = np.broadcast_to(self.dofs[:, :, None], square).reshape(-1)
        self.cols = np.broadcast_to(self.dofs[:, None, :], square).reshape(-1)
        self.pressure = np.zeros(len(vertices))
        self._volume_at, self._volume_gradient = self.volumes, np.zeros(self.dofs.shape)

    def grow(self, growth: np.ndarray | float, stiffening: np.ndarray | float = 1.0) -> None:
        """Swell to `growth` times the first volume and stiffen, an element or all, from now on.

        F = F_e F_g with F_g = growth^(1/3) 1 (Rodriguez, Hoger, McCulloch 1994): the isochoric
        strain is untouched, J_e = J / growth, and energies are per grown volume.
        """
        volumes, c10 = self._natural
        self.volumes = volumes * growth
        self.c10 = c10 * growth * stiffening

    def linearise(self, u: np.ndarray) -> tuple[np.ndarray, Tangent]:
        """Residual (n_dofs,) and tangent, values (n_elements * 576,), with p condensed.

        Raises SolverError when an element is turned inside out.
        """
        F = self._deformation(u)
        J, spatial = self._spatial_gradients(F)
        w = self.weights
        stretch = 2 * self.c10[:, None] * np.cbrt(J) ** -2
        b = F @ F.swapaxes(-1, -2)
        trace = np.trace(b, axis1=-2, axis2=-1)
        tau = (w * stretch)[..., None, None] * (b - (trace / 3)[..., None, None] * np.eye(3))
        tau_g = (tau @ spatial).reshape(*w.shape, 24)
        m = w * 2 / 3 * stretch * trace
        p = w * J * self.pressure[:, None]

        spatial = spatial.reshape(*w.shape, 24)
        self._volume_at = np.sum(w * J, axis=1)
        self._volume_gradient = np.einsum("eq,eql->el", w * J, spatial)
        p_next = self.kappa * (self._volume_at / self.volumes - 1)
        force = tau_g.sum(axis=1) + p_next[:, None] * self._volume_gradient
        residual = np.bincount(self.dofs.ravel(), force.ravel(), minlength=self.n_dofs)
        bulk = np.sqrt(self.kappa / self.volumes)[:, None] * self._volume_gradient
        return residual, lambda: _stiffness(spatial, tau_g, m, p, bulk).reshape(-1)

    def advance(self, du: np.ndarray, step: float = 1.0) -> None:
        """Move the pressures along the Newton increment `du`; `step` is the damping."""
        change = np.einsum("el,el->e", self._volume_gradient, du[self.dofs])
        target = self.kappa * ((self._volume_at + change) / self.volumes - 1)
        self.pressure = self.pressure + step * (target - self.pressure)

    def state(self) -> tuple[np.ndarray, ...]:
        """The pressures (n_elements,), MPa, and what the next `advance` starts from."""
        return self.pressure, self._volume_at, self._volume_gradient

    def restore(self, state: tuple[np.ndarray, ...]) -> None:
        """Put back what `state` returned."""
        self.pressure, self._volume_at, self._volume_gradient = state

    def energy(self, u: np.ndarray) -> float:
        """Stored energy, N mm, with the volume change by element means of J."""
        F = self._deformation(u)
        J = np.linalg.det(F)
        invariant = np.cbrt(J) ** -2 * np.einsum("eqij,eqij->eq", F, F)
        shape = np.sum(self.weights * self.c10[:, None] * (invariant - 3))
        dilation = np.sum(self.weights * J, axis=1) / self.volumes - 1
        return float(shape + self.kappa / 2 * np.sum(self.volumes * dilation**2))

    def _deformation(self, u: np.ndarray) -> np.ndarray:
        """Deformation gradients, (n_elements, 8 points, 3, 3)."""
        local = u[self.dofs].reshape(-1, 1, 3, 8)
        return local @ self.gradients.swapaxes(-1, -2) + np.eye(3)

    def _spatial_gradients(self, F: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """J (n_elements, 8 points) and F^-T grad N (n_elements, 8 points, 3, 8 nodes)."""
        cofactors = np.stack(
            [np.cross(F[..., i - 2, :], F[..., i - 1, :]) for i in range(3)], axis=-2
        )
        J = np.einsum("eqk,eqk->eq", F[..., 0, :], cofactors[..., 0, :])
        if not J.min() > 0:
            element = int(np.argmin(J.min(axis=1)))
            raise SolverError(
                f"tissue element {element} is turned inside out (J = {J.min():.2g}); "
                "take a smaller step"
            )
        return J, (cofactors / J[..., None, None]) @ self.gradients


def _stiffness(g, tau_g, m, p, bulk) -> np.ndarray:
    """Element tangents (n_elements, 24, 24), local dof = 8 * component + node.

    With g_a = F^-T grad N_a, tau the Kirchhoff stress of c10, m = 2/3 tr of its full part:

        K_ai,bj = sum_q  m [(delta_ij g_a.g_b + g_aj g_bi) / 2 - g_ai g_bj / 3]
                  - 2/3 (g_ai (tau g_b)_j + (tau g_a)_i g_bj) + delta_ij g_a.tau g_b
                  + p J (g_ai g_bj - g_aj g_bi)  + bulk_ai bulk_bj

    g, tau_g  (n_elements, 8 points, 24);  m, p  (n_elements, 8), times the weights already
    """
    m, p = m[..., None], p[..., None]
    left = np.concatenate([g, tau_g, bulk[:, None]], axis=1)
    right = np.concatenate([(p - m / 3) * g - 2 / 3 * tau_g, -2 / 3 * g, bulk[:, None]], axis=1)
    K = left.swapaxes(1, 2) @ right
    swapped = (g.swapaxes(1, 2) @ ((m / 2 - p) * g)).reshape(-1, 3, 8, 3, 8)
    K.reshape(-1, 3, 8, 3, 8)[:] += swapped.transpose(0, 3, 2, 1, 4)
    by_component = (len(g), -1, 8)
    direct = g.reshape(by_component).swapaxes(1, 2) @ (m / 2 * g + tau_g).reshape(by_component)
    for component in range(3):
        block = slice(8 * component, 8 * component + 8)
        K[:, block, block] += direct
    return K
