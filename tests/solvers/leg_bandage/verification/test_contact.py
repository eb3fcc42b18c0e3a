"""Bandages on mandrels, a soft tube and a flat block, against exact answers.

Stiffness is the contact's, so that penetration costs 0.2 % at most.
`benchmarks/verification_contact.py` prints the same figures.
"""

import numpy as np
import pytest

from surrogate_solvers.leg_bandage.outputs.pressure_map import MMHG
from surrogate_solvers.leg_bandage.verification.bands import (
    band_on_cylinder,
    band_on_padding,
    band_on_soft_tube,
    bands_on_soft_tube,
    capstan,
    curvature,
    slide_down_cone,
    spiral_exactly,
    spiral_on_cylinder,
    stretches_on_cone,
    string_on_ellipse,
    two_bandages_on_cylinder,
)
from surrogate_solvers.leg_bandage.verification.flat_patch import (
    MARGIN,
    SIDE,
    press,
    settlement_exactly,
)
from surrogate_solvers.leg_bandage.verification.grid_refinement import observed_order, refined
from surrogate_solvers.leg_bandage.verification.legs import (
    most_conical,
    named,
    slope,
    validation_leg,
)
from surrogate_solvers.leg_bandage.verification.sweeps import Case, solve_all
from surrogate_solvers.leg_bandage.verification.thick_cylinder import banded_exactly


@pytest.mark.parametrize("tension, mmhg", [(0.059, 9.835), (0.098, 16.335), (0.137, 22.835)])
def test_band_on_rigid_cylinder(tension, mmhg):
    """V2, Laplace's law p = T / r for one layer on r = 45 mm, uniform up to the edges."""
    found = band_on_cylinder(tension)
    assert found.mean == pytest.approx(mmhg, rel=4e-3)
    assert found.scatter < 0.01


def test_spiral_on_rigid_cylinder():
    """V2 and V4: two layers at pitch 50 on r = 45 press n T cos^2(beta) / r = 31.68 mmHg.

    Turns are pitch cos(beta) apart, so that the mean over a turn has n = 2.03 layers.
    """
    two_layers, exact = spiral_exactly()
    assert two_layers == pytest.approx(31.68, abs=0.01)
    assert spiral_on_cylinder(per_turn=28) == pytest.approx(exact, rel=4e-3)


@pytest.mark.parametrize("layers, mmhg", [(3, 48.67), (4, 65.08)])
def test_spiral_with_more_overlap(layers, mmhg):
    """V2 with overlap 2/3 and 3/4: each turn presses through all turns beneath it.

    Penetration takes 0.02 mm off the radius under three layers and 0.07 mm under four, and
    4.3 times that share off the tension: 0.4 and 0.7 % of the pressure.
    """
    _, exact = spiral_exactly(layers)
    assert exact == pytest.approx(mmhg, abs=0.01)
    assert spiral_on_cylinder(per_turn=28, layers=layers) == pytest.approx(exact, rel=9e-3)


@pytest.mark.slow
def test_two_bandages_on_rigid_cylinder():
    """V2: two bandages that cross press with the sum of n T cos^2(beta) / r, 77.1 mmHg.

    Penetration at this pressure takes 1.1 % off the tension.
    """
    found, exact = two_bandages_on_cylinder()
    assert exact == pytest.approx(77.14, abs=0.01)
    assert found == pytest.approx(exact, rel=1.5e-2)


@pytest.mark.parametrize("laid_under, mmhg", [(0.098 / 45, 16.371), (4e-3, 16.849), (5e-4, 15.102)])
def test_band_over_padding(laid_under, mmhg):
    """V16: a band, van Wyk's padding and Laplace's law balance in one equation.

    Laid over the thickness that Laplace's law leaves of the padding, over less and over more:
    the less the padding still gives way, the more stretch the band keeps.
    """
    found, exact = band_on_padding(laid_under)
    assert exact.pressure == pytest.approx(mmhg, abs=0.001)
    assert found.thickness == pytest.approx(exact.thickness, abs=0.015)
    assert found.stretch == pytest.approx(exact.stretch, rel=1e-3)
    assert found.pressure == pytest.approx(exact.pressure, rel=1e-3)


