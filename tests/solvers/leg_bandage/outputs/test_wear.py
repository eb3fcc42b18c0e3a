"""Pressures in other postures and after hours, as outputs of the solver."""

import numpy as np
import pytest

from surrogate.conformance import check_solver
from surrogate.errors import StudyError
from surrogate_solvers.leg_bandage.outputs.answers import OUTPUTS
from surrogate_solvers.leg_bandage.outputs.states_picture import draw_states
from surrogate_solvers.leg_bandage.plugin import LegBandage
from surrogate_solvers.leg_bandage.skin_friction import SKINS


def test_without_the_options_nothing_changes():
    """Outputs, inputs and what identities of stored runs hang on are as before."""
    plain = LegBandage()
    assert set(plain.outputs) == set(OUTPUTS) and "fluid_loss" not in plain.inputs
    assert not {"relaxation", "posture", "skin"} & set(plain.identity_options)
    assert LegBandage(posture="lying").identity_options == plain.identity_options


def test_each_option_declares_what_it_answers():
    """And keeps the contract of solvers."""
    both = LegBandage(relaxation="elastic", posture="dorsiflexion")
    check_solver(both, runs=0)
    assert {"pressure_b1_over_time", "static_stiffness_index", "walking_amplitude"} <= set(
        both.outputs
    )
    assert "pressure_standing_4h" in both.outputs and "fluid_loss" in both.inputs
    assert "pressure_standing_4h" not in LegBandage(posture="standing").outputs
    assert both.identity_options["relaxation"] == "elastic"


@pytest.mark.parametrize(
    "option", [{"relaxation": "rubber"}, {"posture": "sitting"}, {"skin": "wet"}]
)
def test_unknown_words_are_refused(option):
    """With the words that are known."""
    with pytest.raises(StudyError, match="is unknown"):
        LegBandage(**option)


@pytest.mark.parametrize("skin", SKINS)
def test_a_named_skin_sets_the_friction(skin):
    """Its nominal value lies in its range, the range in what the solver accepts."""
    one, mu = SKINS[skin], LegBandage(skin=skin).inputs["mu_skin"]
    assert mu.nominal == one.nominal and one.low < one.nominal < one.high
    assert mu.range[0] <= one.low and one.high <= mu.range[1]


@pytest.fixture
def worn(rough, solved_once):
    """Elastic, with both options, on a rough mesh."""
    return LegBandage(mesh="rough", relaxation="elastic", posture="dorsiflexion").run()


def test_postures_and_hours_on_a_leg(worn, rough_result):
    """Signs that any leg has; the bandage as laid is answered to the same digits as without."""
    values = worn.values
    for name in OUTPUTS:
        np.testing.assert_array_equal(values[name], rough_result.values[name])
    over_time = values["pressure_b1_over_time"]
    assert over_time[0] == values["pressure_supine"]
    assert values["pressure_supine"] == pytest.approx(values["pressure_b1"], abs=0.05)
    assert np.all(np.diff(over_time) < 0) and over_time[3] == values["pressure_b1_4h"]
    assert 0.88 < values["kept_4h"] < 0.93
    assert values["pressure_supine"] < values["pressure_standing"]
    assert 4 < values["girth_rise"] < 9
    assert values["pressure_standing_4h"] < values["pressure_standing"]
    assert values["pressure_b1_4h"] < values["pressure_standing_4h"]


def test_the_model_is_left_as_it_was(worn):
    """No growth and no memory stays behind."""
    model = worn.model
    assert model.shell.memory is None
    np.testing.assert_array_equal(model.tissue.volumes, model.tissue.weights.sum(axis=1))
    assert {"lying", "standing", "dorsiflexion", "240 minutes"} <= set(worn.states)


def test_a_picture_of_the_states(worn, tmp_path):
    """Lying, standing, dorsiflexion and later in one PNG."""
    path = draw_states(worn, tmp_path / "states.png")
    assert path.read_bytes().startswith(b"\x89PNG") and path.stat().st_size > 20_000
