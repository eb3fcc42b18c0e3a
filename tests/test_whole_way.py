"""From a study file to its report, by the command and by Python, as a user goes."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import jsonschema
import numpy as np
import pytest
import xarray as xr
import yaml
from in_process import command

from surrogate import Study
from surrogate.study.analysis import parts_of
from surrogate.study.schema import json_schema
from surrogate.study.source import read_text

ROOT = Path(__file__).parent.parent
STUDIES = sorted((ROOT / "studies").glob("*.yaml"))
TABLE_3 = {
    "1": 32.73,
    "mu_skin": 2.70,
    "tension": 11.54,
    "leg_length": 2.85,
    "alpha1": 4.54,
    "alpha2": 3.92,
    "alpha3": -1.74,
    "alpha4": -0.51,
}

SMALL = """\
study: small
solver: {name: "my_solver:Slow"}
parameters: {a: [0, 1], b: [0, 2]}
designs: {train: {method: sobol, runs: 32, seed: 1}}
surrogates: {quadratic: {method: quadratic}}
sensitivity: {method: sobol}
screening: {freeze_below: 0.02}
execution: {workers: 2}
"""

SOLVER = """\
import os, time
from surrogate.errors import SolverError
from surrogate.solver import Input, Output

class Slow:
    version = "1"
    inputs = {"a": Input(range=(0, 1)), "b": Input(range=(0, 2))}
    outputs = {"y": Output(unit="mm")}
    def __init__(self, pause: float = 0.0, fail_above: float = 9.0):
        self.pause, self.fail_above = pause, fail_above
    def __call__(self, a, b):
        time.sleep(self.pause)
        if os.path.exists("log"):
            with open("log", "a") as log:
                log.write(f"{a} {b}\\n")
        if a > self.fail_above:
            raise SolverError(f"a = {a:.2f} buckles")
        return {"y": 1 + 2 * a + b * b}
"""


@pytest.fixture
def place(tmp_path):
    """A folder with a small study and its solver."""
    (tmp_path / "my_solver.py").write_text(SOLVER)
    (tmp_path / "small.yaml").write_text(SMALL)
    return tmp_path


def test_published_model_gives_back_table_3(tmp_path):
    """Chassagne 2018: nine runs of the linear model give Table III; S_i = beta_i^2 / sum beta^2."""
    command("run", ROOT / "studies/published_model.yaml", cwd=tmp_path, check=0)
    results = tmp_path / "results/published_model"
    table = xr.open_datatree(results / "regression.nc", engine="h5netcdf")["linear"].to_dataset()
    found = dict(zip(table["term"].values.tolist(), table["coefficient"].values, strict=True))
    assert found == pytest.approx(TABLE_3, abs=1e-10)
    beta = np.array([TABLE_3[name] for name in list(TABLE_3)[1:]])
    indices = xr.open_dataset(results / "sensitivity.nc", engine="h5netcdf")
    for name in ("first_order", "total"):
        np.testing.assert_allclose(
            indices[name].sel(output="pressure_b1"), beta**2 / (beta**2).sum(), atol=1e-9
        )
    assert json.loads((results / "summary.json").read_text())["screening"]["freeze"] == [
        "alpha3",
        "alpha4",
    ]


def test_ishigami_indices_within_their_intervals(tmp_path):
    """Ishigami and Homma 1990: the exact total indices lie in the reported intervals.

    The shipped study with a smaller forest, far from the best surrogate in any size, and fewer
    draws of the best one: intervals stay narrower than the tolerance (7e-4).
    """
    text = (ROOT / "studies/ishigami.yaml").read_text(encoding="utf-8")
    for words, others in {
        "n_estimators: 200": "n_estimators: 20",
        "surrogate: best}": "surrogate: best, draws: 30}",
    }.items():
        assert words in text
        text = text.replace(words, others)
    (tmp_path / "ishigami.yaml").write_text(text)
    command("run", "ishigami.yaml", cwd=tmp_path, check=0)
    indices = xr.open_dataset(tmp_path / "results/ishigami/sensitivity.nc", engine="h5netcdf")
    exact = xr.DataArray(
        [0.5575888552, 0.4424111448, 0.2436836641], coords={"parameter": ["X1", "X2", "X3"]}
    )
    one = indices.sel(output="y")
    assert ((one["total_low"] - 1e-3 <= exact) & (exact <= one["total_high"] + 1e-3)).all(), one
    assert abs(one["total"] - exact).max() < 0.02


def test_runs_open_plainly_and_hold_what_is_promised(place):
    """Plain xr.open_dataset; coded, parameters, outputs with units, history, provenance."""
    command("run", "small.yaml", cwd=place, check=0)
    runs = xr.open_dataset(place / "results/small/runs.nc")
    assert {
        "coded",
        "a",
        "b",
        "y",
        "design",
        "status",
        "message",
        "seconds",
        "attempts",
        "finished",
    } <= set(runs.variables)
    assert runs["y"].attrs["units"] == "mm" and runs.sizes == {"run": 32, "parameter": 2}
    np.testing.assert_allclose(runs["y"], 1 + 2 * runs["a"] + runs["b"] ** 2, rtol=1e-14)
    assert read_text(runs.attrs["study"], "").data["study"] == "small"
    for name in (
        "comparison.nc",
        "sensitivity.nc",
        "regression.nc",
        "surrogates/quadratic.json",
        "summary.json",
        "study.yaml",
        "report.html",
    ):
        assert (place / "results/small" / name).exists(), name


def test_a_larger_sequence_keeps_the_runs_there_are(place):
    """A Sobol' sequence raised from 32 to 48 runs, with centre points: 17 new runs only."""
    (place / "log").touch()
    command("run", "small.yaml", cwd=place, check=0)
    assert len((place / "log").read_text().splitlines()) == 32
    (place / "small.yaml").write_text(
        SMALL.replace("runs: 32, seed: 1", "runs: 48, seed: 1, augment: [{method: center_points}]")
    )
    command("run", "small.yaml", cwd=place, check=0)
    assert len((place / "log").read_text().splitlines()) == 32 + 17
    again = command("run", "small.yaml", cwd=place, check=0)
    assert len((place / "log").read_text().splitlines()) == 49 and "up to date" in again.stdout


