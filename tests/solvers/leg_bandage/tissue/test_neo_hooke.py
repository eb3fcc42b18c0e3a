"""Soft tissue against exact solutions of finite elasticity."""

import numpy as np
import pytest
from scipy.sparse import coo_array

from surrogate.errors import SolverError
from surrogate_solvers.leg_bandage.tissue.mesh import cylindrical_surface, leg_mesh
from surrogate_solvers.leg_bandage.tissue.neo_hooke import Tissue
from surrogate_solvers.leg_bandage.verification.follower_pressure import skin_pressure
from surrogate_solvers.leg_bandage.verification.newton import held, newton
from surrogate_solvers.leg_bandage.verification.thick_cylinder import (
    annulus,
    hooped,
    hooped_exactly,
    pressed,
    pressed_exactly,
)

MMHG = 1.33322e-4


def uneven_leg(n_theta=8, n_depth=2, n_z=3):
    """A short leg whose skin is neither round nor straight."""
    skin = cylindrical_surface(
        lambda theta, z: 40 + 3 * np.cos(theta) + 2 * np.sin(2 * theta) + 0.1 * z
    )
    return leg_mesh(
        skin, cylindrical_surface(18.0), np.linspace(0, 30, n_z + 1), n_theta, n_depth, 2.0
    )


def matrix(part, values):
    """The part's tangent, (n_dofs, n_dofs)."""
    return coo_array((values, (part.rows, part.cols)), shape=(part.n_dofs, part.n_dofs)).tocsr()


def difference(part, u, direction, h=1e-5):
    """Central difference of the residual along a direction."""
    ahead, behind = (part.linearise(u + step * direction)[0] for step in (h, -h))
    return (ahead - behind) / (2 * h)


def test_residual_is_the_derivative_of_the_energy():
    """Virtual work: residual . v = dU(u + t v)/dt, central differences, 1e-7."""
    leg = uneven_leg()
    tissue = Tissue(leg.mesh, 5e-3, 14.3)
    u, v = np.random.default_rng(0).normal(0, 0.3, (2, tissue.n_dofs))
    ahead, behind = (tissue.energy(u + h * v) for h in (1e-5, -1e-5))
    assert tissue.linearise(u)[0] @ v == pytest.approx((ahead - behind) / 2e-5, rel=1e-7)


def test_tangent_is_the_derivative_of_the_residual():
    """With p at kappa (Jbar - 1) the condensed tangent is consistent: differences, 1e-6."""
    leg = uneven_leg()
    tissue = Tissue(leg.mesh, np.linspace(2e-3, 8e-3, leg.mesh.nelements), 14.3)
    rng = np.random.default_rng(1)
    u, v = rng.normal(0, 0.3, tissue.n_dofs), rng.normal(size=tissue.n_dofs)
    tissue.linearise(u)
    tissue.advance(np.zeros_like(u))
    K = matrix(tissue, tissue.linearise(u)[1]())
    found = difference(tissue, u, v)
    np.testing.assert_allclose(K @ v, found, atol=1e-6 * np.abs(found).max())
    assert abs(K - K.T).max() < 1e-12 * abs(K).max()


def test_condensed_step_equals_the_mixed_step():
    """Newton on (u, p) together, dense, gives the same du and the same next p."""
    leg = uneven_leg(4, 1, 1)
    tissue = Tissue(leg.mesh, 5e-3, 14.3)
    rng = np.random.default_rng(2)
    u, p = rng.normal(0, 0.3, tissue.n_dofs), rng.normal(0, 1e-2, leg.mesh.nelements)
    tissue.pressure = p
    residual, tangent = tissue.linearise(u)
    values, before = tangent(), tissue.state()
    g = np.zeros((tissue.n_dofs, len(p)))
    for element, dofs in enumerate(tissue.dofs):
        g[dofs, element] = tissue._volume_gradient[element]
    V, dilation = tissue.volumes, tissue._volume_at / tissue.volumes - 1
    target = tissue.kappa * dilation
    K_uu = matrix(tissue, values).toarray() - (g * tissue.kappa / V) @ g.T
    R_u, R_p = residual + g @ (p - target), V * (dilation - p / tissue.kappa)
    free = np.setdiff1d(np.arange(tissue.n_dofs), leg.fixed_dofs())
    K = np.block([[K_uu[np.ix_(free, free)], g[free]], [g[free].T, -np.diag(V / tissue.kappa)]])
    step = np.linalg.solve(K, -np.concatenate([R_u[free], R_p]))
    du = np.zeros(tissue.n_dofs)
    du[free] = np.linalg.solve(
        matrix(tissue, values).toarray()[np.ix_(free, free)], -residual[free]
    )
    np.testing.assert_allclose(du[free], step[: len(free)], atol=1e-8 * np.abs(step).max())
    tissue.advance(du)
    np.testing.assert_allclose(tissue.pressure, p + step[len(free) :], atol=1e-8)
    tissue.linearise(u + du)
    tissue.restore(before)
    tissue.advance(du, step=0.25)
    np.testing.assert_allclose(tissue.pressure, p + 0.25 * step[len(free) :], atol=1e-8)


