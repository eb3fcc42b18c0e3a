"""Mistakes in a study file: each found before the first run, all at once, with its place."""

import re
from pathlib import Path

import pytest

from surrogate.errors import StudyError
from surrogate.study.study import Study

SOUND = """\
study: demo
solver: {name: borehole}
parameters:
  rw: [0.05, 0.15]
  L: {range: [1120, 1680], unit: m}
  Kw: {range: [9855, 12045], unit: m/yr}
constants: {Tl: 90}
outputs: [flow]
designs:
  train: {method: latin_hypercube, runs: 20, seed: 1}
  test: {method: sobol, runs: 8, seed: 2}
surrogates:
  linear: {method: linear}
  forest: {method: "sklearn.ensemble:RandomForestRegressor", options: {n_estimators: 10}}
sensitivity: {method: sobol, surrogate: best, confidence: 0.95}
screening: {freeze_below: 0.02}
execution: {workers: 2, timeout: 30 min, retries: 1}
"""

#: what is changed, into what, and where (line, column) and what the sentence must say
MISTAKES = {
    "misspelt key": ("screening:", "screning:", "16:1", "did you mean 'screening'"),
    "misspelt solver": ("name: borehole", "name: boreole", "2:16", "did you mean 'borehole'"),
    "unknown parameter": ("  rw:", "  rv:", "4:3", "no input 'rv'; did you mean"),
    "upside down": ("[0.05, 0.15]", "[0.15, 0.05]", "4:7", "upside down"),
    "outside the solver": ("[0.05, 0.15]", "[0.05, 15]", "4:7", "15 m is above .*0.15 m"),
    "one number": ("[0.05, 0.15]", "[0.05]", "4:7", "2 entries"),
    "not a number": ("[0.05, 0.15]", "[0.05, wide]", "4:14", "must be a number"),
    "wrong unit": ("unit: m}", "unit: kg}", "5:6", "'kg' does not convert to 'm'"),
    "unknown unit": ("unit: m/yr", "unit: m/yaer", "6:7", "'m/yaer' is unknown"),
    "unknown distribution": (
        "rw: [0.05, 0.15]",
        "rw: {distribution: gaussian}",
        "4:7",
        "'gaussian' is unknown",
    ),
    "distribution word": (
        "rw: [0.05, 0.15]",
        "rw: {distribution: normal, mean: 0.1, range: [0.05, 0.15]}",
        "4:7",
        "needs 'std'",
    ),
    "open distribution": (
        "rw: [0.05, 0.15]",
        "rw: {distribution: normal, mean: 0.1, std: 0.1}",
        "4:7",
        "beyond what the solver accepts .* add range",
    ),
    "unknown constant": ("{Tl: 90}", "{Tll: 90}", "7:13", "did you mean 'Tl'"),
    "constant and parameter": ("{Tl: 90}", "{Tl: 90, L: 1200}", "7:21", "also a parameter"),
    "constant too large": ("{Tl: 90}", "{Tl: 900}", "7:17", "above the largest"),
    "unknown output": ("[flow]", "[flwo]", "8:11", "did you mean 'flow'"),
    "misspelt design": (
        "method: latin_hypercube",
        "method: latin_hypercub",
        "10:19",
        "did you mean 'latin_hypercube'",
    ),
    "misspelt method": (
        "{method: sobol, runs",
        "{metod: sobol, runs",
        "11:3",
        "'method' is needed here; is 'metod' meant to be 'method'",
    ),
    "design option": (
        "{method: sobol, runs: 8",
        "{method: sobol, rns: 8",
        "11:25",
        "did you mean 'runs'",
    ),
    "missing option": ("{method: sobol, runs: 8, ", "{method: sobol, ", "11:3", "'runs' is needed"),
    "option of wrong type": ("runs: 20", "runs: some", "10:42", "'some' is not accepted"),
    "too few runs": ("runs: 20", "runs: 3", "13:3", "4 coefficients .* 3 different points"),
    "unknown regressor": ("{method: linear}", "{method: liner}", "13:20", "did you mean 'linear'"),
    "unknown class": ("RandomForestRegressor", "RandomForest", "14:20", "does not load"),
    "regressor option": (
        "n_estimators: 10",
        "n_estimator: 10",
        "14:72",
        "did you mean 'n_estimators'",
    ),
    "unknown train": (
        "{method: linear}",
        "{method: linear, train: trian}",
        "13:35",
        "did you mean 'train'",
    ),
    "learns from nothing": (
        "{method: linear}",
        "{method: linear, train: []}",
        "13:35",
        "at least 1 entry",
    ),
    "learns what it is judged by": (
        "{method: linear}",
        "{method: linear, train: [train, test]}",
        "13:35",
        "'test' is held out to test",
    ),
    "seed that is none": ("seed: 1", "seed: null", "10:52", "'seed' is empty: give a whole number"),
    "unit of a text": (
        "{Tl: 90}",
        "{Tl: {value: '90', unit: dm^2/year}}",
        "7:17",
        "below the smallest",
    ),
    "unknown surrogate": ("surrogate: best", "surrogate: lienar", "15:41", "did you mean 'linear'"),
    "unknown sensitivity": (
        "sensitivity: {method: sobol",
        "sensitivity: {method: sobl",
        "15:23",
        "did you mean 'sobol'",
    ),
    "parameter in no study": (
        "confidence: 0.95}",
        "groups: {g: [rw, K]}}",
        "15:64",
        "'K' is not a parameter of this study; did you mean 'Kw'",
    ),
    "parameter in two groups": (
        "confidence: 0.95}",
        "groups: {g: [rw], h: [L, rw]}}",
        "15:72",
        "'rw' is already in group 'g'",
    ),
    "empty group": ("confidence: 0.95}", "groups: {g: []}}", "15:56", "group 'g' is empty"),
    "group of no list": ("confidence: 0.95}", "groups: {g: rw}}", "15:59", "must be a list"),
    "method without groups": (
        "{method: sobol, surrogate: best, confidence: 0.95}\nscreening: {freeze_below: 0.02}",
        "{method: morris, groups: {g: [rw]}}",
        "15:31",
        "morris knows no groups",
    ),
    "output without a vote": (
        "freeze_below: 0.02",
        "outputs: [flwo]",
        "16:23",
        "did you mean 'flow'",
    ),
    "share above one": ("freeze_below: 0.02", "freeze_below: 2", "16:27", "below 1"),
    "duration": ("30 min", "30 mns", "17:34", "write '30 s'"),
    "no worker": ("workers: 2", "workers: 0", "17:22", "at least 1"),
    "no such cases": (
        "outputs:",
        "validation: {cases: legs.csv}\noutputs:",
        "8:21",
        "legs.csv cannot be read .* relative to the study file",
    ),
    "cases of no kind": (
        "outputs:",
        "validation: legs.doc\noutputs:",
        "8:13",
        "must be a table .* or a study",
    ),
    "validation key": (
        "outputs:",
        "validation: {casses: x, cases: CASES.csv}\noutputs:",
        "8:14",
        "did you mean 'cases'",
    ),
    "no such subject": (
        "outputs:",
        "validation: {subject: lag, cases: CASES.csv}\noutputs:",
        "8:23",
        "no column 'lag'",
    ),
    "validated output": (
        "outputs:",
        "validation: {output: flwo, cases: CASES.csv}\noutputs:",
        "8:22",
        "did you mean 'flow'",
    ),
    "unknown model": (
        "outputs:",
        "validation: {models: {a: laplac}, cases: CASES.csv}\noutputs:",
        "8:26",
        "did you mean 'laplace'",
    ),
    "model option": (
        "outputs:",
        "validation: {models: {a: {name: borehole, options: {fine: 1}}}, "
        "cases: CASES.csv}\noutputs:",
        "8:53",
        "option 'fine' is",
    ),
    "model key": (
        "outputs:",
        "validation: {models: {a: {nam: x, name: borehole}}, cases: CASES.csv}\noutputs:",
        "8:27",
        "did you mean 'name'",
    ),
    "model without the output": (
        "outputs:",
        "validation: {models: {a: ishigami}, cases: CASES.csv}\noutputs:",
        "8:26",
        "ishigami has no output flow; it has y",
    ),
    "model called as a surrogate": (
        "outputs:",
        "validation: {models: {linear: borehole}, cases: CASES.csv}\noutputs:",
        "8:23",
        "'linear' is also a surrogate",
    ),
    "stored and not there": (
        "outputs:",
        "stored: runs/demo.nc\noutputs:",
        "8:9",
        "runs/demo.nc does not exist; `surrogate store` writes",
    ),
    "one of the stored": ("outputs:", "stored: [runs/demo.nc]\noutputs:", "8:10", "does not exist"),
    "stored is no file": ("outputs:", "stored: 3\noutputs:", "8:9", "must be a list"),
    "doubled key": ("outputs:", "designs:", "9:1", "stands twice"),
    "tab": ("  rw:", "\trw:", "4:1", "not YAML"),
}