def test_a_renamed_study_takes_its_runs_along(place):
    """The same runs under another study name are not done again."""
    (place / "log").touch()
    command("run", "small.yaml", cwd=place, check=0)
    (place / "other.yaml").write_text(SMALL.replace("study: small", "study: other"))
    command("run", "other.yaml", cwd=place, check=0)
    assert len((place / "log").read_text().splitlines()) == 32


def test_a_study_ships_with_its_runs_and_is_validated(place):
    """store, the line it says to add, check, report and validate without a run; --fresh runs."""
    (place / "log").touch()
    command("run", "small.yaml", cwd=place, check=0)
    said = command("store", "small.yaml", cwd=place, check=0).stdout
    assert "stored: runs/small.nc" in said.splitlines()
    (place / "cases.csv").write_text("a,b,y\n0.5,1,3.1\n0.2,0.4,1.5\n0.9,0.1,2.9\n2,1,6\n")
    more = "stored: runs/small.nc\nvalidation: {cases: cases.csv, models: {same: 'my_solver:Slow'}}"
    (place / "small.yaml").write_text(SMALL + more)
    jsonschema.validate(yaml.safe_load(SMALL + more), json_schema())
    away = ("--results", "away")
    assert (
        "all 32 are stored (32 in runs/small.nc)"
        in command("check", "small.yaml", *away, cwd=place, check=0).stdout
    )
    command("report", "small.yaml", *away, cwd=place, check=0)
    figures = json.loads((place / "away/small/summary.json").read_text())["validation"]
    assert figures["n"]["values"] == [[3.0], [3.0]]
    # y = 1 + 2 a + b^2 in both models: 3, 1.56, 2.81 against 3.1, 1.5, 2.9
    assert figures["bias"]["values"][0][0] == pytest.approx((-0.1 + 0.06 - 0.09) / 3)
    said = command("validate", "small.yaml", "--cases", "cases.csv", *away, cwd=place, check=0)
    assert "1 outside the ranges" in said.stdout and "a 2 (0 to 1)" in said.stdout
    assert (place / "away/small/validation_cases.nc").exists()
    calls = len((place / "log").read_text().splitlines())
    assert calls == 32 + 2 * 3  # the model `same` at three cases, twice
    command("run", "small.yaml", "--fresh", *away, cwd=place, check=0)
    assert len((place / "log").read_text().splitlines()) == calls + 32 + 3
    (place / "my_solver.py").write_text(SOLVER.replace('version = "1"', 'version = "1.1"'))
    again = [sys.executable, "-m", "surrogate", "check", "small.yaml", *away]
    checked = subprocess.run(again, cwd=place, capture_output=True, text=True, check=True).stdout
    assert (
        "small.yaml:9:9: no run in 'runs/small.nc' is one of this study's: other version "
        "1 -> 1.1" in checked.replace("\n", " ")
    )


