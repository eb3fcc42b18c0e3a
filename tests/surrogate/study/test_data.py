"""A study of a table: no solver, the rows are its runs."""

import re
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
import xarray as xr
from made_up import table_of_beams

from surrogate.cli import results
from surrogate.errors import StudyError
from surrogate.solver import Input, Output
from surrogate.study.prediction import predict
from surrogate.study.study import Study

STUDY = """\
study: beams
data:
  file: beams.csv
  outputs: {deflection: {unit: mm}}
surrogates:
  quadratic: quadratic
sensitivity: {method: sobol}
"""


@pytest.fixture
def beams(tmp_path):
    (tmp_path / "beams.csv").write_text(table_of_beams())
    return tmp_path


def study_of(folder, text=STUDY):
    (folder / "study.yaml").write_text(text)
    return Study.from_yaml(folder / "study.yaml")


def done_in(study, folder):
    return results.analyse(study, folder, study.run(results=folder))


def mistakes_of(folder, text):
    with pytest.raises(StudyError) as caught:
        study_of(folder, text)
    return str(caught.value)


def test_columns_are_the_parameters(beams):
    study = study_of(beams)
    assert study.space.names == ("load", "length", "material")
    assert study.space["load"].unit == "N" and study.space["material"].levels == ("brass", "steel")
    load = study.space["load"].law.support
    assert load == (10.0, 50.0)
    assert any("'run' numbers the rows" in note for note in study.notes)


def test_rows_are_the_runs(beams):
    """Values come back to the last digit or two, in the order of the file; one row has none."""
    study = study_of(beams)
    runs = study.run(results=beams / "r")
    lines = [line.split(",") for line in table_of_beams().splitlines()[1:]]
    np.testing.assert_allclose(runs["load"], [float(cells[1]) for cells in lines], rtol=1e-15)
    assert list(runs["material"].values) == [cells[3] for cells in lines]
    answers = [float(cells[4]) if cells[4] else np.nan for cells in lines]
    np.testing.assert_array_equal(runs["deflection"], answers)
    assert runs["status"].values.tolist().count("failed") == 1
    assert runs["message"].values[3] == "beams.csv, row 5: no value of deflection"
    assert runs["origin"].values[0] == "beams.csv, row 2"
    assert not (beams / "r" / "journal").exists()


def test_the_whole_way(beams):
    study = study_of(beams, STUDY.replace("surrogates:", "  test: {fraction: 0.25}\nsurrogates:"))
    done = done_in(study, beams / "r")
    assert done.summary["comparison"]["q2_test"]["values"][0][0] > 0.9
    assert done.trouble.startswith("of 25 runs: 1 failed")
    page = done.report.read_text()
    assert "table beams.csv" in page and "beams.csv, row 5" in page
    assert "holds dates" in page
    found = predict(study, beams / "r", None, ["load=20", "length=1.5", "material=steel"], None)
    assert found.rows[0]["inside"]
    again = done_in(study_of(beams, study.text), beams / "r")
    assert not again.fresh


def test_an_edited_table_is_read_again(beams):
    done_in(study_of(beams), beams / "r")
    text = table_of_beams().replace("1,10.0,1.0,steel,", "1,10.0,1.0,steel,9")
    (beams / "beams.csv").write_text(text)
    assert done_in(study_of(beams), beams / "r").fresh


def test_fraction_holds_replicates_out_together(tmp_path):
    rows = [f"{x},{x * x + noise}" for x in range(10) for noise in (0.0, 0.1, 0.2)]
    (tmp_path / "t.csv").write_text("\n".join(["x,y", *rows]))
    text = "study: t\ndata: {file: t.csv, outputs: [y], test: {fraction: 0.3, seed: 4}}\n"
    study = study_of(tmp_path, text)
    train, test = (study.designs[name].coded for name in ("train", "test"))
    assert len(train) == 21 and len(test) == 9
    assert not set(train.ravel().tolist()) & set(test.ravel().tolist())
    runs = study.run(results=tmp_path / "r")
    np.testing.assert_allclose(
        runs["y"] - np.round(runs["x"]) ** 2, np.tile([0.0, 0.1, 0.2], 10), atol=1e-12
    )


def test_a_column_splits(tmp_path):
    (tmp_path / "t.csv").write_text(
        "x,y,set\n1,2,train\n2,4,Test\n3,6,train\n4,8,test\n1,2.5,test\n"
    )
    study = study_of(tmp_path, "study: t\ndata: {file: t.csv, test: {column: set}}\n")
    assert study.space.names == ("x",)
    runs = study.run(results=tmp_path / "r")
    assert runs["design"].values.tolist() == ["train", "train", "test", "test", "test"]
    assert runs["y"].values.tolist() == [2.0, 6.0, 4.0, 8.0, 2.5]


