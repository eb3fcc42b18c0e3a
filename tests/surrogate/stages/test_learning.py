"""`learning:` from the study file to learning.nc, summary.json, terminal and report."""

import json

import numpy as np
import pytest
import xarray as xr

from surrogate.cli import findings, results
from surrogate.errors import StudyError
from surrogate.fitting.forecast import Goal
from surrogate.study.study import Study

STUDY = """\
study: demo
solver: borehole
parameters: {rw: [0.05, 0.15], Hu: [990, 1110], L: [1120, 1680]}
designs:
  train: {method: latin_hypercube, runs: 30, seed: 1}
  test: {method: latin_hypercube, runs: 15, seed: 2}
surrogates: {linear: linear, quadratic: quadratic, gp: gaussian_process}
sensitivity: sobol
"""


def study(learning):
    return Study.from_text(f"{STUDY}learning: {learning}\n")


@pytest.fixture(scope="module")
def outcome(tmp_path_factory):
    folder = tmp_path_factory.mktemp("learning") / "demo"
    asked = study("{until: {rmse: 500 dm^3/year}, subsets: 6}")
    runs = asked.run(results=folder, workers=1)
    return asked, folder, results.analyse(asked, folder, runs, workers=1)


def test_the_dataset_has_what_the_documentation_says(outcome):
    _, folder, _ = outcome
    table = xr.load_dataset(folder / "learning.nc")
    assert table["rmse"].dims == ("surrogate", "output", "size")
    assert table["surrogate"].values.tolist() == ["linear", "quadratic", "gp"]
    assert table["goal"].values.tolist() == ["RMSE 0.5"]
    gp = table.sel(surrogate="gp", output="flow")
    known = np.isfinite(gp["runs"].values)
    assert gp["runs"].values[known][-1] == int(gp["training_runs"]) == 30
    low, middle, high = (gp["rmse" + end].values[known] for end in ("_low", "", "_high"))
    assert (low <= middle).all() and (middle <= high).all()
    assert "width" not in table
    assert float(gp["rmse_ahead"][-1]) == pytest.approx(float(gp["rmse_doubled"]))


def test_summary_terminal_and_report_tell_the_same(outcome):
    asked, folder, done = outcome
    found = json.loads((folder / "summary.json").read_text())["learning"]
    said = str(xr.load_dataset(folder / "learning.nc")["sentence"].sel(surrogate="gp").item())
    assert found["sentence"]["values"][2][0] == said
    lines = findings.page(asked, done).parts
    page = (folder / "report.html").read_text()
    for sentence in said.splitlines():
        assert f"flow: {sentence}" in lines
        assert sentence[1:].replace("Q2", "Q²").replace("m^3", "m³") in page
    assert "How many runs are enough" in page and "Learning curve of gp for flow" in page


def test_a_width_of_the_indices_is_a_goal(tmp_path):
    asked = study("{until: {index_width: 0.0001}, subsets: 5, surrogate: quadratic}")
    asked = asked.with_surrogates(["quadratic"])
    runs = asked.run(results=tmp_path / "demo", workers=1)
    results.analyse(asked, tmp_path / "demo", runs, workers=1)
    table = xr.load_dataset(tmp_path / "demo" / "learning.nc").isel(surrogate=0, output=0)
    widths = table["width"].values[np.isfinite(table["width"].values)]
    assert len(widths) >= 3 and (widths > 0.0).all() and widths[-1] < widths[0]
    assert "index width 0.0001 of quadratic" in str(table["sentence"].item())


def test_a_polynomial_beside_the_best_one_may_lack_a_curve(tmp_path):
    """11 runs are too few for subsets of a quadratic surrogate of 10 terms; that is no failure."""
    text = STUDY.replace("runs: 30", "runs: 11")
    asked = Study.from_text(f"{text}learning: {{subsets: 5}}\n")
    runs = asked.run(results=tmp_path / "demo", workers=1)
    done = results.analyse(asked, tmp_path / "demo", runs, workers=1)
    assert done.summary["learning"]["surrogate"]["values"] == ["linear", "gp"]
    assert not done.trouble


def test_a_study_without_the_word_has_no_curve(tmp_path):
    asked = Study.from_text(STUDY)
    runs = asked.run(results=tmp_path / "demo", workers=1)
    done = results.analyse(asked, tmp_path / "demo", runs, workers=1)
    assert done.summary["learning"] is None
    assert not (tmp_path / "demo" / "learning.nc").exists()


def test_goals_are_those_of_the_words():
    assert Study.from_text(STUDY).learning_rule is None
    assert study("").learning_rule.until == {}
    assert study("{until: {q2: 0.99}}").learning_rule.until == {"flow": Goal("q2", 0.99)}
    goal = study("{until: {rmse: 500 dm^3/year}}").learning_rule.until["flow"]
    assert goal.value == pytest.approx(0.5)


@pytest.mark.parametrize(
    "words, said",
    [
        ("{until: {q2: 1.2}}", "must be below 1"),
        ("{until: {q2: 0.9, rmse: 3}}", "give one of q2, rmse and index_width"),
        ("{until: {}}", "give one of q2, rmse and index_width"),
        ("{until: {q3: 0.9}}", "key 'q3' is unknown; Allowed: index_width, q2, rmse"),
        ("{until: {rmse: 3 mm}}", "rmse 3 mm suits no output: unit 'mm' does not convert"),
        ("{until: {rmse: -1}}", "rmse -1.0 must be above 0"),
        ("{until: {rmse: much}}", "rmse 'much' is not a number"),
        ("{surrogate: gpp}", "surrogate 'gpp' is unknown; did you mean 'gp'"),
        ("{outputs: [flo]}", "the study has no output 'flo'; did you mean 'flow'"),
        ("{subsets: 2}", "must be at least 5"),
    ],
)
def test_mistakes_are_told_at_their_place(words, said):
    with pytest.raises(StudyError, match="study.yaml:9:") as caught:
        study(words)
    assert said in str(caught.value)


def test_a_width_needs_indices():
    text = STUDY.replace("sensitivity: sobol\n", "")
    with pytest.raises(StudyError, match="index_width is that of total indices"):
        Study.from_text(f"{text}learning: {{until: {{index_width: 0.1}}}}\n")


EXACT = """\
from surrogate.solver import Input, Output


class Exact:
    version = "1"
    inputs = {"x": Input(nominal=0.0, range=(-1.0, 1.0))}
    outputs = {"y": Output(), "nothing": Output()}

    def __call__(self, x):
        return {"y": x, "nothing": 0.0 * x}
"""


def test_errors_of_zero_are_no_failure(tmp_path):
    (tmp_path / "exact_line.py").write_text(EXACT)
    (tmp_path / "demo.yaml").write_text(
        "study: demo\nsolver: exact_line:Exact\nparameters: {x: [-1, 1]}\n"
        "designs: {train: {method: sobol, runs: 16}}\nsurrogates: {linear: linear}\n"
        "learning: {until: {rmse: 0.1}, subsets: 5}\n"
    )
    asked = Study.from_yaml(tmp_path / "demo.yaml")
    runs = asked.run(results=tmp_path / "demo", workers=1)
    done = results.analyse(asked, tmp_path / "demo", runs, workers=1)
    said = [words for row in done.summary["learning"]["sentence"]["values"] for words in row]
    assert all("linear is exact to rounding" in words for words in said)
    page = (tmp_path / "demo" / "report.html").read_text()
    assert "nan" not in page.split('id="learning"')[1].split("</section>")[0]
