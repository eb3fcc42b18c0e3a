"""Validation: which cases count, what each model says of them, and what is written down."""

import json
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from surrogate.cli import results
from surrogate.errors import StudyError
from surrogate.runs import dataset as rundata
from surrogate.stages.summary import figures_of
from surrogate.study.study import Study
from surrogate.validation.agreement import agreement
from surrogate.validation.cases import read_table

TEXT = """\
study: checked
solver: {name: borehole}
parameters:
  rw: [0.05, 0.15]
  Hu: {range: [990, 1110], unit: m}
  L: {range: [1120, 1680], unit: m}
designs: {train: {method: latin_hypercube, runs: 25, seed: 1}}
surrogates: {linear: {method: linear}, quadratic: {method: quadratic}}
validation: {cases: wells.csv, models: {again: borehole}}
"""

#: Two inside, one of them without a value; one outside by two parameters; one with units.
WELLS = """\
# made up
case,date,rw,Hu,L,flow
north,May,0.10,1000,1200,80
south,May,0.12,1100,1600,
east,June,0.30,1000,1700,90
west,June,8 cm,1.05 km,1400 m,45
"""


def write(place, text=TEXT, wells=WELLS):
    (place / "wells.csv").write_text(wells)
    (place / "study.yaml").write_text(text)
    return Study.from_yaml(place / "study.yaml")


def completed(study, folder):
    return results.analyse(study, folder, results.do_runs(study, folder, workers=1))


def fitted(study, place):
    with ThreadPoolExecutor(1) as executor:
        return study.fit(study.run(results=place / "results/checked", executor=executor))


def test_cases_are_read_set_aside_and_predicted(tmp_path):
    """Units, gaps and labels of a CSV file; a case outside is named and counted nowhere."""
    study = write(tmp_path)
    fits = fitted(study, tmp_path)
    table = study.validate(fits)
    assert table["case"].values.tolist() == ["north", "south", "east", "west"]
    assert table["model"].values.tolist() == ["linear", "quadratic", "again"]
    assert table["inside"].values.tolist() == [True, True, False, True]
    assert table["outside"].values[2] == "rw 0.3 m (0.05 to 0.15); L 1700 m (1120 to 1680)"
    np.testing.assert_array_equal(table["reference"].sel(output="flow"), [80, np.nan, 90, 45])
    np.testing.assert_allclose(table["at_rw"], [0.10, 0.12, 0.30, 0.08])
    np.testing.assert_allclose(table["at_Hu"], [1000, 1100, 1000, 1050])
    said = table["prediction"].sel(output="flow")
    assert np.isnan(said.isel(case=2)).all() and np.isfinite(said.isel(case=[0, 1, 3])).all()
    coded = study.space.encode({"rw": [0.10, 0.08], "Hu": [1000, 1050], "L": [1200, 1400.0]})
    one = fits["quadratic"]["flow"]
    np.testing.assert_allclose(said.sel(model="quadratic").isel(case=[0, 3]), one.predict(coded))
    low, high = one.interval(coded)
    np.testing.assert_allclose(table["low"].sel(model="quadratic", output="flow")[[0, 3]], low)
    exact = study.spec.solver(
        **{name: i.nominal for name, i in study.spec.solver.inputs.items() if i.nominal is not None}
        | {"rw": 0.1, "Hu": 1000, "L": 1200}
    )
    assert said.sel(model="again")[0] == pytest.approx(exact["flow"])
    assert (table["n"] == 2).all()
    for key, value in agreement([80, 45], said.sel(model="quadratic")[[0, 3]]).items():
        found = float(table[key].sel(model="quadratic", output="flow"))
        assert found == pytest.approx(value, nan_ok=True), key
    held = np.mean((low <= [80, 45]) & (np.array([80, 45]) <= high))
    assert float(table["coverage_95"].sel(model="quadratic", output="flow")) == held
    assert np.isnan(table["coverage_95"].sel(model="again"))


