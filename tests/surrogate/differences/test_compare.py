"""`surrogate compare`: what changed is told, what did not change is not, damage is a sentence."""

import json
import shutil

import numpy as np
import pytest
import xarray as xr
from typer.testing import CliRunner

from surrogate.cli import results
from surrogate.cli.comparing import compare as page_of
from surrogate.cli.verbs import app
from surrogate.differences.compare import compare
from surrogate.differences.part import overlap, words
from surrogate.errors import ResultsError
from surrogate.study.study import Study

STUDY = """\
study: demo
solver: borehole
parameters: {rw: [0.05, 0.15], Hu: [990, 1110], L: [1120, 1680]}
designs:
  train: {method: sobol, runs: 24, seed: 1}
  test: {method: sobol, runs: 12, seed: 2}
surrogates: {linear: linear, quadratic: quadratic}
sensitivity: sobol
screening: {freeze_below: 0.02}
solve:
  eighty: {target: {flow: {value: 80, within: 5}}}
"""
#: The same in other words; more training runs; another limit, under which Hu is frozen.
OTHER = (
    STUDY.replace("rw: [0.05, 0.15]", "rw: {range: [0.05, 0.15]}")
    .replace("runs: 24", "runs: 30")
    .replace("0.02", "0.3")
)


def analysed(text, folder):
    study = Study.from_text(text)
    results.analyse(study, folder, study.run(results=folder, workers=1), workers=1)
    return folder


@pytest.fixture(scope="module")
def sides(tmp_path_factory):
    place = tmp_path_factory.mktemp("compare")
    return analysed(STUDY, place / "a"), analysed(OTHER, place / "b")


@pytest.fixture
def copies(sides, tmp_path):
    for one in sides:
        shutil.copytree(one, tmp_path / one.name)
    return tmp_path / "a", tmp_path / "b"


def parts(a, b):
    return {part.key: part for part in compare(a, b)[2]}


def test_keys_with_their_values_not_lines(sides):
    rows = {row["key"]: row for row in parts(*sides)["study_file"].rows}
    assert set(rows) == {"designs.train.runs", "screening.freeze_below"}
    assert (rows["designs.train.runs"]["a"], rows["designs.train.runs"]["b"]) == (24, 30)


def test_runs_are_matched_by_all_their_inputs(sides):
    found = parts(*sides)
    rows = {row["what"]: (row["a"], row["b"]) for row in found["runs"].rows}
    assert rows["ok"] == (36, 42)
    assert rows["points only here"] == (0, 6)
    (answers,) = found["answers"].rows
    assert (answers["points"], answers["differing"], answers["largest"]) == (36, 0, 0.0)


def test_answers_that_differ_are_measured(copies):
    """Three answers of B raised by 2: the largest difference 2, the RMS 2 sqrt(3 / 36)."""
    path = copies[1] / "runs.nc"
    runs = xr.load_dataset(path, engine="h5netcdf")
    runs["flow"][:3] += 2.0
    runs.to_netcdf(path, engine="h5netcdf")
    (row,) = parts(*copies)["answers"].rows
    assert row["differing"] == 3
    assert row["largest"] == pytest.approx(2.0)
    assert row["rms"] == pytest.approx(2.0 * np.sqrt(3 / 36))


def test_figures_are_those_of_the_datasets(sides):
    found = parts(*sides)
    table = xr.load_dataset(sides[1] / "comparison.nc", engine="h5netcdf")
    for row in found["surrogates"].rows:
        own = table.sel(surrogate=row["surrogate"], output=row["output"])
        assert row["q2_b"] == pytest.approx(float(own["q2_test"]))
        assert row["rmse_b"] == pytest.approx(float(own["rmse_test"]))
    linear = [row for row in found["coefficients"].rows if row["surrogate"] == "linear"]
    assert [row["term"] for row in linear] == ["1", "rw", "Hu", "L"]
    total = {r["parameter"]: r for r in found["sensitivity"].rows if r["index"] == "total"}
    own = xr.load_dataset(sides[0] / "sensitivity.nc", engine="h5netcdf").sel(parameter="rw")
    assert total["rw"]["a"] == pytest.approx(
        [float(own[f"total{end}"].values.item()) for end in ("", "_low", "_high")]
    )


