"""The bandage's shell against classical shell problems and its own energy."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.sparse import coo_array
from scipy.special import ellipeinc, ellipkinc

from surrogate_solvers.leg_bandage.bandage.fabric import Fabric
from surrogate_solvers.leg_bandage.bandage.products import NOMINAL, at_tension
from surrogate_solvers.leg_bandage.bandage.shell import Shell
from surrogate_solvers.leg_bandage.surfaces.strip import Strip
from surrogate_solvers.leg_bandage.verification.follower_pressure import bandage_pressure
from surrogate_solvers.leg_bandage.verification.newton import held, newton
from surrogate_solvers.leg_bandage.verification.plates import (
    cantilever,
    isotropic,
    laid,
    off_axis_modulus,
    pinched_cylinder,
)

STIFF = Fabric(K1=0.33, K2=0.1, nu12=0.3, G=0.05, F1=0.5, F2=0.3, tau12=0.2, F12=0.1)
CURVE = ((1.0, 0.0), (1.1, 0.05), (1.3, 0.098), (1.6, 0.13), (1.7, 0.2))


def waved(fabric=STIFF, **options):
    """A small strip in tension, doubly curved."""
    strip, size = Strip(5, 4), (20.0, 16.0)

    def surface(s, w):
        return np.stack([1.2 * s, 1.1 * w, 0.01 * s**2 + 0.02 * w**2 + 0.03 * s * w], axis=-1)

    return Shell(strip, size, fabric, laid(strip, size, surface), **options)


def matrix(shell, u):
    """The shell's tangent at u, (n_dofs, n_dofs)."""
    values = shell.linearise(u)[1]()
    return coo_array((values, (shell.rows, shell.cols)), shape=(shell.n_dofs,) * 2).tocsr()


def noise(shell, seed, size=0.2):
    """Random displacements and a random direction."""
    rng = np.random.default_rng(seed)
    return rng.normal(0, size, shell.n_dofs), rng.normal(size=shell.n_dofs)


@pytest.mark.parametrize("fabric", [STIFF, NOMINAL, replace(NOMINAL, curve=CURVE)])
def test_residual_is_the_derivative_of_the_energy(fabric):
    """Virtual work: residual . v = dU(u + t v)/dt, central differences, 1e-7."""
    shell = waved(fabric)
    u, v = noise(shell, 0)
    ahead, behind = (shell.energy(u + h * v) for h in (1e-5, -1e-5))
    assert shell.linearise(u)[0] @ v == pytest.approx((ahead - behind) / 2e-5, rel=1e-7)


@pytest.mark.parametrize("fabric", [STIFF, NOMINAL, replace(NOMINAL, curve=CURVE)])
@pytest.mark.parametrize("bent", [False, True])
def test_tangent_is_the_derivative_of_the_residual(fabric, bent):
    """Central differences of the residual, 1e-6 of its largest entry; symmetric."""
    shell = waved(fabric, slack=False)
    if bent:
        shell.natural = shell.natural + np.array([0, 0, 0.05, 0.02, -0.01, 0.03])[:, None, None]
    u, v = noise(shell, 1)
    K = matrix(shell, u)
    ahead, behind = (shell.linearise(u + h * v)[0] for h in (1e-5, -1e-5))
    found = (ahead - behind) / 2e-5
    np.testing.assert_allclose(K @ v, found, atol=1e-6 * np.abs(found).max())
    assert abs(K - K.T).max() < 1e-12 * abs(K).max()


def test_slack_tangent_is_consistent_in_tension():
    """Where warp and weft pull and shear is small, nothing is left out."""
    shell = waved()
    exact = waved(slack=False)
    u = np.zeros(shell.n_dofs)
    assert abs(matrix(shell, u) - matrix(exact, u)).max() < 1e-15


def test_slack_tangent_stays_positive_in_compression():
    """A strip shortened by 20 % buckles in its exact tangent and not in the slack one.

    Along the strip both are the same, so slackness adds no stiffness against shortening.
    """
    strip, size = Strip(12, 4), (40.0, 16.0)
    start = laid(strip, size) * [0.8, 0.95, 1]
    slack, exact = (Shell(strip, size, NOMINAL, start, slack=choice) for choice in (True, False))
    u = np.zeros(start.size)
    lowest = [np.linalg.eigvalsh(matrix(shell, u).toarray())[0] for shell in (slack, exact)]
    assert lowest[0] > -1e-12
    assert lowest[1] < -1e-3
    shortening = (start * [1, 0, 0]).ravel()
    np.testing.assert_allclose(
        matrix(slack, u) @ shortening, matrix(exact, u) @ shortening, atol=1e-13
    )
    np.testing.assert_array_equal(slack.linearise(u)[0], exact.linearise(u)[0])


def test_rigid_motion_costs_nothing():
    """Objectivity: a flat strip turned by 70 degrees and shifted has neither force nor strain."""
    strip, size = Strip(6, 3), (30.0, 12.0)
    start = laid(strip, size)
    shell = Shell(strip, size, STIFF, start)
    c, s = np.cos(1.2), np.sin(1.2)
    turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]) @ np.array(
        [[1, 0, 0], [0, c, s], [0, -s, c]]
    )
    u = (start @ turn.T + [5, -3, 2] - start).ravel()
    assert np.abs(shell.linearise(u)[0]).max() < 1e-12
    assert shell.energy(u) < 1e-24


