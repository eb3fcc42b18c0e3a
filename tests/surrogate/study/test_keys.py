"""Keys that are no text: null, numbers, nan and booleans, in any section of a study."""

import pytest

from surrogate.errors import StudyError
from surrogate.study.study import Study

STUDY = """\
study: demo
solver: {name: borehole}
parameters:
  rw: [0.05, 0.15]
constants: {Tl: 90}
designs:
  train: {method: sobol, runs: 8}
surrogates:
  linear: {method: linear}
sensitivity: {method: sobol, groups: {g: [rw]}}
execution: {workers: 2}
"""

KEYS = {"~": "null", "1.5": "1.5", ".nan": "nan", "true": "true", "7": "7"}
PLACES = {
    "the study": ("designs:", "{key}: 1\ndesigns:", "6:1"),
    "solver": ("{name: borehole}", "{{{key}: 1, name: borehole}}", "2:10"),
    "options": ("{name: borehole}", "{{name: borehole, options: {{{key}: 1}}}}", "2:36"),
    "parameters": ("  rw:", "  {key}: [0, 1]\n  rw:", "4:3"),
    "a parameter": ("rw: [0.05, 0.15]", "rw: {{{key}: 1, range: [0.05, 0.15]}}", "4:8"),
    "constants": ("{Tl: 90}", "{{{key}: 3, Tl: 90}}", "5:13"),
    "designs": ("  train:", "  {key}: {{method: sobol, runs: 8}}\n  train:", "7:3"),
    "a design": ("{method: sobol, runs", "{{{key}: 1, method: sobol, runs", "7:11"),
    "surrogates": ("  linear:", "  {key}: linear\n  linear:", "9:3"),
    "groups": ("groups: {g:", "groups: {{{key}: [rw], g:", "10:39"),
    "execution": ("workers: 2", "{key}: 2", "11:13"),
}


@pytest.mark.parametrize("key", KEYS)
@pytest.mark.parametrize("section", PLACES)
def test_a_key_that_is_no_text_is_one_sentence_at_its_place(section, key):
    before, after, place = PLACES[section]
    with pytest.raises(StudyError) as caught:
        Study.from_text(STUDY.replace(before, after.format(key=key), 1), "demo.yaml")
    assert caught.value.mistakes == (
        f"demo.yaml:{place}: key {KEYS[key]} must be a text: write a name, or put it in quotes",
    )


@pytest.mark.parametrize("key", [None, 1.5, float("nan"), True, ("a", 1)])
def test_the_same_from_python(key):
    data = {"study": "demo", "solver": "borehole", "parameters": {key: [0, 1], "rw": [0.05, 0.1]}}
    with pytest.raises(StudyError, match="must be a text") as caught:
        Study.from_mapping({**data, "designs": {"train": {"method": "sobol", "runs": 8}}})
    assert len(caught.value.mistakes) == 1
