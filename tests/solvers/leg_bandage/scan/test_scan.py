"""Scans whose truth is known, through `fit_scan`."""

import json
import os
import re

import numpy as np
import pytest
import trimesh
import virtual_scans as virtual

from surrogate_solvers.leg_bandage.geometry.basis import reconstruction_errors, shipped_basis
from surrogate_solvers.leg_bandage.geometry.cohort import Cohort, load_cohort
from surrogate_solvers.leg_bandage.geometry.landmarks import extreme_girths
from surrogate_solvers.leg_bandage.geometry.leg import Leg
from surrogate_solvers.leg_bandage.scan import cuts, fit_scan, girths, pose, sections
from surrogate_solvers.leg_bandage.scan.cuts import TOP
from surrogate_solvers.leg_bandage.scan.decimation import SEARCHED, decimated
from surrogate_solvers.leg_bandage.scan.pose import Body

BASIS = shipped_basis()
KNOWN = {"up": "z", "front": "y", "side": "right", "ends": True}
"""Nothing is left to tell for a leg that is cut and stands as the shipped ones."""


@pytest.fixture(scope="module")
def mean_leg():
    return Leg.from_alphas(237.6, BASIS.mean)


@pytest.fixture(scope="module")
def whole():
    return virtual.whole_leg()


@pytest.fixture(scope="module")
def whole_fit(whole, tmp_path_factory):
    return fit_scan(virtual.save(tmp_path_factory.mktemp("scan") / "whole.stl", *whole))


@pytest.mark.parametrize(
    "length, alphas",
    [
        (237.6, (-0.68, 0.0, 0.0, 0.0)),
        (190.0, (-0.85, 0.06, -0.05, 0.02)),
        (285.0, (-0.56, -0.04, 0.08, -0.02)),
    ],
)
def test_legs_in_their_pose_are_recovered(tmp_path, length, alphas):
    """L within 0.15 mm (a level is told to 0.1 mm), alphas within 0.0005."""
    path = virtual.save(tmp_path / "leg.stl", *virtual.leg_mesh(Leg.from_alphas(length, alphas)))
    fit = fit_scan(path, **KNOWN)
    assert fit.length == pytest.approx(length, abs=0.15)
    np.testing.assert_allclose(fit.alphas, alphas, atol=5e-4)
    assert fit.error.percentile_95 < 0.05


@pytest.mark.parametrize(
    "alpha1, length, seed", [(-0.85, 200.0, 1), (-0.68, 240.0, 2), (-0.54, 280.0, 3)]
)
def test_pose_is_told_by_the_shape(tmp_path, alpha1, length, seed):
    """Legs that are the first mode alone have their pose by definition: the misfit is 0 there.

    After any rigid motion and change of unit: alphas within 0.005 of the part of the leg
    that was found between the cuts, and L within 1 mm of the given one.
    """
    leg = Leg.from_alphas(length, (alpha1, 0.0, 0.0, 0.0))
    vertices, triangles = virtual.leg_mesh(leg)
    fit = fit_scan(
        virtual.save(tmp_path / "leg.ply", virtual.moved(vertices, seed, 10.0), triangles)
    )
    assert (fit.unit, fit.side) == ("cm", "right")
    assert fit.length == pytest.approx(length, abs=1.0)
    low = length - fit.length if extreme_girths(leg)[1] > 0 else 0.0
    expected = virtual.truth(leg, BASIS, low, low + fit.length)
    np.testing.assert_allclose(fit.alphas, expected, atol=0.005)


def test_foot_and_thigh_are_cut_off(tmp_path, mean_leg):
    """The ankle is the narrowest girth of the leg, the top 1.03 of the way to the widest.

    Girths are smoothed over 20 mm, so the kink between foot and leg is found within 4 mm and
    the cuts within 6 mm; alphas within 0.003 of the part of the leg that was found.
    """
    mesh = virtual.leg_mesh(mean_leg, -60, 450, foot=True, levels=300)
    fit = fit_scan(virtual.save(tmp_path / "leg.stl", *mesh), up="z", front="y")
    _, ankle, _, calf = extreme_girths(mean_leg)
    low = float(re.search(r"(\d+) mm above the lower end", " ".join(fit.notes))[1]) - 60
    assert low == pytest.approx(ankle, abs=4)
    assert fit.length == pytest.approx(TOP * (calf - ankle), abs=6)
    expected = virtual.truth(mean_leg, BASIS, low, low + fit.length)
    np.testing.assert_allclose(fit.alphas, expected, atol=0.003)


def test_whole_body_mesh_between_the_cuts_of_the_cohort(whole, tmp_path):
    """A whole leg of the body model gives the numbers that its shipped sections give.

    Length is given (the shipped cut is a part of the shank, which no scan shows). The mesh is
    four times coarser than the one that was cut for the cohort: 0.006 in the alphas.
    """
    cohort = load_cohort("val")
    length = float(cohort.length[virtual.WHOLE_LEG])
    direct = BASIS.project(cohort.snapshots().T[virtual.WHOLE_LEG])
    fit = fit_scan(virtual.save(tmp_path / "leg.stl", *whole), up="z", front="y", length=length)
    assert fit.side == "right" and fit.length == pytest.approx(length)
    np.testing.assert_allclose(fit.alphas, direct, atol=0.006)


