"""Predictions: which points are understood, and what is said when there is no answer."""

import json
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from sklearn.base import BaseEstimator, RegressorMixin

from surrogate.cli import verbs as cli
from surrogate.errors import FitError, StudyError
from surrogate.study.prediction import predict
from surrogate.study.study import Study


class Never(RegressorMixin, BaseEstimator):
    """Fits nothing."""

    def fit(self, X, y):
        raise RuntimeError("out of ideas")

    def predict(self, X):
        return np.zeros(len(X))


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    """A study whose runs are done, and where they are."""
    study = Study.from_mapping(
        {
            "study": "seen",
            "solver": "borehole",
            "parameters": {"rw": [0.05, 0.15], "L": {"range": [1120, 1680], "unit": "m"}},
            "designs": {"train": {"method": "latin_hypercube", "runs": 9, "seed": 1}},
            "surrogates": {"linear": "linear", "never": f"{__name__}:Never"},
        }
    )
    folder = tmp_path_factory.mktemp("seen")
    with ThreadPoolExecutor(1) as executor:
        study.run(results=folder, executor=executor)
    return study, folder


def at(done, path, text):
    path.write_text(text)
    return predict(*done, "linear", [], path).rows


def test_points_in_a_file_are_those_in_words(done, tmp_path):
    """Units, comments and columns of others in the file change nothing."""
    (row,) = predict(*done, "linear", ["rw=0.1", "L=1.4 km"], None).rows
    rows = at(done, tmp_path / "points.csv", "# lab\nwho, rw, L\nme, 10 cm, 1400\n\nyou,0.3,1400\n")
    assert rows[0] == row and rows[1]["inside"] is False
    assert row["inputs"] == {"rw": 0.1, "L": 1400.0} and row["inside"] is True


@pytest.mark.parametrize(
    "text, words",
    [
        ("rw,L\n0,1,1400\n", "points.csv:2: 3 cells where the first row names 2"),
        ("rw,rw,L\n0.1,0.2,1400\n", "points.csv: column 'rw' stands twice"),
        (
            "rw,L\n\n0.1,x\n,1400\n",
            "points.csv:4: rw: there is no value.*points.csv:3: L: 'x' is not",
        ),
        ("rw,L\n0.1,inf\n", "points.csv:2: L: 'inf' is not a finite number"),
        ("rw,L\nnan,1400\n", "points.csv:2: rw: there is no value"),
        ("rw\n0.1\n", "points.csv: no value for L"),
        ("rw,L\n", "holds no cases"),
    ],
)
def test_points_that_are_not_understood(done, tmp_path, text, words):
    """A decimal comma, a column twice, a gap: each would be another point, so it is a mistake."""
    with pytest.raises(StudyError, match=f"(?s){words}"):
        at(done, tmp_path / "points.csv", text)


@pytest.mark.parametrize(
    "words, sentence",
    [
        (["rw=nan", "L=1400"], "^rw: there is no value"),
        (["rw=0.1", "L=inf"], "^L: 'inf' is not a f"),
        (["rw=0.1"], "^no value for L"),
        (["rw=0.1", "rw=0.2", "L=1"], "'rw' is given twice"),
    ],
)
def test_words_that_are_not_understood(done, words, sentence):
    with pytest.raises(StudyError, match=sentence):
        predict(*done, "linear", words, None)


def test_no_surrogate_no_answer(done):
    """What cannot be fitted predicts nothing, and says why."""
    with pytest.raises(FitError, match="'never' cannot be fitted to 'flow': RuntimeError: out of"):
        predict(*done, "never", ["rw=0.1", "L=1400"], None)
    (row,) = predict(*done, None, ["rw=0.1", "L=1400"], None).rows
    assert row["outputs"]["flow"]["surrogate"] == "linear"


class Blank(Never):
    """Predicts nothing that is a number."""

    def fit(self, X, y):
        return self

    def predict(self, X):
        return np.full(len(X), np.nan)


def test_what_is_no_number_is_null_in_json(tmp_path, capsys, monkeypatch):
    """RFC 8259 has no NaN: scripts in other languages refuse it."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "blank.yaml").write_text(
        "study: blank\nsolver: ishigami\nparameters: {X1: [-1, 1]}\n"
        "designs: {train: {method: latin_hypercube, runs: 4, seed: 1}}\n"
        f"surrogates: {{blank: '{__name__}:Blank'}}\n"
    )
    with ThreadPoolExecutor(1) as executor:
        Study.from_yaml("blank.yaml").run(executor=executor)
    monkeypatch.setattr("sys.argv", ["surrogate", "predict", "blank.yaml", "X1=0", "--json"])
    with pytest.raises(SystemExit) as ended:
        cli.main()
    assert not ended.value.code
    (row,) = json.loads(capsys.readouterr().out, parse_constant=pytest.fail)
    assert row["outputs"]["y"] == {"surrogate": "blank", "value": None, "low": None, "high": None}
