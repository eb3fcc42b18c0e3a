"""Side and front: by the foot, by landmarks, by the shape; and what is said where none tells.

No scan of a person is here. Legs of another family are surrogates: the shipped whole leg (foot,
knee, thigh) with its shank turned against its foot, its sections made narrower across, or scaled.
"""

from dataclasses import replace

import numpy as np
import pytest
import virtual_scans as virtual

from surrogate_solvers.leg_bandage.geometry.cohort import load_cohort
from surrogate_solvers.leg_bandage.geometry.leg import Leg
from surrogate_solvers.leg_bandage.prediction import (
    Reduced,
    choose_bandage,
    predict_pressure,
)
from surrogate_solvers.leg_bandage.prediction.shape import Shape, pressures
from surrogate_solvers.leg_bandage.scan import ScanError, fit_scan
from surrogate_solvers.leg_bandage.scan.familiarity import (
    WORST_RMS,
    shipped_girths,
    unlike,
    widening,
)
from surrogate_solvers.leg_bandage.scan.foot import FRONT, find_foot
from surrogate_solvers.leg_bandage.scan.front import OFF, Front
from surrogate_solvers.leg_bandage.scan.marks import Landmarks
from surrogate_solvers.leg_bandage.scan.pose import Body


def turned(vertices, degrees):
    """About z, counter-clockwise."""
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return vertices @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])


def twisted(vertices, degrees):
    """The whole leg with all above the ankle turned about z by so much against its foot."""
    share = np.clip((vertices[:, 2] + 30) / 60, 0, 1) * np.radians(degrees)
    c, s = np.cos(share), np.sin(share)
    x, y, z = vertices.T
    return np.column_stack([c * x - s * y, s * x + c * y, z])


@pytest.mark.parametrize("angle", [0.0, 40.0, 200.0])
@pytest.mark.parametrize("mirror, side", [(False, "right"), (True, "left")])
def test_foot_tells_axis_and_side(angle, mirror, side):
    """The whole leg's foot: 3 degrees from that of the mean leg; turned and mirrored with it."""
    vertices, triangles = virtual.whole_leg()
    body = Body(turned(virtual.moved(vertices, mirror=mirror), angle), triangles)
    foot = find_foot(body, 0.0)
    axis = np.pi - FRONT if mirror else FRONT
    off = np.angle(np.exp(1j * (foot.angle - axis - np.radians(angle))))
    assert foot.side == side and abs(np.degrees(off)) < 5


def test_no_foot_no_axis():
    """A leg that is cut at the ankle, and one that widens to a round end."""
    vertices, triangles = virtual.whole_leg()
    kept = (vertices[triangles][..., 2] > -20).all(axis=1)
    used, numbers = np.unique(triangles[kept], return_inverse=True)
    cut = Body(vertices[used], numbers.reshape(-1, 3))
    assert find_foot(cut, 0.0) is None
    legs = load_cohort("val")
    leg = Leg.from_sections(legs.length[4], legs.coefficients[4], legs.centre[4])
    assert find_foot(Body(*virtual.leg_mesh(leg, -60, foot=True, levels=200)), 0.0) is None


@pytest.fixture(scope="module")
def straight(tmp_path_factory):
    path = tmp_path_factory.mktemp("scan") / "whole.stl"
    return fit_scan(virtual.save(path, *virtual.whole_leg()))


def test_shank_turned_against_its_foot_keeps_the_front_of_the_foot(straight, tmp_path):
    """By 14 degrees, as the shape was off on another family: the foot stays in front.

    Sections of the twisted leg, seen in the axes of its foot, are those of the straight one turned
    by 14 degrees, within 2.
    """
    vertices, triangles = virtual.whole_leg()
    path = virtual.save(tmp_path / "leg.stl", twisted(vertices, 14.0), triangles)
    fit = fit_scan(path)
    assert (fit.front.source, fit.side) == ("foot", "right")
    wave = [
        np.angle(one.scanned.coefficients[60, 2] + 1j * one.scanned.coefficients[60, 7]) / 2
        for one in (straight, fit)
    ]
    assert np.degrees(wave[1] - wave[0]) % 180 == pytest.approx(14.0, abs=2.0)


def test_landmarks_tell_front_and_side(tmp_path):
    """Malleoli and tuberosity of the whole leg in the file's own axes, turned anyhow.

    The front is where the points are put: 12 degrees further inside than the foot has it.
    """
    vertices, triangles = virtual.whole_leg()
    level = np.abs(vertices[:, 2] - 5) < 6
    ring = vertices[level]
    angle = np.degrees(np.arctan2(*(ring[:, :2] - ring[:, :2].mean(axis=0)).T[::-1])) % 360
    inner = int(np.flatnonzero(level)[np.abs(angle - 192.0).argmin()])
    outer = int(np.flatnonzero(level)[np.minimum(abs(angle - 12), abs(angle - 372)).argmin()])
    placed = virtual.moved(vertices, 5, 10.0)
    path = virtual.save(tmp_path / "leg.stl", placed, triangles)
    words = [
        f"{name}={','.join(map(str, placed[k]))}"
        for name, k in (("malleolus_medial", inner), ("malleolus_lateral", outer))
    ]
    fits = [fit_scan(path, landmarks=words), fit_scan(path)]
    assert [fit.front.source for fit in fits] == ["landmarks", "foot"]
    assert fits[0].side == "right" and "by the landmarks" in " ".join(fits[0].notes)
    wave = [
        np.angle(one.scanned.coefficients[60, 2] + 1j * one.scanned.coefficients[60, 7]) / 2
        for one in fits
    ]
    assert np.degrees(wave[1] - wave[0]) % 180 == pytest.approx(12.0, abs=8.0)
    swapped = [words[0].replace("medial", "lateral"), words[1].replace("lateral", "medial")]
    assert fit_scan(path, landmarks=swapped).side == "left"


