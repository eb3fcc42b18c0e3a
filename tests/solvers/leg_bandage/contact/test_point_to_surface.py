"""Contact: closest points, the consistent tangent, and equilibrium of what it transmits."""

from dataclasses import replace

import numpy as np
import pytest

from surrogate_solvers.leg_bandage.contact.law import ContactLaw
from surrogate_solvers.leg_bandage.contact.point_to_surface import Contact, Points
from surrogate_solvers.leg_bandage.contact.sparsity import PatternOutgrown
from surrogate_solvers.leg_bandage.surfaces.projection import project
from surrogate_solvers.leg_bandage.surfaces.rigid import Mandrel, Plane
from surrogate_solvers.leg_bandage.surfaces.skin import Skin
from surrogate_solvers.leg_bandage.surfaces.strip import Strip, interpolate_strip

LAW = ContactLaw(mu=0.3, penalty=0.2, ramp=0.02, elastic_slip=0.05)


def bumpy_tube(rng, n_theta=16, n_z=10, radius=40.0):
    """Node grid (n_theta, n_z) and positions of a tube that is not quite round."""
    theta = np.arange(n_theta) * 2 * np.pi / n_theta
    z = np.linspace(0, 90, n_z)
    r = radius + rng.normal(0, 0.4, (n_theta, n_z))
    x = np.stack(
        [r * np.cos(theta)[:, None], r * np.sin(theta)[:, None], np.broadcast_to(z, r.shape)], -1
    )
    return np.arange(n_theta * n_z).reshape(n_theta, n_z), x.reshape(-1, 3)


def patch_on_tube(seed, tied=False):
    """A bent B-spline patch at gaps from +0.08 to -0.1 mm on a bumpy tube."""
    rng = np.random.default_rng(seed)
    nodes, x_skin = bumpy_tube(rng)
    strip = Strip(4, 3, offset=len(x_skin))
    s, w = np.meshgrid(np.arange(6) * 5.0, np.arange(5) * 5.0 + 30, indexing="ij")
    angle = s / 40 + 6.1
    values = np.stack([40.2 * np.cos(angle), 40.2 * np.sin(angle), w], -1)
    X = np.vstack([x_skin, interpolate_strip(values).reshape(-1, 3)])
    mid = np.stack(np.meshgrid(np.arange(4) + 0.5, np.arange(3) + 0.5, indexing="ij"), -1)
    own, weights = strip.stencil(mid.reshape(-1, 2))
    n = len(own)
    points = Points(own, weights[0], rng.uniform(10, 20, n), np.full(n, tied))
    skin = Skin(nodes)
    where = points.at(X)
    seed_xi = np.column_stack(
        [np.arctan2(where[:, 1], where[:, 0]) * 16 / (2 * np.pi), where[:, 2] / 10]
    )
    xi = project(skin, where, X, seed_xi)
    jet = skin.at(xi, X)
    normal = np.cross(jet[:, 1], jet[:, 2])
    distance = np.sum((where - jet[:, 0]) * normal, axis=1) / np.linalg.norm(normal, axis=1)
    return Contact(points, skin, X, xi, distance + np.linspace(-0.08, 0.1, n), LAW), rng


@pytest.mark.parametrize("bonded", [True, False])
def test_tangent_is_the_derivative_of_the_residual(bonded):
    """V11: central differences of the residual agree with the tangent to 1e-6.

    Positions, slips (beyond and below the elastic slip) and gaps (open, ramp, closed) vary.
    """
    contact, rng = patch_on_tube(3)
    contact.current = replace(contact.current, bonded=bonded)
    ndof = 3 * len(contact.X)
    u = rng.normal(0, 0.04, ndof)
    contact.linearise(u)[1]()
    contact.advance(np.zeros(ndof))  # directions as at the solution, where both agree
    _, tangent = contact.linearise(u)
    K = np.zeros((ndof, ndof))
    np.add.at(K, (contact.rows, contact.cols), tangent())
    direction = rng.normal(size=ndof)
    step = 1e-6
    plus, _ = contact.linearise(u + step * direction)
    minus, _ = contact.linearise(u - step * direction)
    numeric = (plus - minus) / (2 * step)
    report = contact.report(u)
    assert (report["p"] > 0).any()
    if not bonded:
        assert (report["p"] == 0).any() and (report["slip_size"] > 0.05).any()
    assert np.abs(K @ direction - numeric).max() < 1e-6 * np.abs(numeric).max()