def test_another_study_gives_the_cases(tmp_path):
    """Runs of a better solver: run first, beside; constants are columns, units are converted."""
    (tmp_path / "better.yaml").write_text(
        TEXT.replace("study: checked", "study: better")
        .replace("designs:", "constants: {Tl: 100}\ndesigns:")
        .replace("runs: 25, seed: 1", "runs: 12, seed: 5")
    )
    study = write(tmp_path, TEXT.replace("wells.csv", "better.yaml"))
    folder = tmp_path / "results/checked"
    first = completed(study, folder)
    assert not first.trouble
    assert (tmp_path / "results/better/journal/runs.jsonl").exists()
    table = rundata.load(folder / "validation.nc")
    assert table.sizes["case"] == 12 and table.attrs["cases"] == "better"
    # the formula is called with the cases' Tl and is right; the surrogate knows the nominal only
    assert float(table["rmse"].sel(model="again", output="flow")) < 1e-9
    assert "the cases have Tl 100 m^2/year; the study fixes it at 89.55" in table.attrs["notes"]
    assert first.summary["validation"]["n"]["values"] == [[12.0]] * 3
    page = first.report.read_text()
    assert "Validation" in page and "12 cases from better" in page and "lower limit" in page
    assert not completed(study, folder).fresh


def test_levels_that_the_study_fixes_are_told(tmp_path):
    """A choice that the study fixes and the cases vary is as much a difference as a number."""
    study = Study.from_mapping(
        {
            "study": "fixed",
            "solver": "misbehaving:Misbehaving",
            "parameters": {"x": [0, 2]},
            "outputs": ["square"],
            "designs": {"train": {"method": "sobol", "runs": 4}},
        }
    )
    path = tmp_path / "cases.csv"
    for cell, words in (
        ("raise", "the cases have way raise; the study fixes it at well, so"),
        ("well", ""),
        ("", ""),
    ):
        path.write_text(f"x,way,square\n1,{cell},1\n1.5,well,2\n")
        assert study.validate({}, path).attrs["notes"].startswith(words)
        assert bool(study.validate({}, path).attrs["notes"]) == bool(words)


def test_a_report_before_the_other_study_has_runs(tmp_path):
    """Without runs of the study that gives the cases, the report is made and says so."""
    (tmp_path / "better.yaml").write_text(TEXT.replace("study: checked", "study: better"))
    study = write(tmp_path, TEXT.replace("wells.csv", "better.yaml"))
    fitted(study, tmp_path)
    done = results.analyse(study, tmp_path / "results/checked")
    assert "validation: cases 'better': there is no finished run" in done.trouble


def test_cases_from_a_runs_dataset_and_from_a_file_given_later(tmp_path):
    """A runs.nc as cases; other cases get files of their own beside the study's."""
    study = write(tmp_path)
    runs = study.stored(tmp_path / "results/checked")
    fitted(study, tmp_path)
    folder = tmp_path / "results/checked"
    runs = study.stored(folder)
    rundata.save(runs, tmp_path / "seen.nc")
    table, page = results.validate(study, folder, tmp_path / "seen.nc")
    assert table.sizes["case"] == 25
    assert float(table["r2"].sel(model="again", output="flow")) == pytest.approx(1.0)
    assert page == folder / "validation_seen.html" and (folder / "validation_seen.nc").exists()
    assert study.validate(study.fit(runs), runs).sizes["case"] == 25
    results.validate(study, folder)
    assert (folder / "validation.html").exists()
    json.dumps(figures_of(table), allow_nan=False)