@pytest.mark.parametrize("tension", [0.059, 0.098, 0.137])
@pytest.mark.parametrize("curve", [(), CURVE])
def test_uniaxial_tension_is_exactly_t_at_stretch_1_3(tension, curve):
    """Chassagne et al. 2018, equation 10: ends at 1.3 times the length pull with T width.

    The weft is free and contracts by nu12 T / K1 times, which Newton has to find.
    """
    fabric = at_tension(tension, replace(NOMINAL, curve=curve))
    strip, size = Strip(8, 4), (40.0, 16.0)
    start = laid(strip, size) * [1.3, 1, 1]
    shell = Shell(strip, size, fabric, start)
    n = np.arange(strip.size).reshape(10, 6)
    ends = n[[0, 1, -2, -1]].ravel()
    fixed = [*(3 * ends), *(3 * n.ravel() + 2), *(3 * n[:, 2] + 1)]
    u, _ = newton([shell], held(start.size, fixed), tolerance=1e-11)
    reaction = shell.linearise(u)[0].reshape(-1, 3)[n[-2:].ravel(), 0].sum()
    assert reaction == pytest.approx(tension * 16.0, rel=1e-9)
    fields = shell.at(u, np.array([[0.0, 0.0], [4.3, 2.2], [8.0, 4.0]]))
    np.testing.assert_allclose(fields.warp_stretch, 1.3, rtol=1e-9)
    if not curve:
        contraction = 1 - 0.2 * 0.3
        np.testing.assert_allclose(fields.weft_stretch, contraction, rtol=1e-9)


@pytest.mark.parametrize("degrees", [0, 20, 45, 70, 90])
def test_off_axis_modulus(degrees):
    """Orthotropic membrane: 1/E = c^4/K1 + s^4/K2 + c^2 s^2 (1/G - 2 nu12/K1)."""
    phi = np.radians(degrees)
    c, s = np.cos(phi), np.sin(phi)
    fabric = Fabric(K1=0.33, K2=0.1, nu12=0.3, G=0.05, F1=0.01, F2=0.01, tau12=0.01)
    expected = 1 / (c**4 / 0.33 + s**4 / 0.1 + c**2 * s**2 * (1 / 0.05 - 2 * 0.3 / 0.33))
    assert off_axis_modulus(fabric, phi) == pytest.approx(expected, rel=1e-6)


def elastica(load):
    """Tip (shortening, deflection) over length for P L^2 / (E I) = load (Bisshopp, Drucker 1945).

    With k^2 = (1 + sin phi0) / 2 and sin theta1 = 1 / (k sqrt 2):
    sqrt(load) = K - F(theta1), deflection = 1 - 2 (E - E(theta1)) / sqrt(load),
    1 - shortening = sqrt(2 sin phi0) / sqrt(load).
    """

    def root(slope):
        m = (1 + np.sin(slope)) / 2
        first = np.arcsin(1 / np.sqrt(2 * m))
        return ellipkinc(np.pi / 2, m) - ellipkinc(first, m), m, first

    slope = brentq(lambda phi: root(phi)[0] - np.sqrt(load), 1e-6, np.pi / 2 - 1e-9)
    _, m, first = root(slope)
    bent = ellipeinc(np.pi / 2, m) - ellipeinc(first, m)
    return 1 - np.sqrt(2 * np.sin(slope) / load), 1 - 2 * bent / np.sqrt(load)


def test_cantilever_follows_the_elastica():
    """L = 10, P L^2 / (E I) = 4: the closed form of Bisshopp and Drucker 1945 to 0.05 %.

    Sze, Liu and Lo 2004 print (-U, W) = (3.286, 6.698) for the same strip: met to 0.15 %.
    """
    shortening, deflection = elastica(4.0)
    u = cantilever(64)
    assert -u[0] / 10 == pytest.approx(shortening, rel=5e-4)
    assert u[2] / 10 == pytest.approx(deflection, rel=5e-4)
    assert -u[0] == pytest.approx(3.286, rel=1.5e-3)
    assert u[2] == pytest.approx(6.698, rel=1.5e-3)


def test_pinched_cylinder_approaches_the_series_solution():
    """Rigid diaphragms, R / t = 100: 164.24 P / (E t), from below; 1 % at 64 x 64 elements."""
    found = [pinched_cylinder(n) for n in (16, 32, 64)]
    errors = 1 - np.array(found) / 164.24
    assert np.all(np.diff(errors) < 0)
    assert 0 < errors[-1] < 0.01


@pytest.mark.slow
def test_pinched_cylinder_converges():
    """Within 0.5 % at 128 x 128 elements."""
    assert pinched_cylinder(128) == pytest.approx(164.24, rel=5e-3)