def test_decisions_goals_and_versions(sides):
    found = parts(*sides)
    rows = {row["parameter"]: (row["a"], row["b"]) for row in found["screening"].rows}
    assert rows == {
        "rw": ("keep", "keep"), "Hu": ("keep", "freeze"), "L": ("keep", "freeze")
    }  # fmt: skip
    assert found["screening"].sentences == ("The decision on Hu, L has changed.",)
    whats = {row["what"] for row in found["solve"].rows}
    assert {"rw", "Hu", "L", "flow", "probability"} <= whats
    assert found["versions"].sentences == ("Solver and packages are the same.",)


def test_another_version_of_the_solver_is_told(copies):
    path = copies[1] / "runs.nc"
    runs = xr.load_dataset(path, engine="h5netcdf").assign_attrs(solver_version="2")
    runs.to_netcdf(path, engine="h5netcdf")
    assert parts(*copies)["versions"].sentences == ("Different: solver version.",)


def test_a_folder_is_like_itself(sides):
    found = parts(sides[0], sides[0])
    assert found["study_file"].rows == ()
    assert found["coefficients"].shown == [] and found["sensitivity"].shown == []
    assert found["solve"].shown == [] and found["screening"].shown == []


def test_intervals_overlap_when_they_share_a_point():
    assert overlap((1.0, 0.0, 2.0), (3.0, 2.0, 4.0)) is True
    assert overlap((1.0, 0.0, 2.0), (3.0, 2.1, 4.0)) is False
    assert overlap((1.0, None, None), (3.0, 2.1, 4.0)) is None
    assert overlap(None, (3.0, 2.1, 4.0)) is None
    assert words((1.0, None, None)) == "1" and words((1.0, 0.5, 2.0)) == "1 [0.5, 2]"


@pytest.mark.parametrize(
    "name, content, said",
    [
        ("summary.json", None, "A: summary.json does not exist; `surrogate report` makes it again"),
        ("summary.json", b"{", "A: summary.json is damaged"),
        ("summary.json", b"[1]", "A: summary.json is damaged: it holds no figures"),
        ("runs.nc", None, "runs.nc does not exist"),
        ("runs.nc", b"nothing", "runs.nc cannot be read"),
        ("study.yaml", None, "A: study.yaml cannot be read"),
        ("study.yaml", b"a: [", "A: study.yaml cannot be read"),
        ("study.yaml", b"1", "A: study.yaml holds no study"),
    ],
)
def test_damage_is_a_sentence_and_costs_its_part_only(copies, name, content, said):
    path = copies[0] / name
    path.unlink()
    if content is not None:
        path.write_bytes(content)
    a, _, found = compare(*copies)
    assert len(a.troubles) == 1 and said in a.troubles[0]
    assert any(part.rows for part in found)
    page_of(*copies, None)


def test_figures_of_another_shape_are_a_sentence(copies):
    path = copies[0] / "summary.json"
    figures = json.loads(path.read_text())
    figures["comparison"] = {"surrogate": 3}
    path.write_text(json.dumps(figures))
    assert "cannot be compared" in parts(*copies)["surrogates"].sentences[0]


def test_folders_without_results_are_refused(sides, tmp_path):
    with pytest.raises(ResultsError, match="is no folder"):
        compare(sides[0], tmp_path / "nothing")
    (tmp_path / "empty").mkdir()
    with pytest.raises(ResultsError, match="holds no results that can be read"):
        compare(sides[0], tmp_path / "empty")


def test_the_verb_prints_lines_of_80_columns_data_and_a_page(copies):
    shown = CliRunner().invoke(app, ["compare", *map(str, copies)], env={"COLUMNS": "80"})
    assert shown.exit_code == 0
    assert all(len(line) <= 80 for line in shown.output.splitlines())
    assert "designs.train.runs" in shown.output
    data = json.loads(CliRunner().invoke(app, ["compare", *map(str, copies), "--json"]).output)
    assert [row["key"] for row in data["study_file"]["rows"]] == [
        "designs.train.runs",
        "screening.freeze_below",
    ]
    page = (copies[1] / "compare.html").read_text()
    assert "demo: what changed" in page and "The decision on Hu, L has changed." in page
    assert "http://" not in page.replace("http://www.w3.org", "")