@pytest.mark.parametrize(
    "K1, radius, mmhg",
    [
        ((0.196667,) * 3, 46.2826, (26.788, 17.858, 8.929)),
        ((0.196667, 0.456667), 46.2289, (29.540, 20.648)),
    ],
)
def test_bands_over_each_other_on_a_soft_tube(K1, radius, mmhg):
    """V3 of three bands and of two of unlike stiffness: p_i = (T_i + T_(i+1) + ...) / b.

    Beneath the outer of two bands acts its own T / b only. Meshes of bands and skin do not match.
    """
    exact = banded_exactly([(one, 47 / 1.3) for one in K1], c10=0.005)
    assert [one.pressure / MMHG for one in exact] == pytest.approx(mmhg, abs=0.001)
    for found, band in zip(bands_on_soft_tube(*K1), exact, strict=True):
        assert found.radius == pytest.approx(radius, abs=0.01)
        assert found.stretch == pytest.approx(band.stretch, rel=2e-3)
        assert found.pressure == pytest.approx(band.pressure / MMHG, rel=5e-3)
        assert found.scatter < 0.08


@pytest.mark.parametrize("a, b, ends", [(50, 44, (37.97, 25.87)), (55, 40, (50.54, 19.44))])
def test_frictionless_string_on_an_ellipse(a, b, ends):
    """V5: without friction the tension is uniform and p = T curvature at every point."""
    found = string_on_ellipse(a, b)
    assert found.tension < 5e-3
    assert found.mean < 4e-3 and found.worst < 2e-2
    exact = 2 * 0.098 / MMHG * curvature(a, b, np.array([0, np.pi / 2]))
    assert exact == pytest.approx(ends, abs=0.01)


@pytest.mark.parametrize("mu, ratio", [(0.1, 1.3691), (0.2, 1.8745), (0.3, 2.5663)])
def test_capstan(mu, ratio):
    """V6, Euler 1769: T2 / T1 = exp(mu theta) once the whole strip slides."""
    assert capstan(mu) == pytest.approx(ratio, rel=1e-2)


@pytest.mark.parametrize("tension, radius", [(0.098, 45.0), (0.137, 35.0)])
@pytest.mark.parametrize("alpha", [0.08, 0.12])
def test_hoop_on_a_cone_slides_below_tan_alpha(alpha, tension, radius):
    """V7: a hoop on a cone slides exactly when mu < tan(alpha), whatever T and r.

    10 % below, it is still sliding after eight steps; 10 % above, it rests after less
    than the elastic slip and its own settling.
    """
    assert slide_down_cone(alpha, 1.1, tension, radius) < 0.08
    assert slide_down_cone(alpha, 0.9, tension, radius) > 0.6


def test_edge_stretches_on_a_cone():
    """V7: stretch across the width is lambda0 (1 + y sin(alpha) / r), as laid."""
    found, exact = stretches_on_cone()
    assert np.allclose(found, exact, rtol=1e-3)


@pytest.mark.parametrize("K1, radius, stretch, mmhg", [(0.196667, 46.70512, 1.291844, 9.2175)])
def test_hoop_band_in_contact_with_a_soft_tube(K1, radius, stretch, mmhg):
    """V3 through contact: a band on a soft annulus, T = K1 (b / r0 - 1), p = T / b.

    The same ring is the curved patch test V8: bandage and skin do not match (44 rows
    on 36 cells round the tube, 5 on 4 along it), and the exact pressure is uniform.
    """
    found = band_on_soft_tube(K1)
    assert found.radius == pytest.approx(radius, abs=0.02)
    assert found.stretch == pytest.approx(stretch, rel=1e-3)
    assert found.pressure == pytest.approx(mmhg, rel=0.01)
    assert found.scatter < 0.02


