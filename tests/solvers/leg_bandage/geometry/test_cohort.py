"""The shipped legs are the documented ones."""

import numpy as np
import pytest

from surrogate_solvers.leg_bandage.geometry.cohort import load_cohort, sections_of, snapshot
from surrogate_solvers.leg_bandage.geometry.section import girth


@pytest.mark.parametrize("which, legs", [("train", 35), ("val", 38)])
def test_shapes_as_in_the_paper(which, legs):
    """Chassagne et al. 2018: 35 and 38 legs, 100 sections of 13 numbers, 1 300 a leg."""
    cohort = load_cohort(which)
    assert len(cohort) == legs
    assert cohort.coefficients.shape == (legs, 100, 11)
    assert cohort.snapshots().shape == (1300, legs)


def test_documented_length_bmi_and_girths():
    """Figures of data/README.md: L 185.1..289.9 mm, BMI 24.7 [18.5..32.5], 217, 371 mm."""
    cohort = load_cohort("train")
    assert cohort.length.min() == pytest.approx(185.1, abs=0.05)
    assert cohort.length.max() == pytest.approx(289.9, abs=0.05)
    bmi = cohort.facts["bmi"]
    assert (bmi.mean(), bmi.min(), bmi.max()) == pytest.approx((24.7, 18.5, 32.5), abs=0.05)
    assert cohort.facts["ankle"].mean() == pytest.approx(217, abs=0.5)
    assert cohort.facts["calf"].mean() == pytest.approx(371, abs=0.5)


def test_stored_girths_are_those_of_the_stored_sections():
    """The girths were measured on the body mesh: the Fourier sections must give them back.

    0.8 mm in 200 to 450 is what five harmonics leave out of a section.
    """
    cohort = load_cohort("train")
    girths = girth(cohort.coefficients)
    assert np.abs(girths.max(axis=1) - cohort.facts["calf"]).max() < 0.8


def test_snapshot_round_trip():
    rng = np.random.default_rng(1)
    coefficients, centre = rng.normal(size=(2, 7, 11)), rng.normal(size=(2, 7, 2))
    back = sections_of(snapshot(coefficients, centre, [200.0, 250.0]), [200.0, 250.0])
    np.testing.assert_allclose(back[0], coefficients, rtol=1e-13)
    np.testing.assert_allclose(back[1], centre, rtol=1e-13)