def test_homogeneous_deformation_is_in_balance_inside():
    """Patch test: any affine map leaves no force at inner nodes, and the closed-form energy."""
    leg = uneven_leg(8, 3, 4)
    tissue = Tissue(leg.mesh, 5e-3, 14.3)
    F = np.array([[1.05, 0.1, 0.02], [-0.03, 0.95, 0.08], [0.01, 0.04, 1.02]])
    places = leg.mesh.p.T
    u = (places @ F.T - places).ravel()
    inner = leg.nodes[:, 1:-1, 1:-1].ravel()
    residual = tissue.linearise(u)[0].reshape(-1, 3)
    assert np.abs(residual[inner]).max() < 1e-12 * np.abs(residual).max()
    J = np.linalg.det(F)
    density = 5e-3 * (np.sum(F**2) * J ** (-2 / 3) - 3) + 14.3 / 2 * (J - 1) ** 2
    assert tissue.energy(u) == pytest.approx(density * tissue.volumes.sum(), rel=1e-12)


def test_rigid_motion_costs_nothing():
    """Objectivity: a turn by 70 degrees and a shift leave no force."""
    leg = uneven_leg()
    tissue = Tissue(leg.mesh, 5e-3, 14.3)
    c, s = np.cos(1.2), np.sin(1.2)
    turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]) @ np.array(
        [[1, 0, 0], [0, c, s], [0, -s, c]]
    )
    u = (leg.mesh.p.T @ turn.T + [5, -3, 2] - leg.mesh.p.T).ravel()
    assert np.abs(tissue.linearise(u)[0]).max() < 1e-11


def test_follower_pressure_tangent():
    """The load's tangent against central differences of the load, 1e-8."""
    leg = uneven_leg()
    load = skin_pressure(leg, 4e-3)
    rng = np.random.default_rng(4)
    u, v = rng.normal(0, 0.3, load.n_dofs), rng.normal(size=load.n_dofs)
    found = difference(load, u, v)
    np.testing.assert_allclose(
        matrix(load, load.linearise(u)[1]()) @ v, found, atol=1e-8 * np.abs(found).max()
    )


def test_follower_pressure_resultant():
    """Around a prism the forces add up to nothing, and their virial to 2 p times its volume."""
    leg = leg_mesh(
        cylindrical_surface(40.0), cylindrical_surface(10.0), np.linspace(0, 30, 4), 12, 1
    )
    force = skin_pressure(leg, 4e-3).linearise(np.zeros(leg.n_dofs))[0].reshape(-1, 3)
    np.testing.assert_allclose(force.sum(axis=0), 0, atol=1e-14)
    radial = np.einsum("ni,ni->n", force, leg.mesh.p.T * [1, 1, 0])
    polygon = 12 * 40**2 * np.sin(np.pi / 6) / 2
    assert radial.sum() == pytest.approx(4e-3 * 2 * polygon * 30, rel=1e-12)


@pytest.mark.parametrize(
    ("pressure", "inner", "outer"),
    [
        (1e-3, -0.785237, -0.246322),
        (4e-3, -2.660187, -0.786685),
        (8e-3, -4.418788, -1.231220),
    ],
)
def test_thick_cylinder_under_outside_pressure(pressure, inner, outer):
    """Plane strain, free hole, A = 15, B = 47, c10 = 5 kPa, kappa = 14.3 MPa.

    The radial equation gives the printed digits; 64 x 16 elements come within 0.2 % of them,
    where plain trilinear elements stop at two thirds of the displacement.
    """
    exact = pressed_exactly(pressure, 5e-3)
    assert exact.inner == pytest.approx(inner, abs=1e-6)
    assert exact.outer == pytest.approx(outer, abs=1e-6)
    found = pressed(pressure, 5e-3)
    assert found.inner == pytest.approx(inner, rel=2e-3)
    assert found.outer == pytest.approx(outer, rel=2e-3)