def test_rows_outside_or_without_inputs_are_told_and_left_out(tmp_path):
    (tmp_path / "t.csv").write_text("x,kind,y\n1,a,2\n2,b,4\n,a,5\n9,a,6\n3,c,7\n1.5,b,8\n")
    text = """\
study: t
data: t.csv
parameters: {x: [0, 5], kind: {levels: [a, b]}}
"""
    study = study_of(tmp_path, text)
    assert study.designs["train"].runs == 3
    told = "\n".join(study.notes)
    assert "no value of x: row 4 of t.csv is left out" in told
    assert "outside of the range of x [0, 5]: row 5 of t.csv is left out" in told
    assert "outside of the levels of kind (a, b): row 6 of t.csv is left out" in told
    assert "outputs are guessed: y" in told


def test_units(tmp_path):
    (tmp_path / "t.csv").write_text("x (cm),z,y [kPa]\n1,5,2000\n2,6,4000\n3,7,6000\n")
    text = """\
study: t
data: {file: t.csv, outputs: {y: {unit: MPa}}}
parameters: {x: {range: [5, 40], unit: mm}, z: {unit: K}}
"""
    study = study_of(tmp_path, text)
    runs = study.run(results=tmp_path / "r")
    assert study.space["x"].law.support == (0.5, 4.0) and study.space["z"].unit == "K"
    np.testing.assert_allclose(runs["y"], [2.0, 4.0, 6.0], rtol=1e-12)
    assert runs["y"].attrs["units"] == "MPa"


def test_some_outputs_missing_keep_the_others(tmp_path):
    (tmp_path / "t.csv").write_text("x,y1,y2\n1,2,3\n2,,5\n3,6,7\n4,,\n")
    runs = study_of(tmp_path, "study: t\ndata: {file: t.csv, outputs: [y1, y2]}\n").run(
        results=tmp_path / "r"
    )
    assert runs["status"].values.tolist() == ["ok", "ok", "ok", "failed"]
    assert runs["y2"].values[1] == 5.0 and np.isnan(runs["y1"].values[1])


def test_a_failed_row_beside_a_solver_is_not_done_again(tmp_path):
    """A test that failed in the laboratory has no call that the solver could repeat."""
    (tmp_path / "t.csv").write_text("X1,X2,X3,y\n1,1,1,5\n2,1,0,\n-1,0,2,7\n")
    text = """\
study: t
solver: ishigami
data: {file: t.csv, outputs: [y]}
parameters: {X1: [-3, 3], X2: [-3, 3], X3: [-3, 3]}
designs: {more: {method: halton, runs: 2}}
execution: {executor: serial}
"""
    study = study_of(tmp_path, text)
    for again in (False, True, ["failed"]):
        runs = study.run(results=tmp_path / "r", retry_failed=again)
        assert runs["status"].values.tolist().count("failed") == 1
        failed = runs.isel(run=np.flatnonzero(runs["status"] == "failed")[0])
        assert failed["origin"] == "t.csv, row 3"
        assert (runs["status"] == "ok").sum() == 4


@pytest.mark.parametrize("kind", ["fit", "data"])
def test_laws_from_a_column(tmp_path, kind):
    """A lognormal sample gives back its mean; the fit names the law."""
    x = np.random.default_rng(3).lognormal(1.0, 0.5, 300)
    (tmp_path / "t.csv").write_text("\n".join(["x,y", *(f"{v:.17g},{2 * v:.17g}" for v in x)]))
    text = f"study: t\ndata: t.csv\nparameters: {{x: {{distribution: {kind}, unit: m}}}}\n"
    study = study_of(tmp_path, text)
    law = study.space["x"].law
    assert dict(law.words)["distribution"] == ("lognormal" if kind == "fit" else "data")
    u = (np.arange(2000) + 0.5) / 2000
    assert law.ppf(u).mean() == pytest.approx(x.mean(), rel=0.03)
    assert study.designs["train"].runs == 300
    np.testing.assert_allclose(study.run(results=tmp_path / "r")["x"], x, rtol=1e-9)


def test_a_dataset_of_runs_is_a_table(tmp_path):
    text = """\
study: ishi
solver: ishigami
parameters: {X1: [-3, 3], X2: [-3, 3], X3: [-3, 3]}
designs:
  train: {method: sobol, runs: 16}
  test: {method: sobol, runs: 4, seed: 3}
"""
    runs = study_of(tmp_path, text).run(workers=1, results=tmp_path / "r")
    runs.to_netcdf(tmp_path / "runs.nc", engine="h5netcdf")
    again = study_of(tmp_path, "study: t\ndata: runs.nc\n").run(results=tmp_path / "s")
    xr.testing.assert_allclose(again["y"].drop_attrs(), runs["y"].drop_attrs(), rtol=1e-15)
    assert again["design"].values.tolist() == runs["design"].values.tolist()


