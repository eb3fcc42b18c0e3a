"""The bone envelope inside every leg, and which legs are possible at all."""

import itertools

import numpy as np
import pytest

from surrogate.errors import SolverError
from surrogate_solvers.leg_bandage.geometry.basis import shipped_basis
from surrogate_solvers.leg_bandage.geometry.bone import LEAST_COVER, bone_envelope, cover, envelope
from surrogate_solvers.leg_bandage.geometry.cohort import load_cohort
from surrogate_solvers.leg_bandage.geometry.feasibility import check_leg
from surrogate_solvers.leg_bandage.geometry.leg import Leg

THETA = np.radians(np.arange(0, 360, 5))[:, None]


@pytest.fixture(scope="module")
def mean_leg():
    return Leg.from_alphas(237.9, shipped_basis().mean)


def every_leg():
    for cohort in (load_cohort("train"), load_cohort("val")):
        alphas = shipped_basis().project(cohort.snapshots().T)
        for length, coefficients, centre, shape in zip(
            cohort.length, cohort.coefficients, cohort.centre, alphas, strict=True
        ):
            yield Leg.from_sections(length, coefficients, centre)
            yield Leg.from_alphas(length, shape)


def test_cover_over_the_shin_of_the_mean_leg(mean_leg):
    """The tibia was placed 6 mm deep; five harmonics round its crest off by up to 0.9 mm.

    So the envelope lies 5 to 8.5 mm deep, 6.7 mm on the average of the heights.
    """
    nearest = cover(mean_leg, THETA, np.linspace(0, mean_leg.length, 21)).min(axis=0)
    assert 5.0 < nearest.min() and nearest.max() < 8.5
    assert nearest.mean() == pytest.approx(6.7, abs=0.2)


def test_size_of_the_bones(mean_leg):
    """Hull of tibia and fibula at mid-leg: 14 to 15 mm of mean radius, 10 % of the section."""
    bone, middle = bone_envelope(mean_leg), mean_leg.length / 2
    assert bone.radius(THETA, middle).mean() == pytest.approx(14.5, abs=0.5)
    share = np.mean(bone.radius(THETA, middle) ** 2) / np.mean(mean_leg.radius(THETA, middle) ** 2)
    assert share == pytest.approx(0.10, abs=0.02)


def test_fibula_is_lateral_and_behind_the_shin(mean_leg):
    """Right leg: the envelope is long from antero-medial (tibia) to postero-lateral (fibula)."""
    points = bone_envelope(mean_leg).surface(THETA, 120.0)[..., :2].reshape(-1, 2)
    values, axes = np.linalg.eigh(np.cov(points.T))
    long_axis = axes[:, 1] * np.sign(axes[0, 1])
    assert values[1] > 2 * values[0]
    assert long_axis[0] > 0 > long_axis[1]


def test_every_shipped_leg_holds_its_bones_whole():
    """73 legs, as sections and as four coordinates, 60 mm beyond both cuts: at least 2 mm."""
    for leg in every_leg():
        leg = leg.extended(60, 60)
        check_leg(leg)
        assert envelope(leg.coefficients)[2].min() == 1.0
        assert cover(leg, THETA, np.linspace(*leg.span, 61)).min() > LEAST_COVER


TABLE_II = [(184.86, 290.43), (-0.920, -0.503), (-0.109, 0.119), (-0.092, 0.068)]


def shipped_box():
    length = load_cohort().length
    return [(length.min(), length.max()), *shipped_basis().ranges]


@pytest.mark.parametrize(
    "box",
    [shipped_box(), [*TABLE_II, tuple(shipped_basis().ranges[3])]],
    ids=["shipped", "table II with the shipped alpha4"],
)
def test_every_corner_of_a_study_is_a_leg(box):
    """All 32 corners of length and alphas; the bones shrink by less than 15 %, 40 mm beyond."""
    for corner in itertools.product(*box):
        leg = Leg.from_alphas(corner[0], corner[1:]).extended(40, 40)
        check_leg(leg)
        assert cover(leg, THETA, np.linspace(*leg.span, 61)).min() > LEAST_COVER - 0.4


def test_corners_of_table_ii_on_the_shipped_basis():
    """Chassagne et al. 2018, Table II, was printed for another basis: 12 of 32 are no legs."""
    refused = 0
    for corner in itertools.product(*TABLE_II, (-0.081, 0.095)):
        try:
            check_leg(Leg.from_alphas(corner[0], corner[1:]))
        except SolverError:
            refused += 1
    assert refused == 12


def test_bones_scale_with_the_leg():
    small, large = (Leg.from_alphas(length, shipped_basis().mean) for length in (200, 300))
    np.testing.assert_allclose(
        bone_envelope(large).surface(THETA, 150.0)[..., :2],
        1.5 * bone_envelope(small).surface(THETA, 100.0)[..., :2],
        rtol=1e-9,
    )


def test_bones_shrink_where_the_skin_is_hollow():
    """At this corner the shin would have 0.9 mm of tissue: the bone gives way to 2 mm.

    0.3 mm is left open for the spline through the sections.
    """
    leg = Leg.from_alphas(237.9, (-0.516, -0.069, -0.085, 0.034))
    assert 0.85 < envelope(leg.coefficients)[2].min() < 1.0
    assert cover(leg, THETA, leg.z).min() == pytest.approx(LEAST_COVER, abs=0.3)


@pytest.mark.parametrize(
    "alphas, sentence",
    [
        ((-0.503, 0.119, 0.068, 0.095), r"meets the bones at height \d+ mm.*fit only at \d+%"),
        ((-0.503, 0.119, 0.068, -0.081), r"out of line at height 1\d\d mm, 3\d\d degrees"),
        ((-0.5, 0.5, 0.0, 0.0), r"skin is -?\d+\.\d mm from the centre line .* at height \d+ mm"),
    ],
)
def test_impossible_legs_are_refused_with_the_place(alphas, sentence):
    with pytest.raises(SolverError, match=sentence) as refusal:
        check_leg(Leg.from_alphas(237.9, alphas))
    assert "stay nearer to the shipped legs" in str(refusal.value)
