"""The pressure standing and after four hours: the hoop, its errors, and what is said of them."""

import json
from dataclasses import replace

import numpy as np
import pytest

from surrogate_solvers.leg_bandage.bandage.relaxation import RELAXATIONS
from surrogate_solvers.leg_bandage.geometry.cohort import DATA
from surrogate_solvers.leg_bandage.geometry.landmarks import b1_height
from surrogate_solvers.leg_bandage.plugin import LegBandage
from surrogate_solvers.leg_bandage.prediction import BandageChoiceError, choose_bandage
from surrogate_solvers.leg_bandage.prediction.worn import Hoop, hoop_on, missed
from surrogate_solvers.leg_bandage.prediction.worn_pressure import worn_pressures
from surrogate_solvers.leg_bandage.verification.legs import validation_leg

HOOP = Hoop(stretch=1.2844, bone=0.13)


def test_the_hoop_follows_girth_and_tension():
    """A volume of 1.05 with 13 % of bone: girth 2.15 % more, T and P by hand; 1 changes nothing."""
    girth = np.sqrt(1 + 0.05 * 0.87)
    by_hand = (1.2844 * girth - 1) / 0.2844 / girth
    assert HOOP.pressure(1.05) == pytest.approx(by_hand) and HOOP.pressure(1.0) == 1.0
    assert HOOP.kept(240.0, 0.0) == pytest.approx(RELAXATIONS["elastic"].at(240.0))
    assert HOOP.kept(0.0, 0.05) == pytest.approx(1.0)


def test_stored_hoops_are_those_of_the_program():
    """On validation legs, whose sections are at hand, to the printed digits."""
    for one in json.loads((DATA / "worn.json").read_text())["cases"]:
        if not one["leg"].isdigit():
            continue
        leg = validation_leg(int(one["leg"]))
        hoop = hoop_on(leg, b1_height(leg), 1.3)
        assert hoop.standing() == pytest.approx(one["hoop_standing"], abs=6e-5)
        assert hoop.kept(240.0, one["fluid_loss"]) == pytest.approx(one["hoop_kept_4h"], abs=6e-5)


def test_what_the_hoop_misses_is_small_beside_what_it_tells():
    """Finite elements on several legs: no leg is off by 0.05 of its pressure lying."""
    cases = json.loads((DATA / "worn.json").read_text())["cases"]
    rise, kept = missed()
    assert rise == max(abs(one["standing"] - one["hoop_standing"]) for one in cases)
    assert 0 < rise < 0.05 and 0 < kept < 0.05


@pytest.mark.slow
def test_stored_finite_elements_are_those_of_the_program():
    """The mean leg, 20 s: the solver gives what is stored."""
    stored = json.loads((DATA / "worn.json").read_text())["cases"][0]
    solver = LegBandage("coarse", fabric=stored["bandage"], posture="standing")
    values = solver()
    ratio = values["pressure_standing"] / values["pressure_supine"]
    assert ratio == pytest.approx(stored["standing"], abs=2e-4)


def test_intervals_have_named_parts():
    """Roots of sums of squares; standing is above, four hours later below the pressure as laid."""
    standing, later = worn_pressures((30.0, 24.0, 37.0), HOOP)
    assert [part.name for part in standing.parts] == ["lying", "swelling", "hoop"]
    assert [part.name for part in later.parts] == ["lying", "fabric", "fluid", "hoop"]
    assert later.value < 30.0 < standing.value
    for one in (standing, later):
        down = np.sqrt(sum(part.low**2 for part in one.parts))
        assert one.low == pytest.approx(one.value - down) and one.high > one.value
        assert all(part.low <= 0 <= part.high for part in one.parts)
    assert worn_pressures((30.0, 24.0, 37.0), None) == ()


def test_a_known_pressure_leaves_what_is_not_known_of_the_leg():
    """No interval lying: what is left is swelling or fabric and fluid, and the hoop."""
    standing, _ = worn_pressures((30.0, 30.0, 30.0), replace(HOOP, bone=0.2))
    assert 0 < standing.high - standing.low < 4


def test_a_skin_by_its_name():
    """Dry: 0.2 to 0.3 of 0.38; moist: it holds as at 0.3. Unknown and doubled ones are refused."""
    dry, moist = (choose_bandage("biflex_16", skin=name) for name in ("dry", "moist"))
    assert dry.mu_range == (0.2, 0.3) and dry.mu_skin == 0.28
    assert moist.mu_range is None and moist.mu_skin == 0.3
    with pytest.raises(BandageChoiceError, match="unknown"):
        choose_bandage("biflex_16", skin="wet")
    with pytest.raises(BandageChoiceError, match="either"):
        choose_bandage("biflex_16", mu_skin=0.2, skin="dry")
