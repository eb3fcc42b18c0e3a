"""`reliability:` from the study file to results, and every mistake at its place."""

import json
import math

import pytest
import xarray as xr

from surrogate.cli import findings, results
from surrogate.errors import StudyError
from surrogate.reliability.problem import Failure
from surrogate.study.study import Study

SOUND = """\
study: demo
solver: {name: borehole}
parameters:
  rw: [0.05, 0.15]
  L: {range: [1120, 1680], unit: m}
designs:
  train: {method: latin_hypercube, runs: 16, seed: 1}
surrogates: {gp: {method: gaussian_process}}
reliability:
"""


def study(*lines):
    return Study.from_text(SOUND + "".join(f"  {line}\n" for line in lines))


def test_a_limit_may_carry_a_unit_and_stand_on_either_side():
    found = study("flood: {output: flow, above: 1.5e5 dm^3/yr}", "dry: {output: flow, below: 20}")
    assert found.limits == {
        "flood": Failure("flood", "flow", pytest.approx(150.0), 1, "m^3/year"),
        "dry": Failure("dry", "flow", 20.0, -1, "m^3/year"),
    }


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("one: {output: flow}", "give either above or below"),
        ("one: {output: flow, above: 1, below: 0}", "give either above or below"),
        ("one: {output: flaw, above: 1}", "the study has no output 'flaw'; did you mean 'flow'?"),
        ("one: {output: flow, above: 1 kg}", "kg"),
        ("one: {output: flow, above: 1, surrogate: gb}", "surrogate 'gb' is unknown"),
        ("one: {output: flow, above: 1, method: sorm}", "method 'sorm' is unknown"),
        ("one: {output: flow, abov: 1}", "key 'abov' is unknown"),
    ],
)
def test_mistakes(line, said):
    with pytest.raises(StudyError) as told:
        study(line)
    assert said.lower() in str(told.value).lower()


def test_results_tell_the_probability_and_its_parts(tmp_path):
    text = SOUND + "  flood: {output: flow, above: 140}\n"
    asked = Study.from_text(text)
    runs = asked.run(results=tmp_path, workers=1)
    done = results.analyse(asked, tmp_path, runs, workers=1)
    figures = json.loads((tmp_path / "summary.json").read_text())["reliability"]["flood"]
    assert 0.0 < figures["low"] <= figures["probability"] <= figures["high"] < 1.0
    assert figures["form"]["inputs"]["rw"] > 0.1
    assert sum(figures["form"]["factors"].values()) == pytest.approx(1.0)
    one = xr.open_datatree(tmp_path / "reliability.nc")["flood"].dataset
    assert float(one["probability"]) == figures["probability"]
    page = (tmp_path / "report.html").read_text()
    assert "How probable failures are" in page
    assert str(findings.page(asked, done)).count("flood: probability of flow above 140") == 1
    assert math.isfinite(figures["reliability_index"])