def test_forces_and_moments_balance():
    """Newton's third law: what the bandage feels, the skin feels; moments agree up to the gap.

    Force balance is exact. The moment arm between both sides is the gap d, along the
    normal, so only friction leaves a moment, t x d, which is included here.
    """
    contact, rng = patch_on_tube(5)
    contact.current = replace(contact.current, bonded=False)
    u = rng.normal(0, 0.03, 3 * len(contact.X))
    residual, _ = contact.linearise(u)
    force = residual.reshape(-1, 3)
    assert np.abs(force.sum(axis=0)).max() < 1e-12 * np.abs(force).sum()
    x = contact.X + u.reshape(-1, 3)
    report = contact.report(u)
    d = contact.points.at(x) - contact.surface.at(report["xi"], x)[:, 0]
    couple = -np.cross(d, report["traction"] * contact.points.area[:, None]).sum(axis=0)
    moment = np.cross(x, force).sum(axis=0)
    assert np.allclose(moment, couple, atol=1e-10 * np.abs(force).sum() * 40)


def test_dissipation_is_never_negative_and_anchor_follows():
    """V11: friction takes energy out; after accepting, the elastic slip is at most e."""
    contact, rng = patch_on_tube(7)
    contact.current = replace(contact.current, bonded=False)
    u = np.zeros(3 * len(contact.X))
    for _ in range(5):
        u = u + rng.normal(0, 0.05, u.size)
        assert contact.accept(u) >= 0.0
        assert contact.report(u)["slip_size"].max() <= LAW.elastic_slip * (1 + 1e-9)


def test_pattern_holds_wandering_projections_after_rebuild():
    """A patch moved by one and a half cells leaves the pattern, is found after `rebuild`."""
    contact, _ = patch_on_tube(9)
    u = np.zeros((len(contact.X), 3))
    u[contact.surface.nodes.size :, 2] = 15.0
    with pytest.raises(PatternOutgrown):
        contact.linearise(u.ravel())[1]()
    contact.follow(u.ravel())
    residual, tangent = contact.linearise(u.ravel())
    assert np.isfinite(residual).all() and len(tangent()) == len(contact.rows)


@pytest.mark.parametrize("surface", [Mandrel(50, 44), Mandrel(40, 40, 0.2)])
def test_projection_on_mandrels(surface):
    """A point put on the normal at a known parameter comes back to it (definition)."""
    rng = np.random.default_rng(0)
    xi = np.column_stack([rng.uniform(0, 6, 50), rng.uniform(0, 60, 50)])
    jet = surface.at(xi)
    normal = np.cross(jet[:, 1], jet[:, 2])
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    assert (np.einsum("pc,pc->p", normal[:, :2], jet[:, 0, :2]) > 0).all()
    found = project(surface, jet[:, 0] + 1.5 * normal, None, xi + 0.1)
    assert np.allclose(found, xi, atol=1e-9)


@pytest.mark.parametrize("surface", [Mandrel(50, 44, 0.1), "skin", "strip"])
def test_jets_are_derivatives(surface):
    """First and second derivatives of each surface against central differences."""
    rng = np.random.default_rng(1)
    x = None
    if surface == "skin":
        nodes, x = bumpy_tube(rng)
        surface = Skin(nodes)
    elif surface == "strip":
        surface, x = Strip(6, 5), rng.normal(size=(56, 3))
    xi = rng.uniform(1.05, 1.9, (20, 2)) + rng.integers(0, 3, (20, 2))
    step = 1e-5
    jet = surface.at(xi, x)
    for axis, (one, two) in enumerate(((3, 5), (5, 4))):
        h = np.eye(2)[axis] * step
        plus, minus = surface.at(xi + h, x), surface.at(xi - h, x)
        slope = (plus - minus) / (2 * step)
        assert np.allclose(slope[:, 0], jet[:, 1 + axis], atol=1e-6)
        assert np.allclose(slope[:, 1], jet[:, one], atol=1e-5)
        assert np.allclose(slope[:, 2], jet[:, two], atol=1e-5)


def test_skin_interpolates_its_nodes_and_is_smooth():
    """Keys (1981): the cubic convolution passes through its nodes and is C1 across cells."""
    rng = np.random.default_rng(2)
    nodes, x = bumpy_tube(rng)
    skin = Skin(nodes)
    at_nodes = skin.at(np.array([[3.0, 4.0], [15.0, 6.0], [16.0, 6.0]]), x)[:, 0]
    assert np.allclose(at_nodes, x[[nodes[3, 4], nodes[15, 6], nodes[0, 6]]])
    ends = skin.at(np.array([[3.0, 0.0], [5.0, 9.0]]), x)[:, 0]
    assert np.allclose(ends, x[[nodes[3, 0], nodes[5, 9]]])
    seam = np.array([[4.0, 3.3], [16.0, 5.7], [2.4, 5.0], [2.4, 1.0], [7.2, 8.0]])
    below, above = skin.at(seam - 1e-9, x), skin.at(seam + 1e-9, x)
    assert np.allclose(below[:, :3], above[:, :3], atol=1e-6)


