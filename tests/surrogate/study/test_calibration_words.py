"""`calibration:` in a study file: what it becomes, mistakes at their places, the verb."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from in_process import command

from surrogate.calibration import sampling
from surrogate.errors import StudyError
from surrogate.study.study import Study

STUDY = """
study: fall
solver: borehole
parameters:
  L: {range: [1.12, 1.68], unit: km}
  Kw: [9855, 12045]
designs: {train: {method: latin_hypercube, runs: 12, seed: 1}}
surrogates: {quadratic: quadratic}
calibration:
  cases: measured.csv
"""
TABLE = "L,flow,flow_error\n1200,84.9,0.4\n1300,78.6,\n1.5 km,67.9,0.4\n1900,50,0.4\n"
FREE = "  free: {Kw: {distribution: normal, mean: 11000, std: 400}}\n"


def study(folder: Path, words: str, table: str = TABLE, cases: str = "measured.csv") -> Path:
    (folder / "measured.csv").write_text(table)
    path = folder / "fall.yaml"
    path.write_text(STUDY.replace("measured.csv", cases) + words)
    return path


def test_the_words_become_a_problem(tmp_path):
    problem = Study.from_yaml(study(tmp_path, FREE + "  error: 0.5\n  seed: 3\n")).calibration
    assert problem is not None and problem.free == ("Kw",) and problem.seed == 3
    assert problem.priors["Kw"].support == (9855.0, 12045.0)
    assert problem.measured[0].values.tolist() == [84.9, 78.6, 67.9]
    assert problem.measured[0].errors.tolist() == [0.4, 0.5, 0.4]
    assert problem.coded[:, 0] == pytest.approx([-5 / 7, -5 / 14, 5 / 14])
    assert (
        "outside of the study's ranges: 1 of 4 cases" in problem.notes[0]
        and "1900" in problem.notes[0]
    )


@pytest.mark.parametrize("free", ["  free: [Kw]\n", "  free: {Kw: {}}\n", "  free: Kw\n"])
def test_a_name_alone_keeps_the_law_of_the_study(tmp_path, free):
    found = Study.from_yaml(study(tmp_path, free))
    assert found.calibration.priors["Kw"] == found.space["Kw"].law
    assert found.calibration.measured[0].estimated


@pytest.mark.parametrize(
    "words, table, sentence",
    [
        ("  free: [Kv]\n", TABLE, "'Kv' is not a parameter of this study; Allowed: Kw, L"),
        ("  free: [L]\n", TABLE, "give 'L', which is to be learnt; drop the column"),
        ("  free: [Kw]\n", "flow\n80\n", "no column for parameter 'L'; give it, or let it be free"),
        ("  free: [Kw]\n", "L\n1200\n", "no column for any scalar output of the study: flow"),
        ("  free: [Kw]\n  error: 2 kg\n", TABLE, "kg"),
        ("  free: [Kw]\n  error: -1\n", TABLE, "error -1"),
        ("  free: [Kw]\n  error: small\n", TABLE, "error 'small' is not a number"),
        ("  free: [Kw]\n  surrogate: gp\n", TABLE, "surrogate 'gp' is unknown"),
        ("  free: [Kw]\n", "L,flow,flow_error\n1200,80,0\n", "flow_error: 0 must be above 0"),
        ("  free: [Kw]\n", "L,flow\n9000,80\n", "no case of 'measured.csv' lies inside"),
        ("  free: [Kw]\n  output: [flaw]\n", TABLE, "the study has no output 'flaw'"),
        ("  free: {Kw: {mean: 3}}\n", TABLE, "say which distribution has this"),
        ("  free: {Kw: {range: [1, 20000]}}\n", TABLE, "reaches beyond that of the parameter"),
        ("  free: {Kw: {distribution: normal, mean: 3, sd: 1}}\n", TABLE, "does not take 'sd'"),
    ],
)
def test_mistakes_are_told_at_their_place(tmp_path, words, table, sentence):
    with pytest.raises(StudyError) as error:
        Study.from_yaml(study(tmp_path, words, table))
    assert sentence in str(error.value)
    assert all(":" in one and "fall.yaml:" in one for one in error.value.mistakes)


def test_missing_packages_are_told_with_the_cure(tmp_path, monkeypatch):
    monkeypatch.setattr(sampling, "find_spec", lambda name: None)
    with pytest.raises(StudyError, match=r"pip install 'surrogate-studies\[calibration\]'"):
        Study.from_yaml(study(tmp_path, FREE))


def test_study_without_calibration_says_what_to_add(tmp_path):
    path = study(tmp_path, FREE)
    path.write_text(path.read_text().split("calibration:")[0])
    found = command("calibrate", path, cwd=tmp_path, check=2)
    assert "add calibration: {cases: measured.csv, free: [..]}" in found.stderr


def measured(folder: Path) -> Path:
    """A study with measurements made by its solver, Kw being 11400 m/year, error 0.4."""
    solver = Study.from_yaml(study(folder, FREE)).spec.solver
    nominal = {name: one.nominal for name, one in solver.inputs.items()}
    rows = [(L, solver(**{**nominal, "L": L, "Kw": 11400.0})["flow"]) for L in (1150, 1400, 1650)]
    table = "L,flow,flow_error\n" + "".join(
        f"{L},{y + d},0.4\n" for (L, y), d in zip(rows, (0.4, -0.5, 0.3), strict=True)
    )
    return study(folder, FREE + "  draws: 800\n", table)


def test_run_and_calibrate_learn_the_input_that_made_the_measurements(tmp_path, monkeypatch):
    """Kw was 11400 m/year; flow is 0.00704 Kw at L = 1180 m. The posterior is sampled once."""
    path = measured(tmp_path)
    command("run", path, "--quiet", cwd=tmp_path, check=0)
    monkeypatch.setattr(sampling, "sample", None)
    told = json.loads(command("calibrate", path, "--json", cwd=tmp_path, check=0).stdout)
    kw = told["unknowns"]["Kw"]
    assert kw["low"] < 11400.0 < kw["high"] and kw["shrinkage"] > 0.9
    folder = tmp_path / "results" / "fall"
    summary = json.loads((folder / "summary.json").read_text())
    assert summary["calibration"]["unknowns"]["Kw"] == kw
    page = (folder / "report.html").read_text()
    assert "What measurements say about inputs" in page and "Posterior of Kw" in page
    with xr.open_datatree(folder / "posterior.nc", engine="h5netcdf") as tree:
        assert tree["posterior"]["Kw"].dims == ("chain", "draw")
        assert float(tree["posterior"]["Kw"].mean()) == pytest.approx(kw["mean"])
        assert tree["posterior_predictive"]["flow"].dims == ("chain", "draw", "case")
        assert np.isfinite(tree["log_likelihood"]["flow"].values).all()
    inference = sampling.arviz().from_netcdf(folder / "posterior.nc")
    assert {"posterior", "prior", "observed_data", "sample_stats"} <= set(inference.groups())


def test_the_solver_puts_the_posterior_to_the_test(tmp_path):
    """The measurements are the solver's own: they differ from it by their error and no more."""
    path, folder = measured(tmp_path), tmp_path / "results" / "fall"
    command("run", path, "--quiet", cwd=tmp_path, check=0)
    summary = json.loads((folder / "summary.json").read_text())["calibration"]
    assert summary["verification"] is None and "R-hat is 1.0" in summary["convergence"]
    words = ("calibrate", path, "--verify", "--workers", 1, "--quiet")
    found = json.loads(command(*words, "--json", cwd=tmp_path, check=0).stdout)
    assert found["unknowns"] == summary["unknowns"]
    flow = found["verified"]["flow"]
    assert flow["runs"] == 20 and flow["inside"] >= 17 and flow["rmse"] < 0.1
    assert flow["measured_rms"] == pytest.approx(0.4, rel=0.3)
    assert flow["expected_rms"] == pytest.approx(0.4)
    assert "The solver was run at 20 draws" in (folder / "report.html").read_text()
    fewer = command(*words, "--runs", 5, cwd=tmp_path, check=0).stdout
    assert "The solver was run at 5 draws of the posterior" in " ".join(fewer.split())


def test_runs_at_draws_of_an_earlier_posterior_are_left_out(tmp_path):
    path, folder = measured(tmp_path), tmp_path / "results" / "fall"
    command("run", path, "--quiet", cwd=tmp_path, check=0)
    command("calibrate", path, "--verify", "--workers", 1, "--quiet", cwd=tmp_path, check=0)
    path.write_text(path.read_text() + "  error: 3\n  seed: 5\n")
    found = json.loads(command("calibrate", path, "--json", cwd=tmp_path, check=0).stdout)
    assert found["verification"] is None and found["verified"] == {}
    assert (folder / "designs" / "verified_calibration.json").exists()
