"""The words of `solve:`: what they become, and every mistake at its place."""

import re

import pytest

from surrogate.errors import StudyError
from surrogate.solving.goals import Desire, Objective, Target
from surrogate.study.solving import Goals, stated
from surrogate.study.study import Study

SOUND = """\
study: demo
solver: {name: borehole}
parameters:
  rw: [0.05, 0.15]
  L: {range: [1120, 1680], unit: m}
  Kw: {range: [9855, 12045], unit: m/yr}
designs:
  train: {method: latin_hypercube, runs: 20, seed: 1}
surrogates: {linear: {method: linear}}
solve:
"""


def study(goal, more=""):
    return Study.from_text(f"{SOUND}  one: {goal}\n{more}")


def problem(goal):
    return study(goal).problems["one"]


def test_a_target_may_be_a_value_with_a_unit_and_a_tolerance():
    assert problem("{target: {flow: 80}}").goals == (Target("flow", 80.0),)
    found = problem("{target: {flow: {value: 8e4 dm^3/yr, within: 2000 dm^3/yr}}}").goals[0]
    assert (found.low, found.value, found.high) == pytest.approx((78.0, 80.0, 82.0))
    assert problem("{target: {flow: [70, 90]}}").goals == (Target("flow", 80.0, 70.0, 90.0),)


def test_objectives_and_desirabilities():
    assert problem("{minimise: flow}").goals == (Objective("flow", 1),)
    assert problem("{maximise: [flow]}").goals == (Objective("flow", -1),)
    (found,) = problem("{desirability: {flow: {target: [50, 80, 120], exponent: 2}}}").goals
    assert found == Desire("flow", "target", 50.0, 120.0, 80.0, exponent=2.0)


def test_parameters_that_are_not_free_are_held():
    one = problem("{minimise: flow, free: [rw], uncertain: [L]}")
    assert (one.free, one.uncertain, dict(one.held)) == (("rw",), ("L",), {"Kw": 10950.0})
    two = problem("{minimise: flow, fix: {L: 120000 cm}}")
    assert (two.free, dict(two.held)) == (("rw", "Kw"), {"L": pytest.approx(1200.0)})


def test_limits_name_outputs_inputs_and_constants():
    (limit,) = problem(
        '{minimise: rw_, subject_to: ["flow <= 90 m^3/yr"]}'.replace("rw_", "flow")
    ).limits
    assert limit.names == ("flow",)
    two = problem('{subject_to: ["L*rw >= 100 m^2", "L - Hl/10 >= 1000 m"]}')
    assert dict(two.fixed) == {"Hl": 760.0}


MISTAKES = {
    "no goal": ("{free: [rw]}", "11:8", "says no goal; give target"),
    "two kinds": ("{target: {flow: 80}, minimise: flow}", "11:8", "give one of target"),
    "output": ("{target: {flwo: 80}}", "11:24", "no output 'flwo'; did you mean 'flow'"),
    "objective": ("{minimise: flwo}", "11:", "did you mean 'flow'"),
    "unit": ("{target: {flow: 80 kg}}", "11:24", "'kg' does not convert"),
    "number": ("{target: {flow: much}}", "11:24", "'much' is not a number"),
    "upside down": ("{target: {flow: [90, 80]}}", "11:24", "upside down"),
    "tolerance": ("{target: {flow: {value: 80, within: -2}}}", "11:24", "must be above 0"),
    "both": ("{target: {flow: {value: 8, range: [7, 9]}}}", "11:24", "give either value"),
    "desire": ("{desirability: {flow: {maximise: [9, 8]}}}", "11:30", "must rise"),
    "desires": ("{desirability: {flow: {}}}", "11:30", "give one of maximise"),
    "free": (
        "{minimise: flow, free: [rv]}",
        "11:32",
        "parameter 'rv' is unknown; Allowed: Kw, L, rw",
    ),
    "twice": ("{minimise: flow, free: [rw], uncertain: [rw]}", "11:49", "also under free"),
    "nothing left": ("{minimise: flow, uncertain: [rw, L, Kw]}", "11:8", "leave at least one"),
    "held outside": ("{minimise: flow, fix: {rw: 3}}", "11:35", "outside of its range"),
    "limit": (
        '{minimise: flow, subject_to: ["flow <= 90 kg"]}',
        "11:",
        "cannot be added or compared",
    ),
    "equality": ('{minimise: flow, subject_to: ["flow = 90 m^3/yr"]}', "11:", "is an equality"),
    "surrogate": ("{minimise: flow, surrogate: gp}", "11:36", "surrogate 'gp' is unknown"),
    "probability": ("{minimise: flow, probability: 90}", "11:38", "must be below 1"),
    "key": ("{minimize: flow}", "11:9", "did you mean 'minimise'"),
    "key of a target": ("{target: {flow: {valu: 3}}}", "11:", "did you mean 'value'"),
}


@pytest.mark.parametrize("name", MISTAKES)
def test_a_mistake_is_told_at_its_place(name):
    goal, place, sentence = MISTAKES[name]
    with pytest.raises(StudyError) as error:
        study(goal)
    assert any(
        re.match(rf"study.yaml:{place}", one) and sentence in one for one in error.value.mistakes
    ), error.value.mistakes


@pytest.mark.parametrize("section", ["solve", "learning", "sensitivity", "calibration"])
def test_a_broken_surrogate_is_not_called_missing(section, tmp_path):
    """What reads a surrogate does not add that the study has none."""
    words = {
        "solve": "{one: {minimise: flow}}",
        "learning": "{}",
        "sensitivity": "sobol",
        "calibration": "{cases: t.csv, free: [rw]}",
    }
    (tmp_path / "s.yaml").write_text(
        SOUND.replace("{method: linear}", "{methd: linear}").replace("solve:\n", "")
        + f"{section}: {words[section]}\n"
    )
    (tmp_path / "t.csv").write_text("L,Kw,flow\n1200,10000,80\n")
    with pytest.raises(StudyError, match="key 'methd' is unknown") as error:
        Study.from_yaml(tmp_path / "s.yaml")
    assert "has none" not in str(error.value)


def test_uncertain_inputs_may_not_be_joined_by_constraints():
    more = 'constraints: ["L*rw >= 100 m^2"]\n'
    with pytest.raises(StudyError, match="joins the uncertain L with others"):
        study("{minimise: flow, uncertain: [L]}", more)


def test_the_command_states_goals_in_the_same_words():
    one = study("{target: {flow: 80}, probability: 0.8}")
    assert stated(one, None, Goals()) == one.problems["one"]
    assert stated(one, "one", Goals(fix=("L=1200 m",))).held == {"L": 1200.0}
    asked = stated(one, None, Goals(target=("flow=90",), free=("rw",)))
    assert (asked.name, asked.goals) == ("asked", (Target("flow", 90.0),))
    with pytest.raises(StudyError, match="the study has no goal 'two'; did you mean 'one'|Allowed"):
        stated(one, "two", Goals())
    with pytest.raises(StudyError) as error:
        stated(one, None, Goals(target=("flwo=90",), fix=("rv=1",)))
    assert len(error.value.mistakes) == 2
    with pytest.raises(StudyError, match="--target 'flow' is not NAME=VALUE"):
        stated(one, None, Goals(target=("flow",)))