MISTAKES = {
    "no file": ("beams.csv", "bems.csv", "3:9", "cannot be read"),
    "no column": ("deflection:", "deflexion:", "4:13", "did you mean 'deflection'"),
    "texts": ("deflection:", "material:", "4:13", "holds texts, not numbers"),
    "unknown key": ("  file:", "  sheets: a\n  file:", "3:3", "key 'sheets' is unknown"),
    "rename": ("  file:", "  rename: {lod: l}\n  file:", "3:12", "has no column 'lod'"),
    "both": (
        "surrogates:",
        "  test: {fraction: 0.2, column: a}\nsurrogates:",
        "5:9",
        "give either fraction",
    ),
    "split": (
        "surrogates:",
        "  test: {column: material}\nsurrogates:",
        "5:18",
        "'material' holds 'brass'",
    ),
    "constants": ("surrogates:", "constants: {load: 3}\nsurrogates:", "5:1", "has no constants"),
    "designs": (
        "surrogates:",
        "designs: {train: {method: sobol, runs: 4}}\nsurrogates:",
        "5:11",
        "the rows of data: are the designs",
    ),
    "parameter": (
        "surrogates:",
        "parameters: {lod: [1, 2]}\nsurrogates:",
        "5:14",
        "the table has no input 'lod'; did you mean 'load'",
    ),
    "all outside": (
        "surrogates:",
        "parameters: {load: [1, 2]}\nsurrogates:",
        "3:9",
        "no row of beams.csv can be used",
    ),
    "unit": ("unit: mm", "unit: kg", None, ""),
    "too few rows for a law": (
        "surrogates:",
        "parameters: {load: {distribution: fit, mean: 3}}\nsurrogates:",
        "5:20",
        "does not take 'mean'",
    ),
}


@pytest.mark.parametrize("case", MISTAKES)
def test_mistakes_have_places(beams, case):
    old, new, place, said = MISTAKES[case]
    text = STUDY.replace(old, new, 1)
    if place is None:
        study_of(beams, text)  # the header of this column names no unit, so any may be said
        return
    found = mistakes_of(beams, text)
    assert re.search(rf"study.yaml:{place}: .*{re.escape(said)}", found), found


def test_cells_have_row_and_column(beams):
    (beams / "beams.csv").write_text(table_of_beams().replace("20.0,", "2O.0,", 1))
    assert re.search(
        r"study.yaml:3:9: beams.csv: row \d+, column 'load': '2O.0' is not a number",
        mistakes_of(beams, STUDY),
    )


def test_a_law_from_data_needs_data(tmp_path):
    text = """\
study: t
solver: ishigami
parameters: {X1: {distribution: fit}}
designs: {train: {method: sobol, runs: 4}}
"""
    assert "3:18: distribution: fit needs a column of numbers 'X1' in data:" in mistakes_of(
        tmp_path, text
    )


@pytest.fixture
def cloud(tmp_path):
    """60 rows in which width follows load; y depends on load alone."""
    r = np.random.default_rng(0)
    load = r.uniform(size=60)
    width, free = load + 0.1 * r.normal(size=60), r.uniform(size=60)
    y = 2 * load + free
    rows = [",".join(f"{v:.6f}" for v in row) for row in zip(load, width, free, y, strict=True)]
    (tmp_path / "t.csv").write_text("\n".join(["load,width,free,y", *rows]))
    return tmp_path


CLOUD = "study: t\ndata: t.csv\nsurrogates: {linear: linear}\nsensitivity: {surrogate: best}\n"


def test_a_cloud_is_not_a_box(cloud):
    """Shapley effects of dependent inputs: y = 2 load + free, width a copy of load with noise."""
    study = study_of(cloud, CLOUD)
    correlation = np.array(study.space.correlation)
    assert correlation[0, 1] > 0.8 and correlation[0, 2] == correlation[1, 2] == 0.0
    assert study.sensitivity_method.name == "shapley"
    done = done_in(study, cloud / "r")
    indices = done.summary["sensitivity"]
    shapley = dict(
        zip(indices["parameter"]["values"], indices["shapley"]["values"][0], strict=True)
    )
    closed = indices["closed_first_order"]["values"][0]
    assert sum(shapley.values()) == pytest.approx(1.0, abs=1e-6)
    assert shapley["width"] > 0.2 and shapley["load"] > shapley["width"]
    assert closed[1] > 0.5
    page = done.report.read_text()
    assert "The runs are a cloud and not a box" in page and "corners without runs" in page