def test_gaps_of_an_output_are_no_failures(place):
    """NaN of an output that declares gaps: the run is good, the surrogate learns from the rest."""
    text = SOLVER.replace('"y": Output(unit="mm")', '"y": Output(), "z": Output(gaps=True)')
    (place / "my_solver.py").write_text(
        text.replace("a + b * b}", 'a + b * b, "z": a * b if a > 0.2 else float("nan")}')
    )
    command("run", "small.yaml", cwd=place, check=0)
    runs = xr.open_dataset(place / "results/small/runs.nc")
    assert (runs["status"] == "ok").all()
    np.testing.assert_array_equal(np.isnan(runs["z"]), runs["a"] <= 0.2)
    summary = json.loads((place / "results/small/summary.json").read_text())
    assert summary["regression"]["quadratic"]["z"]["r2"]["values"] == pytest.approx(1.0)


def test_designs_without_a_seed_differ(place):
    """Two designs of one method without seeds are reproducible, and not the same points."""
    text = SMALL.replace(
        "{train: {method: sobol, runs: 32, seed: 1}}",
        "{train: {method: sobol, runs: 32}, test: {method: sobol, runs: 32}}",
    )
    (place / "small.yaml").write_text(text)
    first, second = (Study.from_yaml(place / "small.yaml").points for _ in range(2))
    np.testing.assert_array_equal(first["train"], second["train"])
    assert abs(first["train"] - first["test"]).max(axis=1).min() > 1e-6


def test_failed_runs_are_data(place):
    """Runs without an answer cost their rows: exit status 1, a report, the reason in status."""
    (place / "small.yaml").write_text(
        SMALL.replace(
            'name: "my_solver:Slow"', 'name: "my_solver:Slow", options: {fail_above: 0.8}'
        )
    )
    done = command("run", "small.yaml", cwd=place, check=1)
    assert "failed" in done.stderr
    runs = xr.open_dataset(place / "results/small/runs.nc")
    failed = runs["status"] == "failed"
    np.testing.assert_array_equal(failed, runs["a"] > 0.8)
    assert np.isnan(runs["y"][failed.values]).all()
    assert "buckles" in command("status", "small.yaml", cwd=place, check=0).stdout
    assert "buckles" in (place / "results/small/report.html").read_text()


@pytest.mark.parametrize("blow, status", [(signal.SIGKILL, -signal.SIGKILL), (signal.SIGINT, 130)])
@pytest.mark.skipif(os.name == "nt", reason="POSIX signals")
def test_an_interrupted_study_resumes_without_repeating(place, blow, status):
    """kill -9 and Ctrl-C half-way: every finished run is kept and none is done twice."""
    (place / "log").touch()
    (place / "small.yaml").write_text(
        SMALL.replace('name: "my_solver:Slow"', 'name: "my_solver:Slow", options: {pause: 0.2}')
    )
    process = subprocess.Popen(
        [sys.executable, "-m", "surrogate", "run", "small.yaml"],
        cwd=place,
        stderr=subprocess.PIPE,
        stdout=subprocess.DEVNULL,
        text=True,
    )
    journal = place / "results/small/journal/runs.jsonl"
    wait_for(lambda: journal.exists() and len(journal.read_text().splitlines()) >= 8)
    process.send_signal(blow)
    said = process.communicate(timeout=60)[1]
    assert process.returncode == status
    assert ("of 32 runs are done and kept; run again to go on" in said) == (status == 130)
    time.sleep(0.5)  # workers of a killed parent end their run
    kept = len(journal.read_text().splitlines())
    assert 8 <= kept < 32
    command("run", "small.yaml", cwd=place, check=0)
    lines = journal.read_text().splitlines()
    assert len(lines) == len({json.loads(line)["key"] for line in lines}) == 32
    calls = (place / "log").read_text().splitlines()
    assert 32 <= len(calls) <= 32 + 2  # at most what each worker had under way is done again


def wait_for(condition):
    deadline = time.monotonic() + 60
    while not condition():
        assert time.monotonic() < deadline, "did not happen within a minute"
        time.sleep(0.02)