@pytest.mark.parametrize(
    "name, unit, scale, mirror, seed",
    [
        ("leg.obj", "m", 1000.0, False, 11),
        ("leg.ply", "inch", 25.4, True, 12),
        ("leg.STL", "cm", 10.0, True, 13),
    ],
)
def test_any_motion_unit_format_and_side(
    whole, whole_fit, tmp_path, name, unit, scale, mirror, seed
):
    """The same leg in another place, unit, format, or mirrored is the same leg: to 0.001."""
    vertices, triangles = whole
    path = virtual.save(tmp_path / name, virtual.moved(vertices, seed, scale, mirror), triangles)
    fit = fit_scan(path)
    assert (fit.unit, fit.side) == (unit, "left" if mirror else "right")
    assert fit.length == pytest.approx(whole_fit.length, abs=0.1)
    np.testing.assert_allclose(fit.alphas, whole_fit.alphas, atol=0.001)
    assert fit.error.rms == pytest.approx(whole_fit.error.rms, abs=0.01)


def test_noise_of_a_scanner(whole, whole_fit, tmp_path):
    """0.3 mm on every coordinate of 8 mm facets: L within 2 mm, alphas within 0.006.

    The flat maximum of the calf moves the upper cut; the RMS error grows by less than the noise.
    """
    vertices, triangles = whole
    fit = fit_scan(virtual.save(tmp_path / "leg.stl", virtual.noisy(vertices, 0.3), triangles))
    assert fit.length == pytest.approx(whole_fit.length, abs=2.0)
    np.testing.assert_allclose(fit.alphas, whole_fit.alphas, atol=0.006)
    assert whole_fit.error.rms < fit.error.rms < whole_fit.error.rms + 0.3


def test_another_mesh_of_the_same_leg(tmp_path, mean_leg):
    """A third of the facets along both directions: L within 0.3 mm, alphas within 0.005."""
    fits = []
    for levels, around in ((160, 120), (54, 40)):
        mesh = virtual.leg_mesh(mean_leg, levels=levels, around=around)
        fits.append(fit_scan(virtual.save(tmp_path / "leg.stl", *mesh), **KNOWN))
    assert fits[1].length == pytest.approx(fits[0].length, abs=0.3)
    np.testing.assert_allclose(fits[1].alphas, fits[0].alphas, atol=0.005)


def test_holes_are_filled_and_told(tmp_path, mean_leg):
    """Three holes, a tenth of the skin: alphas within 0.003, the rest of the leg within 0.3 mm."""
    vertices, triangles = virtual.leg_mesh(mean_leg)
    balls = [((0, 40, 120), 35), ((40, -20, 60), 25), ((-50, -40, 200), 30)]
    path = virtual.save(tmp_path / "leg.stl", vertices, virtual.without(vertices, triangles, balls))
    fit = fit_scan(path, **KNOWN)
    assert 0.08 < fit.sections.missing.mean() < 0.13
    assert any(note.startswith("holes make up 1") for note in fit.notes)
    np.testing.assert_allclose(fit.alphas, BASIS.mean, atol=0.003)
    assert fit.error.percentile_95 < 0.3


def test_known_up_keeps_the_tilt(whole, whole_fit, tmp_path):
    """This leg leans by some degrees; alpha2 and alpha3 are mostly the lean."""
    fit = fit_scan(virtual.save(tmp_path / "leg.stl", *whole), up="z")
    assert abs(fit.alphas[2]) > 0.1 > 10 * abs(whole_fit.alphas[2])
    assert not fit.in_range["alpha3"] and whole_fit.in_range["alpha3"]


def test_largest_piece_is_taken_and_told(tmp_path, mean_leg):
    vertices, triangles = virtual.leg_mesh(mean_leg)
    crumb = triangles[(triangles < 4000).all(axis=1)]
    path = virtual.save(
        tmp_path / "leg.stl",
        np.concatenate([vertices, 0.2 * vertices[:4000] + [300, 0, 0]]),
        np.concatenate([triangles, crumb + len(vertices)]),
    )
    fit = fit_scan(path, **KNOWN)
    assert any("2 pieces" in note for note in fit.notes)
    np.testing.assert_allclose(fit.alphas, BASIS.mean, atol=0.002)


@pytest.mark.parametrize("leg", range(0, 38, 6))
def test_validation_legs_as_scans(tmp_path, leg):
    """A shipped leg as a mesh in its pose gives what its own sections give.

    L within 0.15 mm, alphas within 0.0005, 95th percentile of the error within 0.03 mm.
    """
    cohort = load_cohort("val")
    one = Cohort(
        cohort.coefficients[leg : leg + 1],
        cohort.centre[leg : leg + 1],
        cohort.length[leg : leg + 1],
        {},
    )
    mesh = virtual.leg_mesh(Leg.from_sections(one.length[0], one.coefficients[0], one.centre[0]))
    fit = fit_scan(virtual.save(tmp_path / "leg.stl", *mesh), **KNOWN)
    assert fit.length == pytest.approx(one.length[0], abs=0.15)
    np.testing.assert_allclose(fit.alphas, BASIS.project(one.snapshots().T)[0], atol=5e-4)
    direct = np.percentile(reconstruction_errors(BASIS, one)[1], 95)
    assert fit.error.percentile_95 == pytest.approx(direct, abs=0.03)


