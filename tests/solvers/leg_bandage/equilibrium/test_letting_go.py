"""Points that slide past the turn that carried them, on a rigid cylinder and on a leg."""

from dataclasses import replace

import numpy as np
import pytest

from surrogate_solvers.leg_bandage.contact.law import ContactLaw
from surrogate_solvers.leg_bandage.equilibrium.letting_go import Sheet, let_go, outside
from surrogate_solvers.leg_bandage.plugin import LegBandage
from surrogate_solvers.leg_bandage.surfaces.rigid import Mandrel
from surrogate_solvers.leg_bandage.verification.bands import limp
from surrogate_solvers.leg_bandage.verification.mandrel import Band, ring_wrap, wrap_mandrel


def test_what_comes_past_the_edge_comes_onto_the_skin():
    """A ring over a ring of the same width and eight elements across, moved up by three of them.

    The midpoints of its upper two elements are then more than one past the edge; the upper edge
    lay on the skin from the start. No area is lost, and what comes onto the skin has no
    pressure before it moves.
    """
    wrap = replace(ring_wrap(20.0), thickness=0.5)
    two = wrap_mandrel(
        Mandrel(45, 45),
        wrap,
        limp(0.098),
        ContactLaw(0.2),
        40,
        8,
        between=ContactLaw(0.6),
        over=[Band(wrap, limp(0.098), 40, 8)],
    )
    wraps = (wrap, wrap)
    sheets = [
        Sheet(strip, laid, one, facing, laid.skin.reshape(-1, 2))
        for strip, laid, one, facing in zip(two.strips, two.lays, wraps, two.facings, strict=True)
    ]
    u = np.zeros(two.X.size)
    upper = two.facings[1]
    (on_ring,) = upper.over
    for contact in two.problem.contacts:
        contact.slide(u)
    assert not let_go(sheets, two.X)
    before = upper.skin.points.area.sum() + on_ring.points.area.sum()
    state, count = two.problem.state(), len(upper.skin.points.area)

    u.reshape(-1, 3)[two.strips[1].offset :, 2] = 7.5
    for contact in two.problem.contacts:
        contact.follow(u)
    x = two.X + u.reshape(-1, 3)
    assert let_go(sheets, x) and not let_go(sheets, x)
    assert upper.skin.points.area.sum() + on_ring.points.area.sum() == pytest.approx(before)
    assert not outside(on_ring.current.xi, two.strips[0]).any()
    new = slice(count, None)
    assert set(upper.skin.points.laid[new] % 10) == {7, 8}
    report = upper.skin.report(u)
    assert (report["p"][new] == 0).all() and report["slip_size"][new].max() < 1e-9
    two.problem.restore(state)
    assert len(upper.skin.points.area) == count


def test_nothing_is_handed_over_where_nothing_slides_far(rough_result):
    """The points of the mean leg at rest are those as laid: its digits are those of the lay."""
    facing = rough_result.model.bandages[0].facing
    assert facing.skin.points is facing.laid


@pytest.mark.slow
def test_a_turn_that_slides_off_the_first_end_comes_to_rest():
    """Overlap 0.55, stretch 1.39: the second turn slides off the end of the first.

    Carried on by the surface continued beyond that end, its points were pressed with up to 1 300
    mmHg and the bandage never came to rest.
    """
    found = LegBandage(mesh="coarse").run(
        overlap=0.55125,
        stretch=1.39375,
        start_height=1.1875,
        leg_length=221.125,
        alpha1=-0.78170625,
        alpha2=0.08540625,
        alpha3=0.0594625,
        alpha4=0.03034375,
        tension=0.1189625,
        mu_skin=0.20125,
    )
    facing = found.model.bandages[0].facing
    assert facing.skin.points is not facing.laid
    assert not outside(facing.turns.current.xi, found.model.strip).any()
    assert found.values["residual"] <= found.model.problem.tolerances.rest
    assert found.values["slip_max"] < 20
    assert found.values["pressure_field"].max() < 150