def test_inflated_strip_obeys_laplace():
    """Held at both ends and blown up, a strip of little bending is a circle with T = p r.

    T is the Cauchy tension: the nominal one over the width, which the weft's contraction
    does not change here, since the sides are held.
    """
    strip, size, pressure = Strip(40, 1), (100.0, 5.0), 1e-3
    start = laid(strip, size)
    fabric = replace(NOMINAL, F1=1e-6, F2=1e-6, tau12=1e-6)
    shell = Shell(strip, size, fabric, start + 1e-3 * np.sin(start[:, :1] / 30) * [0, 0, 1])
    n = np.arange(strip.size).reshape(42, 3)
    ends = (3 * n[[0, 1, -2, -1]].ravel()[:, None] + np.arange(3)).ravel()
    fixed = [*ends, *(3 * n.ravel() + 1)]
    load, u = bandage_pressure(shell, 0.0), None
    for part in np.linspace(0.1, 1, 10):
        load.pressure = part * pressure
        u, _ = newton([shell, load], held(start.size, fixed), start=u)
    l1, l2, _, k11, _, _ = shell.strains(u)[:, :, 12:-12]
    Q11, Q12, _ = fabric.membrane
    assert l1.min() > 1.05
    np.testing.assert_allclose(Q11 * (l1 - 1) * k11 / l1**2, pressure, rtol=1e-5)
    np.testing.assert_allclose(l2, 1, rtol=1e-12)


def test_tube_under_tension_has_the_curvatures_of_its_circle():
    """On a circle of radius r at stretch l: k11 = l^2 / r, no twist; second order in size.

    At every quadrature point but those of the six elements at either end.
    """
    errors = []
    for n in (24, 48):
        strip, size = Strip(n, 2), (100.0, 10.0)
        r = 1.3 * 100.0 / (2 * np.pi)

        def circle(s, w, r=r):
            angle = 1.3 * s / r
            return np.stack([r * np.cos(angle), r * np.sin(angle), w], axis=-1)

        shell = Shell(strip, size, NOMINAL, laid(strip, size, circle))
        strains = shell.strains(np.zeros(shell.n_dofs))[:, :, 12:-12]
        errors.append(np.abs(strains[3] * r / 1.3**2 + 1).max())
        assert np.abs(strains[5]).max() < 1e-12
    assert errors[1] < 0.3 * errors[0]
    assert errors[1] < 1e-5


def test_fields_at_given_points():
    """Place, tangents, normal and stretches on a sheared plane, from their definition."""
    strip, size = Strip(7, 3), (21.0, 9.0)
    A = np.array([[1.3, 0.1, 0], [0.05, 0.9, 0], [0, 0, 1]])
    start = laid(strip, size)
    shell = Shell(strip, size, NOMINAL, start)
    u = (start @ A.T + [1, 2, 3] - start).ravel()
    found = shell.at(u, np.array([[0.0, 0.0], [3.25, 1.5], [7.0, 3.0]]))
    rest = np.array([[0.0, 0, 0], [9.75, 4.5, 0], [21.0, 9.0, 0]])
    np.testing.assert_allclose(found.point, rest @ A.T + [1, 2, 3], atol=1e-12)
    np.testing.assert_allclose(found.along, np.tile(A[:, 0], (3, 1)), atol=1e-12)
    np.testing.assert_allclose(found.across, np.tile(A[:, 1], (3, 1)), atol=1e-12)
    np.testing.assert_allclose(found.normal, np.tile([0, 0, 1], (3, 1)), atol=1e-12)
    lengths = np.linalg.norm(A[:, 0]), np.linalg.norm(A[:, 1])
    np.testing.assert_allclose(found.warp_stretch, lengths[0], rtol=1e-12)
    np.testing.assert_allclose(found.weft_stretch, lengths[1], rtol=1e-12)
    np.testing.assert_allclose(found.shear, A[:, 0] @ A[:, 1] / np.prod(lengths), rtol=1e-12)


def test_chunks_do_not_change_the_answer(monkeypatch):
    """A long strip assembled in pieces of seven elements gives the same sums."""
    shell = waved()
    u, _ = noise(shell, 3)
    residual, tangent = shell.linearise(u)
    monkeypatch.setattr("surrogate_solvers.leg_bandage.bandage.shell.CHUNK", 7)
    pieces, pieced = shell.linearise(u)
    np.testing.assert_allclose(pieces, residual, atol=1e-14)
    np.testing.assert_allclose(pieced(), tangent(), atol=1e-14)


def test_isotropic_bending_is_the_plate_equation():
    """Uniform curvatures k1, k2, k12: D/2 (k1^2 + k2^2 + 2 nu k1 k2 + 2 (1 - nu) k12^2)."""
    D = 3e6 * 0.1**3 / 12 / (1 - 0.3**2)
    k1, k2, k12 = 0.7, -0.4, 0.3
    curvature = np.array([k1, k2, 2 * k12])
    expected = D / 2 * (k1**2 + k2**2 + 2 * 0.3 * k1 * k2 + 2 * 0.7 * k12**2)
    found = curvature @ isotropic(3e6, 0.3, 0.1).bending @ curvature / 2
    assert found == pytest.approx(expected, rel=1e-12)