def test_thick_cylinder_converges_at_second_order():
    """Halving the elements divides the error of the outer displacement by four (3.5..4.5)."""
    exact = pressed_exactly(4e-3, 5e-3).outer
    errors = [pressed(4e-3, 5e-3, n_theta=n, n_depth=n // 4).outer - exact for n in (16, 32, 64)]
    ratios = np.divide(errors[:-1], errors[1:])
    assert np.all((ratios > 3.5) & (ratios < 4.5))


@pytest.mark.parametrize(
    ("c10", "outer"), [(2e-3, -0.0059035), (5e-3, -0.0059025), (8e-3, -0.0059014)]
)
def test_stiffness_drops_out_when_the_hole_is_pinned(c10, outer):
    """An axisymmetric response to pressure is all volume change: the same u for any c10."""
    assert pressed_exactly(4e-3, c10, pinned=True).outer == pytest.approx(outer, abs=5e-8)
    assert pressed(4e-3, c10, pinned=True).outer == pytest.approx(outer, abs=5e-8)


def test_newton_ends_quadratically():
    """Corrections fall as their square: e_next / e^2 stays bounded; at most 6 in one step."""
    corrections = np.array(pressed(8e-3, 5e-3).corrections)
    assert len(corrections) <= 7
    last = corrections[corrections > 1e-7]
    assert np.all(last[2:] / last[1:-1] ** 2 < 1.0)


@pytest.mark.parametrize(
    ("K1", "layers", "radius", "stretch", "mmhg"),
    [
        (0.326667, 2, 46.22894, 1.278673, 29.5401),
        (0.196667, 1, 46.70512, 1.291844, 9.2175),
        (0.456667, 2, 46.03765, 1.273382, 40.6802),
    ],
)
def test_hoop_band_on_soft_annulus(K1, layers, radius, stretch, mmhg):
    """Band of rest radius 47 / 1.3 bonded to the annulus: p = n T / b in both.

    The exact answer is of incompressible tissue, so kappa is raised a hundredfold; radius
    within 5e-4 mm, pressure within 0.002 %.
    """
    exact = hooped_exactly(K1, layers, 47 / 1.3, 5e-3)
    assert exact.radius == pytest.approx(radius, abs=1e-5)
    assert exact.stretch == pytest.approx(stretch, abs=1e-6)
    assert exact.pressure / MMHG == pytest.approx(mmhg, abs=2e-4)
    found = hooped(K1, layers, 47 / 1.3, 5e-3, kappa=1430.0)
    assert found.radius == pytest.approx(radius, abs=5e-4)
    assert found.pressure / MMHG == pytest.approx(mmhg, rel=2e-5)


def test_mesh_volume_and_named_boundaries():
    """The tube's volume to second order, and each named boundary with its facets."""
    leg = leg_mesh(
        cylindrical_surface(47.0), cylindrical_surface(15.0), np.linspace(0, 30, 5), 48, 3, 2.0
    )
    volume = Tissue(leg.mesh, 5e-3, 14.3).volumes.sum()
    polygon = 48 * np.sin(2 * np.pi / 48) / 2 * (47**2 - 15**2) * 30
    assert volume == pytest.approx(polygon, rel=1e-12)
    sizes = {name: len(facets) for name, facets in leg.mesh.boundaries.items()}
    assert sizes == {"bone": 192, "skin": 192, "bottom": 144, "top": 144}
    layers = np.diff(leg.depth)
    assert layers[0] / layers[-1] == pytest.approx(2.0)


def test_end_conditions_hold_the_named_dofs():
    """free: the bone only; no_axial: z at both cuts as well; pinned: all there."""
    leg = uneven_leg(8, 2, 3)
    bone, cut = 3 * 8 * 4, 8 * 2 * 2
    assert len(leg.fixed_dofs("free")) == bone
    assert len(leg.fixed_dofs("no_axial")) == bone + cut
    assert len(leg.fixed_dofs("pinned")) == bone + 3 * cut
    with pytest.raises(SolverError, match="did you mean 'pinned'"):
        leg.fixed_dofs("pined")


def test_bone_outside_the_skin_is_refused():
    """The sentence says where the bone comes through."""
    with pytest.raises(SolverError, match="bone reaches the skin"):
        leg_mesh(
            cylindrical_surface(40.0),
            cylindrical_surface(lambda t, z: 30 + 12 * np.cos(t)),
            np.linspace(0, 30, 4),
            12,
            2,
        )


def test_an_inverted_element_is_reported():
    """A step that turns an element inside out raises, so that the driver can cut back."""
    leg = uneven_leg()
    tissue = Tissue(leg.mesh, 5e-3, 14.3)
    u = np.zeros((leg.mesh.nvertices, 3))
    u[leg.skin[0, 1], 0] = -60.0
    with pytest.raises(SolverError, match="inside out"):
        tissue.linearise(u.ravel())


def test_compressed_leg_keeps_its_volume():
    """kappa / c10 = 2 860: 4 kPa on the skin of a pinned leg changes the volume by p / kappa."""
    leg = annulus(16, 4)
    basis = held(leg.n_dofs, leg.fixed_dofs("no_axial"))
    tissue = Tissue(leg.mesh, 5e-3, 14.3)
    u, _ = newton([tissue, skin_pressure(leg, 4e-3)], basis)
    F = tissue._deformation(u)
    change = np.sum(tissue.weights * np.linalg.det(F)) / tissue.volumes.sum() - 1
    assert change == pytest.approx(-4e-3 / 14.3, rel=2e-3)
