"""CalculiX on a plate with a hole (studies/calculix_plate.yaml), against the handbook.

CalculiX makes solids of plane elements; the plate of the tests is thin against its hole, so
that the stress does not vary through the thickness and plane stress holds.
"""

import shutil
from math import pi
from pathlib import Path

import pytest

from surrogate import Study
from surrogate.errors import SolverError
from surrogate.runs.dataset import call_and_answer

STUDY = Path(__file__).parents[2] / "studies" / "calculix_plate.yaml"
#: Howland 1930, as read in Peterson's Stress Concentration Factors: d / w -> largest stress
#: over that far away, of a plate of finite width.
HOWLAND = {0.1: 3.03, 0.2: 3.14, 0.3: 3.36, 0.4: 3.74, 0.5: 4.32}
WIDTH, LENGTH, THIN, FORCE, YOUNG = 100.0, 400.0, 0.1, 1000.0, 210000.0
FAR = FORCE / (WIDTH * THIN)


@pytest.fixture(scope="module")
def plate():
    if not all(map(shutil.which, ("ccx", "sh", "awk"))):
        pytest.skip("CalculiX (ccx) is not installed")
    solver = Study.from_yaml(STUDY).spec.solver

    def solve(diameter, **changed):
        given = {"width": WIDTH, "length": LENGTH, "thickness": THIN, "force": FORCE}
        return solver(**{**given, "young": YOUNG, "diameter": diameter, **changed})

    return solve


def peterson(ratio):
    """Stress concentration of the gross section, the polynomial through Howland's values.

    Pilkey, Peterson's Stress Concentration Factors, 2nd edition 1997, chart 4.1.
    """
    return 0.284 + 2 / (1 - ratio) - 0.6 * (1 - ratio) + 1.32 * (1 - ratio) ** 2


@pytest.mark.parametrize("ratio", HOWLAND)
def test_the_largest_stress_is_howlands(plate, ratio):
    """Within 1 %, that of the chart; 3.03 to 4.32 times the stress far away."""
    found = plate(ratio * WIDTH)["peak_stress"] / FAR
    assert found == pytest.approx(HOWLAND[ratio], rel=0.01)
    assert found == pytest.approx(peterson(ratio), rel=0.01)


def test_a_small_hole_in_a_wide_plate_is_kirschs(plate):
    """Kirsch 1898: three times the stress far away. A width of 40 diameters adds 0.2 %."""
    assert plate(2.5)["peak_stress"] / FAR == pytest.approx(3.0, rel=0.005)


def test_a_hole_softens_by_three_times_its_area(plate):
    """Few round holes in plane stress: E / E0 = 1 - 3 phi, phi the share of the area."""
    full = FAR * LENGTH / 2 / YOUNG
    more = plate(10.0)["half_elongation"] / full - 1
    assert more == pytest.approx(3 * pi * 10.0**2 / 4 / (WIDTH * LENGTH), rel=0.02)


def test_answers_are_linear_in_the_load(plate):
    once, twice = plate(20.0), plate(20.0, force=2 * FORCE, young=2 * YOUNG)
    assert twice["peak_stress"] == pytest.approx(2 * once["peak_stress"], rel=1e-5)
    assert twice["half_elongation"] == pytest.approx(once["half_elongation"], rel=1e-5)


def test_a_stored_run_is_what_the_program_gives(plate):
    """To the six digits that CalculiX prints."""
    study = Study.from_yaml(STUDY)
    inputs, outputs = call_and_answer(study.stored_runs[0].runs, 5)
    again = study.spec.solver(**inputs)
    assert again == {name: pytest.approx(float(y), rel=2e-5) for name, y in outputs.items()}


def test_a_hole_wider_than_the_plate_is_a_failed_run(plate):
    """CalculiX says why: an element turned inside out."""
    with pytest.raises(SolverError, match="exit status"):
        plate(120.0 - 25.0, width=80.0)