@pytest.mark.parametrize(
    "cells, elements, twist, settled",
    [
        ((8, 8, 3), (11, 9), 0.0, 0.03),
        ((8, 8, 3), (11, 9), 0.5, 0.03),
        ((6, 7, 3), (9, 10), 0.5, 0.03),
        ((16, 16, 4), (21, 19), 0.5, 0.01),
    ],
)
def test_flat_patch(cells, elements, twist, settled):
    """V8, flat: a uniform load on the strip reaches a soft block as a uniform pressure.

    Meshes do not match, and are turned against each other by up to `twist` rad (29 degrees).
    Pressure is uniform to 0.3 % rms and 2 % at every contact point, and the floor carries the
    whole load. The settlement is a convergence and no patch test: the skin's cubic passes
    1 / 24 of a cell's load over the strip's edge, so that the block sinks deeper than in exact
    uniaxial strain by 2 % on 8 cells and 0.6 % on 16.
    """
    load = 30 * MMHG
    patch = press(load, cells, elements, twist)
    off = patch.pressure / load - 1
    assert off.std() < 3e-3 and np.abs(off).max() < 2e-2
    sunk = patch.settlement / settlement_exactly(load) - 1
    assert abs(sunk.mean()) < settled and sunk.std() < 0.04
    area = np.prod([SIDE + 2 * MARGIN * SIDE / n for n in cells[:2]])
    assert patch.reaction == pytest.approx(load * area, rel=1e-3)


@pytest.mark.parametrize("order", [0.7, 1.3, 2.0])
def test_a_limit_is_found_where_the_meshes_tell_it(order):
    """f + C h^p gives back f and p, by Richardson on three meshes and least squares on four."""
    sizes = np.array([1, 1 / 1.5, 1 / 2, 1 / 2.5])
    values = 30 + 2 * sizes**order
    assert observed_order(sizes[:3], values[:3]) == pytest.approx(order, rel=1e-6)
    for n in (3, 4):
        found = refined(sizes[:n], values[:n])
        assert found.limit == pytest.approx(30, abs=1e-4)
        assert found.order == pytest.approx(order, abs=1e-3)
        assert found.uncertainty == pytest.approx(1.25 * (values[:n] - 30), rel=1e-3)


def test_no_limit_is_made_up_where_the_meshes_do_not_tell_it():
    """Three values that turn round have three times their range as uncertainty, and no limit."""
    found = refined([1, 1 / 1.5, 1 / 2], [31.0, 30.9, 31.1])
    assert np.isnan(found.limit) and np.isnan(found.order)
    assert found.uncertainty == pytest.approx(3 * 0.2 * np.ones(3))
    assert np.isnan(observed_order([3, 2, 1], [31.0, 30.9, 31.1]))


def test_uncertainty_of_four_meshes_holds_a_limit_behind_scatter():
    """Scatter of the size of the trend: of 200 draws at least 95 % hold the limit on each mesh."""
    rng = np.random.default_rng(0)
    sizes = np.array([1, 1 / 1.5, 1 / 2, 1 / 2.5])
    held = []
    for _ in range(200):
        values = 31 + 0.1 * sizes**2 + rng.normal(0, 0.05, 4)
        held.append(np.abs(values - 31) < refined(sizes, values).uncertainty)
    assert np.mean(held, axis=0).min() > 0.95


def test_most_conical_legs():
    """A leg is steep when its girth grows fast: the corners' steepest is that of `conical`."""
    corners, legs = most_conical(3)
    assert corners[0] == named("conical")
    slopes = [slope(validation_leg(i)) for i in legs]
    assert slopes == sorted(slopes, reverse=True) and slopes[0] > slope(validation_leg(0))


def test_a_sweep_keeps_its_rows_and_tells_what_failed(tmp_path):
    """Runs in the table are not repeated; a leg that cannot be is a row with its sentence."""
    table = tmp_path / "runs.csv"
    cases = [Case("too short", {"leg_length": 20.0}), Case("none", {"tensoin": 0.1})]
    first = list(solve_all(cases, "coarse", table=table))
    assert {row["case"]: row["message"][:10] for row in first} == {
        "too short": "leg_length",
        "none": "tensoin: n",
    }
    kept = table.read_text()
    again = list(solve_all(cases, "coarse", table=table))
    assert [row["message"] for row in again] == [row["message"] for row in first]
    assert table.read_text() == kept