@pytest.fixture(autouse=True)
def cases(tmp_path, monkeypatch):
    """Sound cases in the current folder, for mistakes beside them."""
    monkeypatch.chdir(tmp_path)
    Path("CASES.csv").write_text("rw,L,Kw,flow\n0.1,1200,10000,70\n0.1,1300,10000,60\n")


def mistakes_of(text: str) -> list[str]:
    with pytest.raises(StudyError) as caught:
        Study.from_text(text, "demo.yaml")
    return list(caught.value.mistakes)


def test_the_sound_study_is_sound():
    """What the mistakes are made in has none."""
    study = Study.from_text(SOUND)
    assert study.space.names == ("rw", "L", "Kw")
    assert study.execution.timeout == 1800.0


@pytest.mark.parametrize("before, after, place, words", MISTAKES.values(), ids=MISTAKES)
def test_one_mistake_one_sentence_at_its_place(before, after, place, words):
    """One change, one sentence, with line, column and cure."""
    assert SOUND.count(before) >= 1
    found = mistakes_of(SOUND.replace(before, after, 1))
    assert len(found) == 1, found
    assert re.search(words, found[0]), found[0]
    assert found[0].startswith(f"demo.yaml:{place}: "), found[0]


def test_all_mistakes_at_once():
    """Twelve mistakes in one file give twelve sentences, in the order of the file."""
    chosen = [
        "outside the solver",
        "wrong unit",
        "unknown unit",
        "constant too large",
        "unknown output",
        "misspelt design",
        "design option",
        "unknown regressor",
        "regressor option",
        "unknown sensitivity",
        "misspelt key",
        "duration",
    ]
    text = SOUND
    for name in chosen:
        text = text.replace(*MISTAKES[name][:2], 1)
    found = mistakes_of(text)
    lines = [int(sentence.split(":")[1]) for sentence in found]
    for name in chosen:
        assert any(re.search(MISTAKES[name][3], sentence) for sentence in found), name
    assert lines == sorted(lines)