@pytest.mark.parametrize(
    "kind, options, mark",
    [
        ("stl", {"file_type": "stl_ascii"}, "solid"),
        ("obj", {}, "v "),
        ("ply", {"encoding": "ascii"}, "element"),
        ("ply", {"encoding": "binary"}, "element"),
    ],
)
def test_names_in_an_older_encoding(tmp_path, mean_leg, kind, options, mark):
    """A word of Latin-1 in the file, as scanners write names, changes nothing."""
    path, words = tmp_path / f"leg.{kind}", {"stl": "solid ", "obj": "# ", "ply": "comment "}[kind]
    trimesh.Trimesh(*virtual.leg_mesh(mean_leg), process=False).export(path, **options)
    content, line = path.read_bytes(), f"{words}Größe".encode("latin-1")
    if kind == "stl":
        content = content.partition(b"\n")[2]
        path.write_bytes(line + b"\n" + content)
    else:
        path.write_bytes(content.replace(mark.encode(), line + b"\n" + mark.encode(), 1))
    np.testing.assert_allclose(fit_scan(path, **KNOWN).alphas, BASIS.mean, atol=5e-4)


def test_same_scan_same_digits(whole, whole_fit, tmp_path):
    again = fit_scan(virtual.save(tmp_path / "again.stl", *whole))
    assert again.alphas == whole_fit.alphas and again.length == whole_fit.length
    np.testing.assert_array_equal(again.residual, whole_fit.residual)


def test_residual_is_along_the_normal_and_outwards(tmp_path, mean_leg):
    """Radii 1 mm larger than a leg of the basis: alphas take some, the sum of both is 1 mm."""
    fatter = mean_leg.coefficients + np.eye(11)[0]
    mesh = virtual.leg_mesh(Leg.from_sections(mean_leg.length, fatter, mean_leg.centre))
    fit = fit_scan(virtual.save(tmp_path / "leg.stl", *mesh), **KNOWN)
    taken = fit.leg.coefficients[:, 0] - mean_leg.coefficients[:, 0]
    np.testing.assert_allclose(fit.residual.mean(axis=1) + taken, 1.0, atol=0.15)


def test_a_fine_scan_is_searched_with_fewer_triangles(tmp_path, mean_leg, monkeypatch):
    """Cut on all its triangles in the end: the same answer as without, to 0.0005.

    What is cut on all triangles is settling, not the search. The fits are of a third of the
    scan, of which the search sees as small a part.
    """
    fine = virtual.leg_mesh(mean_leg, levels=320, around=200)
    seen = decimated(Body(*fine))
    assert 10_000 < len(seen.triangles) < SEARCHED < len(fine[1]) / 3
    fine = virtual.leg_mesh(mean_leg, levels=190, around=115)
    path = virtual.save(tmp_path / "leg.ply", virtual.moved(fine[0], 5), fine[1])
    monkeypatch.setattr("surrogate_solvers.leg_bandage.scan.decimation.SEARCHED", SEARCHED // 3)
    sizes, cut = [], sections.cut_sections

    def counting(vertices, triangles, z):
        sizes.append(len(triangles))
        return cut(vertices, triangles, z)

    for module in (pose, girths, cuts):
        monkeypatch.setattr(module, "cut_sections", counting)
    fast = fit_scan(path, side="right")
    settling = sizes.count(len(fine[1]))
    monkeypatch.setattr("surrogate_solvers.leg_bandage.scan.decimation.SEARCHED", 10**9)
    slow = fit_scan(path, side="right")
    assert settling < 0.7 * (sizes.count(len(fine[1])) - settling)
    np.testing.assert_allclose(fast.alphas, slow.alphas, atol=5e-4)
    assert fast.length == pytest.approx(slow.length, abs=0.05)


def test_a_name_that_is_not_utf8(tmp_path, mean_leg, command):
    """Latin-1 in the file's name: fitted, and told on the terminal, as JSON and on the page."""
    name = os.fsdecode(b"Gr\xf6\xdfe.stl")
    path = virtual.save(tmp_path / "leg.stl", *virtual.leg_mesh(mean_leg, levels=60, around=60))
    path = path.rename(tmp_path / name)
    words = ("fit-scan", path, "--up", "z", "--front", "y", "--side", "right", "--ends")
    status, out, err = command(*words, "--html", tmp_path / "page.html")
    assert (status, err) == (0, "") and "alpha1" in out
    assert "alpha1" in (tmp_path / "page.html").read_text(encoding="utf-8")
    status, out, _ = command(*words, "--json")
    assert status == 0 and json.loads(out)
    status, _, err = command("fit-scan", tmp_path / os.fsdecode(b"\xdf.stl"))
    assert status == 2 and "there is no such file" in err
