"""What lies in a study's folder: that which the study asks for now, and nothing of before."""

import os
import re
from concurrent.futures import ThreadPoolExecutor

import pytest

from surrogate.cli import results
from surrogate.errors import ResultsError, SolverError
from surrogate.solver import Input, Output
from surrogate.study.study import Study

STUDY = {
    "study": "kept",
    "solver": "borehole",
    "parameters": {"rw": [0.05, 0.15], "L": [1120, 1680]},
    "designs": {"train": {"method": "latin_hypercube", "runs": 12, "seed": 1}},
    "surrogates": {"linear": "linear", "forest": "sklearn.ensemble:RandomForestRegressor"},
    "sensitivity": {"method": "sobol", "surrogate": "linear"},
    "screening": {"freeze_below": 0.2},
}
FIRST = {
    "designs",
    "report.html",
    "runs.nc",
    "comparison.nc",
    "summary.json",
    "study.yaml",
    "journal",
    "kept",
}


class Hopeless:
    """Never has an answer."""

    version = "1"
    inputs = {"a": Input(range=(0, 1)), "b": Input(range=(0, 1))}
    outputs = {"y": Output()}

    def __call__(self, a, b):
        raise SolverError("buckles")


def broken(fit, space, *, confidence=0.95):
    """A sensitivity method that fails."""
    raise RuntimeError("not today")


def run(study, folder):
    with ThreadPoolExecutor(1) as executor:
        study.run(results=folder, executor=executor)
    return results.analyse(study, folder)


def without(*words, **changes):
    return Study.from_mapping(
        {**{word: part for word, part in STUDY.items() if word not in words}, **changes}
    )


def test_files_of_an_earlier_form_of_the_study_go(tmp_path):
    """Indices, tables and surrogates that the study no longer asks for are not left behind."""
    done = run(Study.from_mapping(STUDY), tmp_path)
    assert done.summary["screening"]["freeze"] == ["L"]
    assert set(os.listdir(tmp_path)) == FIRST | {
        "regression.nc",
        "sensitivity.nc",
        "surrogates",
        "study_reduced.yaml",
    }
    assert os.listdir(tmp_path / "surrogates") == ["linear.json"]
    run(without("sensitivity", "screening", surrogates={"gp": "gaussian_process"}), tmp_path)
    assert set(os.listdir(tmp_path)) == FIRST | {"surrogates"}
    assert os.listdir(tmp_path / "surrogates") == ["gp.json"]


def test_a_study_without_an_answer_has_a_report(tmp_path):
    """Every run failed: the report says so, with the reason; there is nothing to predict with."""
    study = without(solver=f"{__name__}:Hopeless", parameters={"a": [0, 1], "b": [0, 1]})
    done = run(study, tmp_path)
    assert "of 12 runs: 12 failed" in done.trouble and "but 'y' has 0" in done.trouble
    assert "buckles" in done.report.read_text(encoding="utf-8")
    (tmp_path / "cases.csv").write_text("a,b,y\n0.5,0.5,1\n")
    with pytest.raises(ResultsError, match="no surrogate or model .*\n.*but 'y' has 0"):
        results.validate(study, tmp_path, tmp_path / "cases.csv")


def test_cases_beside_nothing(tmp_path):
    """Before any run, and where no case is inside: each has a sentence of its own."""
    study = without("sensitivity", "screening", surrogates={"linear": "linear"})
    cases = tmp_path / "cases.v1.csv"
    cases.write_text("rw,L,flow\n0.1,1400,70\n")
    with pytest.raises(ResultsError, match="holds no runs of this study; do `surrogate run`"):
        results.validate(study, tmp_path / "kept", cases)
    run(study, tmp_path / "kept")
    assert results.validate(study, tmp_path / "kept", cases)[1].name == "validation_cases.v1.html"
    cases.write_text("rw,L,flow\n0.3,1400,70\n")
    with pytest.raises(ResultsError, match="every case lies outside .*: rw 0.3 m"):
        results.validate(study, tmp_path / "kept", cases)


@pytest.mark.parametrize(
    "method, words",
    [
        ("dgsm", "surrogate forest has no derivative"),
        (f"{__name__}:broken", "'flow': .*not today"),
    ],
)
def test_a_report_without_the_indices_that_could_not_be_had(tmp_path, method, words):
    """A method that does not suit the surrogate, or fails, costs its own section only."""
    study = without("screening", sensitivity={"method": method, "surrogate": "forest"})
    done = run(study, tmp_path)
    assert re.search(f"no sensitivity indices: .*{words}", done.trouble)
    assert done.report.is_file() and not (tmp_path / "sensitivity.nc").exists()


def test_a_damaged_summary_is_made_again(tmp_path):
    study = without("sensitivity", "screening", surrogates={"linear": "linear"})
    before = run(study, tmp_path).summary
    for text in ("[1]", '{"stamp"', ""):
        (tmp_path / "summary.json").write_text(text)
        again = results.analyse(study, tmp_path)
        assert again.fresh and again.summary["stamp"] == before["stamp"]
    assert not results.analyse(study, tmp_path).fresh
