"""The command `leg-bandage`: its two verbs, its pages, its exit statuses."""

import json
import re

import numpy as np
import pytest
import virtual_scans as virtual

from surrogate_solvers.leg_bandage.geometry.basis import (
    fit_basis,
    reconstruction_errors,
    shipped_basis,
)
from surrogate_solvers.leg_bandage.geometry.cohort import load_cohort
from surrogate_solvers.leg_bandage.geometry.leg import Leg
from surrogate_solvers.leg_bandage.scan.growing import cohort_in, losses

KNOWN = ("--up", "z", "--front", "y", "--side", "right", "--ends")


@pytest.fixture
def scan(tmp_path):
    leg = Leg.from_alphas(237.6, shipped_basis().mean)
    return virtual.save(tmp_path / "leg.stl", *virtual.leg_mesh(leg))


def test_fit_scan_for_people(command, scan):
    status, out, err = command("fit-scan", scan, *KNOWN)
    assert (status, err) == (0, "")
    assert re.search(r"length +237\.[4-7] mm +185\.1 \.\. 289\.9 +inside", out)
    assert re.search(r"alpha1 +-0\.68\d\d +-0\.899 \.\. -0\.516 +inside", out)
    assert "95th percentile" in out and "B1, girth rule" in out and "unit mm" in out


def test_fit_scan_for_scripts(command, scan):
    status, out, _ = command("fit-scan", scan, *KNOWN, "--json")
    told = json.loads(out)
    assert status == 0 and told["side"] == "right" and told["unit"] == "mm"
    np.testing.assert_allclose(told["alphas"], shipped_basis().mean, atol=0.002)
    assert all(told["in_range"].values()) and told["error"]["percentile_95"] < 0.1
    marks = told["landmarks"]["fitted"]
    assert marks["b1_girth"]["girth"] == pytest.approx(
        0.8 * marks["ankle"]["girth"] + 0.2 * marks["calf"]["girth"], abs=0.1
    )


def test_leg_outside_the_range_says_so(command, tmp_path):
    """alpha2 = 0.2 is beyond the shipped 0.114."""
    leg = Leg.from_alphas(300.0, (-0.68, 0.2, 0.0, 0.0))
    path = virtual.save(tmp_path / "leg.stl", *virtual.leg_mesh(leg))
    _, out, _ = command("fit-scan", path, *KNOWN)
    assert re.search(r"length .*OUTSIDE", out) and re.search(r"alpha2 .*OUTSIDE", out)
    assert re.search(r"alpha1 .*inside", out)


def test_page_opens_offline(command, scan, tmp_path):
    """One file with all it needs: no address, no source, no import."""
    page = tmp_path / "leg.html"
    assert command("fit-scan", scan, *KNOWN, "--html", page)[0] == 0
    text = page.read_text(encoding="utf-8")
    assert "default-src 'none'" in text
    assert not re.search(r"https?://|\bsrc=|<link|@import|\bfetch\(", text)
    shape = json.loads(re.search(r'id="shape">(.*?)</script>', text, re.S)[1])
    assert np.shape(shape["scan"]) == (100, 60, 2) and np.shape(shape["residual"]) == (100, 60)
    rim = np.array(shape["sensor"])
    across = np.linalg.norm(rim[:, None] - rim[None], axis=-1).max()
    assert across == pytest.approx(50, abs=2) and rim[:, 0].max() < 0


@pytest.fixture
def folder(tmp_path):
    """Six training legs in their pose, a sphere's worth of noise, and a file of no concern."""
    where, cohort = tmp_path / "scans", load_cohort("train")
    where.mkdir()
    for leg in range(6):
        mesh = virtual.leg_mesh(
            Leg.from_sections(cohort.length[leg], cohort.coefficients[leg], cohort.centre[leg]),
            levels=70,
            around=60,
        )
        virtual.save(where / f"leg{leg}.ply", *mesh)
    (where / "broken.stl").write_bytes(b"")
    (where / "notes.txt").write_text("not a scan")
    return where