def test_units_of_a_model_with_other_units(tmp_path):
    """Columns, constants and answers are converted to and from each model's own units."""
    (tmp_path / "metric.py").write_text("""\
from surrogate.solver import Input, Output

class Scaled:
    version = "1"
    inputs = {"rw": Input(unit="mm", nominal=100.0), "Tl": Input(unit="mm^2/yr", nominal=1.0)}
    outputs = {"flow": Output(unit="l/yr")}
    def __call__(self, rw, Tl):
        return {"flow": 1000.0 * (rw + 1e-6 * Tl)}
""")
    study = write(
        tmp_path,
        TEXT.replace("again: borehole", "other: 'metric:Scaled'").replace(
            "designs:", "constants: {Tl: 90}\ndesigns:"
        ),
    )
    table = study.validate({}).sel(model="other", output="flow")
    np.testing.assert_allclose(table["prediction"][[0, 1, 3]], [190.0, 210.0, 170.0])


def test_a_model_without_an_answer_costs_its_case(tmp_path):
    """A model that fails at a case is compared at the others, and the page says so."""
    (tmp_path / "fragile.py").write_text("""\
from surrogate.errors import SolverError
from surrogate.solver import Input, Output

class Fragile:
    version = "1"
    inputs = {"rw": Input(unit="m", nominal=0.1)}
    outputs = {"flow": Output(unit="m^3/yr")}
    def __call__(self, rw):
        if rw == 0.1:
            raise SolverError("too round")
        return {"flow": 1.0}
""")
    study = write(tmp_path, TEXT.replace("again: borehole", "poor: 'fragile:Fragile'"))
    table = study.validate({})
    assert table["n"].values.tolist() == [[1.0]]
    assert "poor: no answer for case north (too round)" in table.attrs["notes"]


def test_a_model_answers_in_its_unit_or_not_at_all(tmp_path):
    """A masked value or a text is no answer; the other cases stand."""
    (tmp_path / "careless.py").write_text("""
import numpy as np
from surrogate.solver import Input, Output
class Careless:
    version = "1"
    inputs = {"rw": Input(unit="m", nominal=0.1)}
    outputs = {"flow": Output(unit="m^3/yr")}
    def __call__(self, rw):
        return {"flow": np.ma.masked_array(1e20, True) if rw == 0.1 else 1.0}
""")
    study = write(tmp_path, TEXT.replace("again: borehole", "poor: 'careless:Careless'"))
    table = study.validate({})
    assert table["n"].values.tolist() == [[1.0]]
    assert "north (output 'flow' is masked in 1 of 1 places)" in table.attrs["notes"]


@pytest.mark.parametrize("column, said", [("subject", ""), ("who", "subject: who, ")])
def test_several_cases_a_subject(tmp_path, column, said):
    """A column that tells the subject: both parts of the scatter, as `agreement` has them."""
    wells = f"{column},rw,Hu,L,flow\nA,0.1,1000,1200,80\nA,0.1,1000,1300,70\nB,0.1,1050,1400,90\n"
    study = write(
        tmp_path, text=TEXT.replace("validation: {", f"validation: {{{said}"), wells=wells
    )
    fitted(study, tmp_path)
    folder = tmp_path / "results/checked"
    table, page = results.validate(study, folder)
    found = table.sel(model="again", output="flow")
    expected = agreement(found["reference"], found["prediction"], list("AAB"))
    assert float(found["sd_between"]) == pytest.approx(expected["sd_between"])
    assert float(found["upper_limit_high"]) == pytest.approx(expected["upper_limit_high"])
    assert "They come from 2 subjects" in page.read_text()


WRONG = {
    "cell": ("0.12,", "wide,", r"wells.csv:4: rw: 'wide' is not a number"),
    "empty cell": ("0.12,", ",", r"wells.csv:4: rw: there is no value"),
    "unit": ("8 cm", "8 kg", r"wells.csv:6: rw: unit 'kg' does not convert"),
    "missing column": (
        "case,date,rw",
        "case,date,rww",
        r"no column for parameter 'rw'; did you "
        "mean 'rww'",
    ),
    "no output": (",flow", ",flux", "no column for any scalar output of the study: flow"),
    "short row": ("80\n", "\n", None),
    "long row": ("80\n", "80,1\n", "wells.csv:3: 7 cells where the first row names 6"),
    "twice": ("date,rw", "rw,rw", "wells.csv: column 'rw' stands twice"),
    "nothing": (WELLS, "rw,Hu,L,flow\n", "holds no cases"),
}