def test_predictions_outside_of_the_cloud_are_marked(cloud):
    study = study_of(cloud, CLOUD)
    done_in(study, cloud / "r")
    rows = [
        predict(study, cloud / "r", None, [f"load={a}", f"width={b}", "free=0.5"], None).rows[0]
        for a, b in ((0.5, 0.5), (0.1, 0.9), (0.5, 3.0))
    ]
    assert [row["inside"] for row in rows] == [True, True, False]
    assert [row["extrapolated"] for row in rows] == [False, True, True]


def test_dependence_can_be_set_aside(cloud):
    study = study_of(cloud, CLOUD + "correlation: []\n")
    assert study.space.independent and study.sensitivity_method.name == "sobol"
    text = CLOUD.replace("{surrogate: best}", "{method: sobol}")
    assert "4:23: method sobol needs independent parameters" in mistakes_of(cloud, text)


def test_rows_against_the_constraints_are_left_out(tmp_path):
    (tmp_path / "t.csv").write_text("a,b,y\n1,2,3\n2,2,4\n4,4,8\n1,4,5\n3,1,4\n")
    study = study_of(tmp_path, 'study: t\ndata: t.csv\nconstraints: ["a + b <= 7"]\n')
    assert study.designs["train"].runs == 4
    assert any("against the constraints: row 4 of t.csv" in note for note in study.notes)


class Counted:
    """2 x + k, and how often it was asked."""

    version = "1"
    inputs = {
        "x": Input(unit="mm", range=(0, 10)),
        "k": Input(nominal=1.0),
        "kind": Input(nominal="a", levels=("a", "b")),
    }
    outputs = {"y": Output(unit="MPa")}
    asked: list[float] = []

    def __call__(self, x, k, kind):
        Counted.asked.append(x)
        return {"y": 2 * x + k}


BESIDE = f"""\
study: beside
solver: "{__name__}:Counted"
data: rows.csv
parameters: {{x: [0, 10]}}
designs:
  train: {{method: csv, path: points.csv}}
surrogates: {{linear: linear}}
"""


@pytest.fixture
def beside(tmp_path):
    """Rows in other units, one of another kind, one at a point of the design."""
    (tmp_path / "points.csv").write_text("x\n1\n2.5\n4\n")
    (tmp_path / "rows.csv").write_text(
        "test,x [cm],kind,y [kPa]\nA,0.25,a,6100\nB,0.7,a,15000\nC,0.8,b,18000\nD,0.9,a,\n"
    )
    Counted.asked.clear()
    return tmp_path


def carried_out(study, folder, **how):
    with ThreadPoolExecutor(1) as executor:
        return study.run(results=folder, executor=executor, **how)


def test_rows_beside_a_solver_are_runs_that_are_done(beside):
    """The row at x = 2.5 stands for the design's run there; the others are design `data`."""
    study = study_of(beside, BESIDE)
    runs = carried_out(study, beside / "r")
    assert sorted(Counted.asked) == pytest.approx([1.0, 4.0])
    assert runs["design"].values.tolist() == ["train"] * 3 + ["data"] * 3
    np.testing.assert_allclose(runs["x"], [1, 2.5, 4, 2.5, 7, 9])
    np.testing.assert_allclose(runs["y"], [3, 6.1, 9, 6.1, 15, np.nan])
    assert runs["origin"].values.tolist() == [
        "",
        "rows.csv, row 2",
        "",
        "rows.csv, row 2",
        "rows.csv, row 3",
        "rows.csv, row 5",
    ]
    assert study.surrogates["linear"].train == ("train", "data")
    assert any("kind is not a as in this study: row 4" in note for note in study.notes)
    page = results.analyse(study, beside / "r", runs).report.read_text()
    assert "rows.csv, row 3" in page and "read from rows.csv" in page


def test_fresh_runs_do_not_repeat_rows(beside):
    study = study_of(beside, BESIDE)
    carried_out(study, beside / "r")
    carried_out(study, beside / "r", fresh=True)
    assert sorted(Counted.asked) == pytest.approx([1.0, 1.0, 4.0, 4.0])


def test_mistakes_beside_a_solver(beside):
    (beside / "rows.csv").write_text("x,y\n1,2\n1,3\n")
    assert "3:7: rows 2 and 3 of rows.csv have the same inputs and other y" in mistakes_of(
        beside, BESIDE
    )
    (beside / "rows.csv").write_text("z,y\n1,2\n2,3\n")
    assert "no column of rows.csv has the name of an input" in mistakes_of(beside, BESIDE)
    (beside / "rows.csv").write_text("x [N],y\n1,2\n2,3\n")
    assert "3:7: unit 'N' does not convert to 'mm'" in mistakes_of(beside, BESIDE)