def test_build_cohort_and_use_it(command, folder, tmp_path):
    """Six legs make a basis; what it loses is what the sections of these legs lose: 0.05 mm."""
    out, page = tmp_path / "mine.npz", tmp_path / "mine.html"
    status, text, err = command(
        "build-cohort", folder, "--out", out, *KNOWN, "--html", page, "--json"
    )
    told = json.loads(text)
    assert status == 0 and len(told["legs"]) == 6 and "leg3.ply" in err
    assert told["skipped"] == {"broken.stl": "the file is empty; export the scan again"}
    cohort = load_cohort("train")
    np.testing.assert_allclose(
        [leg["length"] for leg in told["legs"]], cohort.length[:6], atol=0.15
    )
    shipped = type(cohort)(cohort.coefficients[:6], cohort.centre[:6], cohort.length[:6], {})
    np.testing.assert_allclose(
        [loss["percentile_95"] for loss in told["losses"]],
        [loss.percentile_95 for loss in losses(shipped)],
        atol=0.05,
    )
    assert "Figure 1" in page.read_text(encoding="utf-8")
    status, text, _ = command(
        "fit-scan", folder / "leg2.ply", *KNOWN, "--cohort", out, "--modes", 5, "--json"
    )
    told = json.loads(text)
    assert len(told["alphas"]) == 5 and all(told["in_range"].values())
    assert told["ranges"]["length"] == pytest.approx(
        [cohort.length[:6].min(), cohort.length[:6].max()], abs=0.15
    )


def test_losses_of_the_shipped_legs():
    """README.md prints them: 9.98, 7.60, 3.21, 2.46 mm; a leg left out loses more."""
    found = losses(load_cohort("train"))
    assert [loss.percentile_95 for loss in found[:4]] == pytest.approx(
        [9.98, 7.60, 3.21, 2.46], abs=0.005
    )
    assert all(loss.left_out_95 > loss.percentile_95 for loss in found)


def test_left_out_loss_is_that_of_a_basis_without_the_leg():
    """Three legs, one mode: against the definition, leg by leg."""
    whole = load_cohort("train")
    legs = [
        type(whole)(whole.coefficients[[k]], whole.centre[[k]], whole.length[[k]], {})
        for k in range(3)
    ]
    three = type(whole)(whole.coefficients[:3], whole.centre[:3], whole.length[:3], {})
    away = [
        reconstruction_errors(fit_basis(np.delete(three.snapshots(), k, axis=1), 1), leg)[1]
        for k, leg in enumerate(legs)
    ]
    assert losses(three)[0].left_out_95 == pytest.approx(np.percentile(away, 95))


@pytest.mark.parametrize(
    "words, sentence",
    [
        (("fit-scan", "nowhere.stl"), "there is no such file"),
        (("build-cohort", "nowhere"), "there is no such folder"),
        (("fit-scan", "SCAN", "--cohort", "nowhere.npz"), "nowhere.npz: there is no such file"),
        (("fit-scan", "SCAN", "--cohort", "SCAN"), "is not a cohort; make one"),
        # Where results go is looked at before anything that takes its time.
        (("fit-scan", "nowhere.stl", "--html", "no/where/page.html"), "cannot be written"),
        (("build-cohort", "nowhere", "--html", "no/where/page.html"), "cannot be written"),
        (("build-cohort", "nowhere", "--out", "no/where/legs.npz"), "cannot be written"),
        (
            ("predict", "nowhere.stl", "--tension", "0.1", "--html", "no/page.html"),
            "cannot be written",
        ),
        (("fit-scan",), "Missing argument"),
        (("fit-scan", "SCAN", "--modes", "0"), "Invalid value for '--modes'"),
    ],
)
def test_mistakes_end_in_a_sentence_and_status_2(command, scan, words, sentence):
    status, out, err = command(*(scan if word == "SCAN" else word for word in words))
    assert status == 2 and sentence in err and "Traceback" not in out + err


def test_too_few_scans(command, folder):
    for leg in range(4):
        (folder / f"leg{leg}.ply").unlink()
    status, _, err = command("build-cohort", folder, *KNOWN)
    assert status == 2
    assert "2 of 3 scans" in err and "broken.stl: the file is empty" in err


def test_stored_cohort_round_trip(command, folder, tmp_path):
    out = tmp_path / "mine.npz"
    command("build-cohort", folder, "--out", out, *KNOWN)
    stored = cohort_in(out)
    assert list(stored.facts["side"]) == ["right"] * 6
    assert stored.coefficients.shape == (6, 100, 11) and stored.snapshots().shape == (1300, 6)