def test_a_wrong_option_of_the_solver_hides_no_other_mistake():
    """A solver that cannot be built with its options is built without them to check the rest."""
    found = mistakes_of(
        SOUND.replace(
            "{name: borehole}",
            """{name: leg_bandage, options:
  {mesh: corse}}""",
        ).replace("constants: {Tl: 90}\noutputs: [flow]\n", "")
    )
    assert "corse" in found[0] and "no input 'rw'" in found[1], found


@pytest.mark.parametrize("text", ["", "just words", "[1, 2]", "study: x", "study: 3\nsolver: {}"])
def test_hardly_a_study(text):
    """Files that are hardly a study get sentences too."""
    assert mistakes_of(text)


def test_the_same_words_from_python():
    """Mistakes in Python data are placed by the path of words."""
    with pytest.raises(StudyError, match=r"^designs\.train\.rns: option 'rns' is unknown"):
        Study.from_mapping(
            {
                "study": "x",
                "solver": "borehole",
                "parameters": {"rw": [0.05, 0.1]},
                "designs": {"train": {"method": "sobol", "rns": 8, "runs": 4}},
            }
        )


def test_a_constant_in_quotes_keeps_its_unit():
    study = Study.from_text(SOUND.replace("{Tl: 90}", "{Tl: {value: '9000', unit: dm^2/year}}"))
    assert study.constants == {"Tl": pytest.approx(90.0)}


def test_a_csv_that_is_not_there(tmp_path):
    """A design's file is looked for beside the study."""
    path = tmp_path / "demo.yaml"
    path.write_text(
        SOUND.replace("{method: sobol, runs: 8, seed: 2}", "{method: csv, path: points.csv}")
    )
    with pytest.raises(StudyError, match="points.csv"):
        Study.from_yaml(path)