@pytest.mark.parametrize(
    "word, sentence",
    [
        ("maleolus_medial=1,2,3", "did you mean 'malleolus_medial'"),
        ("toes=1,2", "give toes=x,y,z"),
        ("toes=a,b,c", "give toes=x,y,z"),
    ],
)
def test_landmarks_that_are_none(word, sentence):
    with pytest.raises(ScanError, match=sentence):
        Landmarks.parse([word])


def test_landmark_far_from_the_skin(tmp_path):
    path = virtual.save(tmp_path / "leg.stl", *virtual.whole_leg())
    with pytest.raises(ScanError, match="mm from the skin"):
        fit_scan(path, landmarks=["toes=5000,0,0"])


@pytest.fixture(scope="module")
def reduced():
    return Reduced.read()


@pytest.fixture(scope="module")
def symmetric_fit(symmetric):
    return fit_scan(symmetric)


@pytest.fixture(scope="module")
def symmetric(tmp_path_factory):
    """A surrogate that has no side: a leg and its mirror image, averaged."""
    legs = load_cohort("val")
    series = legs.coefficients[4].copy()
    for m in range(1, 6):  # theta -> pi - theta
        series[:, m] *= (1 + (-1) ** m) / 2
        series[:, 5 + m] *= (1 - (-1) ** m) / 2
    leg = Leg.from_sections(legs.length[4], series, legs.centre[4] * [0, 1])
    path = tmp_path_factory.mktemp("scan") / "symmetric.stl"
    return virtual.save(path, *virtual.leg_mesh(leg))


def test_both_sides_where_nothing_tells(symmetric, symmetric_fit, reduced):
    """Its sides fit alike and give the same pressure: answered for both, with a part for it."""
    fit = symmetric_fit
    assert fit.other is not None and {fit.side, fit.other.side} == {"right", "left"}
    assert "neither foot nor landmarks nor shape tells" in " ".join(fit.notes)
    told = predict_pressure(fit, choose_bandage("biflex_16"), reduced)
    parts = {part.name: part for part in told.parts}
    assert max(-parts["side"].low, parts["side"].high) < 0.05 * told.value
    known = fit_scan(symmetric, side="right")
    assert known.other is None and known.side == "right"


def test_sides_that_do_not_agree_are_asked_for(symmetric_fit, reduced):
    """The other side given the sections of a leg half as wide again: no answer without --side."""
    fit = symmetric_fit
    wide = fit.other.scanned
    wide = Leg.from_sections(wide.length, 1.4 * wide.coefficients, wide.centre)
    other = replace(fit.other, scanned=wide)
    with pytest.raises(ScanError, match="give --side right or --side left"):
        predict_pressure(replace(fit, other=other), choose_bandage("biflex_16"), reduced)


def test_part_of_the_front_holds_a_front_that_is_off(straight, reduced):
    """15 degrees either way, where the shape tells it: all pressures between lie in the part.

    The turned leg is predicted anew from its own sections; 8 degrees are a smaller part.
    """
    choice = choose_bandage("biflex_16")
    sizes = {}
    for source in ("shape", "foot"):
        fit = replace(straight, front=Front(source, OFF[source]))
        told = predict_pressure(fit, choice, reduced)
        part = next(part for part in told.parts if part.name == "front")
        shape = Shape(fit.scanned, fit.leg)
        for degrees in np.linspace(-OFF[source], OFF[source], 5):
            value = pressures(shape.turned(np.radians(degrees)), reduced, choice)["B1"]
            assert part.low - 1e-6 <= value - told.value <= part.high + 1e-6
        sizes[source] = part.high - part.low
    assert sizes["shape"] > sizes["foot"] > 0.2


def test_girths_of_the_shipped_legs():
    """Ankle 194 to 249, calf 318 to 417 mm."""
    found = shipped_girths()
    assert found["ankle"] == pytest.approx((194, 249), abs=1.0)
    assert found["calf"] == pytest.approx((318, 417), abs=1.5)


def test_unlike_legs_are_said_and_widen_the_interval():
    """None of the validation legs; a leg 0.8 times as thin; a fit worse than all of theirs."""
    legs = load_cohort("val")
    leg = Leg.from_sections(legs.length[4], legs.coefficients[4], legs.centre[4])
    assert widening(leg, 1.0) == 1.0 and list(unlike(leg, 1.0)) == []
    assert widening(leg, 2 * WORST_RMS) == pytest.approx(2.0)
    assert any("POOR FIT" in word for word in unlike(leg, 3.6))
    thin = Leg.from_sections(leg.length, 0.8 * leg.coefficients, leg.centre)
    assert widening(thin, 1.0) > 1.5
    assert {word.split(" girth")[0] for word in unlike(thin, 1.0)} == {
        "UNLIKE: the ankle",
        "UNLIKE: the calf",
    }