def test_new_check_run_predict(tmp_path):
    """The study that `new` writes is checked, runs, and predicts with an interval."""
    command("new", "first", cwd=tmp_path, check=0)
    assert command("new", "first", cwd=tmp_path, check=2).stderr.count("exists already") == 1
    checked = command("check", "first.yaml", "--json", cwd=tmp_path, check=0)
    assert json.loads(checked.stdout)["runs"]["missing"] == 60
    assert not (tmp_path / "results").exists()
    command("run", "first.yaml", "--results", "elsewhere", cwd=tmp_path, check=0)
    at = ["rw=0.1", "Hu=1050", "Hl=760", "L=140000 cm", "Kw=10000"]
    answer = command(
        "predict", "first.yaml", *at, "--results", "elsewhere", "--json", cwd=tmp_path, check=0
    )
    (row,) = json.loads(answer.stdout)
    flow = row["outputs"]["flow"]
    exact = Study.from_yaml(tmp_path / "first.yaml").spec.solver(
        rw=0.1, r=25050.0, Tu=89335.0, Hu=1050.0, Tl=89.55, Hl=760.0, L=1400.0, Kw=10000.0
    )["flow"]
    assert row["inside"] and flow["low"] <= flow["value"] <= flow["high"]
    assert flow["value"] == pytest.approx(exact, rel=0.02)
    (tmp_path / "points.csv").write_text("rw,Hu,Hl,L,Kw\n0.1,1050,760,1400,10000\n0.2,1,1,1,1\n")
    rows = json.loads(
        command(
            "predict",
            "first.yaml",
            "--points",
            "points.csv",
            "--surrogate",
            "quadratic",
            "--results",
            "elsewhere",
            "--json",
            cwd=tmp_path,
            check=0,
        ).stdout
    )
    assert [row["inside"] for row in rows] == [True, False]


def test_wrong_input_ends_with_status_2_and_sentences(place):
    """Mistakes in study, verb or point: status 2, a sentence, no traceback."""
    (place / "small.yaml").write_text(SMALL.replace("quadratic}", "quadratc}"))
    done = command("run", "small.yaml", cwd=place, check=2)
    assert done.stderr.startswith("small.yaml:5:34: regressor 'quadratc' is unknown; did you mean")
    assert "no_such.yaml" in command("check", "no_such.yaml", cwd=place, check=2).stderr
    command("chekc", "small.yaml", cwd=place, check=2)
    (place / "small.yaml").write_text(SMALL)
    assert "run" in command("report", "small.yaml", cwd=place, check=1).stderr
    wrong = command("predict", "small.yaml", "a=1", "c=2", "b", cwd=place, check=2).stderr
    assert "'c' is unknown" in wrong and "'b' is not name=value" in wrong


@pytest.mark.parametrize("path", STUDIES, ids=lambda path: path.stem)
def test_shipped_studies_are_sound_and_fit_the_schema(path):
    """Every study that ships reads without a mistake and validates against the JSON Schema.

    What its stages read has one digest in every process: it tells of no place in memory.
    """
    study = Study.from_yaml(path)
    assert study.name == path.stem
    assert not [name for name, part in parts_of(study).items() if " at 0x" in str(part.words)]
    jsonschema.validate(
        json.loads(json.dumps(read_text(path.read_text(), "s").data)), json_schema()
    )


def test_python_is_the_same_path(place, monkeypatch):
    """The words of the study file as Python data give the same study, runs and indices."""
    monkeypatch.chdir(place)
    data = {**yaml.safe_load(SMALL), "solver": "my_solver:Slow"}
    study = Study.from_mapping(data)
    runs = study.run(workers=1)
    fits = study.fit(runs)
    table = study.compare(fits, runs)
    indices = study.sensitivity(fits, runs, table)
    # Var(2a) = 4/12; b = 2u: b^2 = 4u^2, Var = 16 (1/5 - 1/9)
    parts = np.array([4 / 12, 16 * (1 / 5 - 1 / 9)])
    np.testing.assert_allclose(indices["total"].sel(output="y"), parts / parts.sum(), atol=1e-9)
    page = study.report(runs, fits, table, indices)
    assert page.save(place / "report.html").stat().st_size > 10_000


def test_the_number_of_workers_changes_no_digit(place):
    """Same study, same seeds, same numbers with one worker and with two."""
    for workers in (1, 2):
        command(
            "run", "small.yaml", "--workers", workers, "--results", str(workers), cwd=place, check=0
        )
    one, two = (json.loads((place / str(k) / "small/summary.json").read_text()) for k in (1, 2))
    for part in ("sensitivity", "screening"):
        assert one[part] == two[part]


def test_ctrl_c_while_the_command_loads_is_no_traceback():
    """The packages of the command take a second or two to load; impatience then ends with 130."""
    text = """if True:
        import sys
        class Impatient:
            def find_spec(self, name, *rest):
                if name == "surrogate.cli.verbs":
                    raise KeyboardInterrupt
        sys.meta_path.insert(0, Impatient())
        from surrogate.__main__ import main
        main()"""
    ended = subprocess.run([sys.executable, "-c", text], capture_output=True, text=True)
    assert (ended.returncode, ended.stdout, ended.stderr) == (130, "", "")