@pytest.mark.parametrize("before, after, words", WRONG.values(), ids=WRONG)
def test_wrong_cases_are_mistakes_of_the_study(tmp_path, before, after, words):
    """What is wrong in a CSV file is found when the study is read, with both places."""
    wells = WELLS.replace(before, after)
    if words is None:  # an output without a value is a gap, not a mistake
        write(tmp_path, wells=wells)
        return
    with pytest.raises(StudyError, match=words) as caught:
        write(tmp_path, wells=wells)
    assert all(s.startswith(f"{tmp_path / 'study.yaml'}:9:21: ") for s in caught.value.mistakes)


def test_the_other_study_has_mistakes_or_this_ones_name(tmp_path):
    """Mistakes of the study that gives the cases come with its places; names must differ."""
    (tmp_path / "better.yaml").write_text(TEXT.replace("borehole", "boreole", 1))
    with pytest.raises(StudyError, match=r"study.yaml:9:21: .*better.yaml:2:16: .*'borehole'"):
        write(tmp_path, TEXT.replace("wells.csv", "better.yaml"))
    (tmp_path / "better.yaml").write_text(TEXT)
    with pytest.raises(StudyError, match="study 'checked' has the name of this one"):
        write(tmp_path, TEXT.replace("wells.csv", "better.yaml"))


def test_validate_needs_cases(tmp_path):
    """No cases in the study and none given: a sentence."""
    study = write(tmp_path, TEXT.replace("validation:", "# validation:"))
    with pytest.raises(StudyError, match="no validation: and no cases are given"):
        results.validate(study, tmp_path / "results/checked")
    assert study.validate({}) is None


@pytest.mark.parametrize(
    "text",
    [
        "case,rw,load,who\none,0.1,98,anna\ntwo,0.25,1500.5,7\n",
        "\ufeffcase;rw;load;who\none;0,1;98;anna\ntwo;0,25;1500,5;7\n",
        "# lab\ncase;rw;load [N];who\none;10 cm;98;anna\ntwo;25 cm;1.500,5;7\n",
        "case\trw (cm)\tload\twho\none\t10\t98\tanna\ntwo\t25\t1500.5\t7\n",
        "case,rw,load,who\n,cm,kN,\none,10,0.098,anna\ntwo,25,1.5005,7\n",
        'case;rw;load;who\n"one";"0,1 m";"0,098 kN";anna\ntwo;"0,25 m";"1,5005 kN";7\n',
    ],
    ids=["points", "commas", "thousands", "tabs", "row of units", "commas and units"],
)
def test_cases_as_laboratories_write_them(tmp_path, text):
    """Semicolons, decimal commas, a byte order mark, units in headers, below them or in cells."""
    path = tmp_path / "cases.csv"
    path.write_text(text, encoding="utf-8")
    found = read_table(path)
    assert found.labels == ("one", "two")
    np.testing.assert_allclose(found.numbers("rw", "m"), [0.1, 0.25], rtol=1e-14)
    np.testing.assert_allclose(found.numbers("load", "N"), [98.0, 1500.5], rtol=1e-14)
    assert found.words("who").tolist() == ["anna", "7"]


def test_a_comma_that_may_be_either_mark_is_a_mistake(tmp_path):
    """1,234 between semicolons is 1.234 or 1234: nobody guesses."""
    (tmp_path / "cases.csv").write_text("rw;flow\n1,234;5,678\n")
    with pytest.raises(StudyError, match="column 'rw': its numbers can be read with a decimal"):
        read_table(tmp_path / "cases.csv")