def test_strip_takes_given_midpoint_values():
    """`interpolate_strip` solves the collocation at element midpoints exactly."""
    rng = np.random.default_rng(4)
    strip = Strip(5, 4)
    values = rng.normal(size=(7, 6, 3))
    x = interpolate_strip(values).reshape(-1, 3)
    mid = np.stack(np.meshgrid(np.arange(5) + 0.5, np.arange(4) + 0.5, indexing="ij"), -1)
    found = strip.at(mid.reshape(-1, 2), x)[:, 0].reshape(5, 4, 3)
    assert np.allclose(found, values[1:-1, 1:-1], atol=1e-12)


def block(angle_deg, pull):
    """Forces on a block of one point on a plane turned by an angle: normal, tangential."""
    c, s = np.cos(np.radians(angle_deg)), np.sin(np.radians(angle_deg))
    turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1.0]])
    turn = turn @ np.array([[1, 0, 0], [0, c, -s], [0, s, c]])
    plane = Plane((0, 0, 0), tuple(turn[:, 0]), tuple(turn[:, 1]))
    points = Points(np.array([[0]]), np.ones((1, 1)), np.ones(1), np.array([False]))
    contact = Contact(points, plane, np.zeros((1, 3)), np.zeros((1, 2)), [0.0], LAW)
    contact.current = replace(contact.current, bonded=False)
    u = turn @ np.array([*pull, -0.4])
    residual, _ = contact.linearise(u)
    return turn.T @ residual


@pytest.mark.parametrize("angle", [0.0, 30.0])
def test_sliding_block(angle):
    """V9: friction is min(k u, mu N), opposes the pull, and turns with the frame.

    N = penalty * 0.4 mm; below the elastic slip the secant stiffness is mu N (2 - y) / e.
    """
    N = LAW.penalty * 0.4
    for size in (0.01, 0.03, 0.2, 3.0):
        for heading in (0.0, 1.0):
            pull = size * np.array([np.cos(heading), np.sin(heading)])
            y = size / LAW.elastic_slip
            H = min(LAW.mu * N * y * (2 - y), LAW.mu * N) if y < 1 else LAW.mu * N
            force = block(angle, pull)
            assert force[2] == pytest.approx(-N, rel=1e-12)
            assert np.allclose(force[:2], H * pull / size, rtol=1e-10)


def test_release_keeps_the_traction_that_friction_can_give():
    """From bonded to Coulomb: tractions below mu p stay, the others become mu p."""
    contact, rng = patch_on_tube(11)
    contact.current = replace(contact.current, bonded=True)
    u = rng.normal(0, 0.02, 3 * len(contact.X))
    before = contact.report(u)
    contact.slide(u)
    after = contact.report(u)
    tangent = [r["traction"] - r["p"][:, None] * r["normal"] for r in (before, after)]
    asked, got = (np.linalg.norm(t, axis=1) for t in tangent)
    limit = LAW.mu * after["p"]
    closed = before["gap"] < -LAW.ramp
    assert closed.any()
    assert np.allclose(got[closed], np.minimum(asked, limit)[closed], rtol=1e-9)


@pytest.mark.parametrize("surface", ["skin", "strip"])
def test_a_part_of_the_bandage_that_faces_nothing_is_a_part(surface):
    """No points: no force, an empty tangent, no dissipation, through every step of a run."""
    full, _ = patch_on_tube(13)
    points = Points(*(part[:0] for part in (full.points.nodes, full.points.weights)),
                    full.points.area[:0], full.points.tied[:0])  # fmt: skip
    faced = full.surface if surface == "skin" else Strip(4, 3, offset=160)
    contact, u = Contact(points, faced, full.X, np.zeros((0, 2)), [], LAW), np.zeros(full.X.size)
    contact.close(u)
    contact.bond()
    for _ in range(2):
        residual, tangent = contact.linearise(u)
        assert not residual.any() and tangent().size == contact.rows.size == contact.cols.size == 0
        contact.advance(u)
        contact.slide(u)
    contact.follow(u)
    contact.take_over(contact, 0)
    assert contact.accept(u) == 0.0
    assert contact.report(u)["p"].size == 0
