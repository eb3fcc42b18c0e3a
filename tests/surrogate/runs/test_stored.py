"""Runs that ship with a study: taken as done when they are the study's own, and said so."""

import json
from concurrent.futures import ThreadPoolExecutor

import h5py
import numpy as np
import pytest
import xarray as xr
from misbehaving import Misbehaving

from surrogate.cli.results import analyse, store
from surrogate.errors import ResultsError, StudyError
from surrogate.execution.fresh import interrupted
from surrogate.runs import dataset as rundata
from surrogate.runs import stored
from surrogate.runs.journal import read
from surrogate.study.study import Study

TEXT = """\
study: shipped
solver: {name: "misbehaving:Misbehaving", options: {diary: DIARY}}
parameters:
  x: [0, 4]
  way: {levels: [well, refuse]}
constants: {offset: 3}
designs:
  train: {method: latin_hypercube, runs: 9, seed: 3}
  test: {method: latin_hypercube, runs: 4, seed: 4}
surrogates: {linear: {method: linear}}
"""


@pytest.fixture
def place(tmp_path):
    """A folder with the study, run to its end, and its stored file."""
    study = write(tmp_path)
    run(study, tmp_path)
    store(study, tmp_path / "results")
    return tmp_path


def write(place, text=TEXT + "stored: runs/shipped.nc\n", **changes):
    """The study with some words changed, in a file; without `stored:` while there is none."""
    for before, after in {"DIARY": str(place / "diary"), **changes}.items():
        assert before in text
        text = text.replace(before, after)
    if not (place / "runs").exists():
        text = text.replace("stored: runs/shipped.nc\n", "")
    (place / "study.yaml").write_text(text)
    return Study.from_yaml(place / "study.yaml")


def run(study, place, results="results", **options):
    with ThreadPoolExecutor(1) as executor:
        return study.run(results=place / results, executor=executor, **options)


def asked(place):
    """How often the solver was called so far."""
    return len((place / "diary").read_text().splitlines())


def test_a_study_with_all_its_runs_runs_nothing(place):
    """Values, failures and their messages, seconds and dates are those of the stored file."""
    before, first = asked(place), rundata.load(place / "runs/shipped.nc")
    assert {"ok", "failed"} == set(first["status"].values.tolist())
    study = write(place)
    runs = run(study, place, "elsewhere")
    assert asked(place) == before
    assert json.loads(runs.attrs["stored"]) == {"runs/shipped.nc": 13}
    for name in ("x", "way", "square", "status", "message", "seconds", "attempts", "finished"):
        np.testing.assert_array_equal(runs[name], first[name], err_msg=name)
    np.testing.assert_allclose(runs["ramp"], first["ramp"].astype(float), rtol=0)
    assert study.unused == []


def test_report_and_prediction_without_a_run_before(place):
    """Fits, tables and the page come from the stored file alone, and the page says so."""
    study = write(place)
    done = analyse(study, place / "elsewhere")
    assert done.summary["stored"] == {"runs/shipped.nc": 13}
    assert "13 of them were read from runs/shipped.nc, not run here" in done.report.read_text()
    assert not (place / "elsewhere/journal").exists()


def test_only_what_is_missing_is_run(place):
    """Four more points of the design: four runs, beside the thirteen that are stored."""
    study = write(
        place, **{"  test:": "  more: {method: latin_hypercube, runs: 4, seed: 9}\n  test:"}
    )
    before = asked(place)
    runs = run(study, place, "elsewhere")
    new = runs["design"].values == "more"
    assert asked(place) == before + new.sum()
    assert not (runs["status"] == "missing").any()
    assert json.loads(runs.attrs["stored"]) == {"runs/shipped.nc": 13}


def test_failed_stored_runs_are_done_again_when_asked(place):
    """A stored failure is an answer, until --retry-failed."""
    study, before = write(place), asked(place)
    failed = int((study.stored(place / "none")["status"] == "failed").sum())
    run(study, place, "elsewhere", retry_failed=True)
    assert failed > 0 and asked(place) == before + failed


def test_a_point_rounded_by_another_machine_is_the_same_point(place):
    """Inputs that differ in the sixteenth digit are one run; in the tenth they are two."""
    for shift, taken in ((3e-16, 13), (1e-10, 0)):
        runs = rundata.load(place / "runs/shipped.nc")
        rundata.save(runs.assign(x=runs["x"] * (1 + shift)), place / "runs/moved.nc")
        study = write(place, **{"shipped.nc": "moved.nc"})
        found = study.stored(place / "none")
        assert int((found["status"] != "missing").sum()) == taken


CHANGED = {
    "solver options": (
        {
            '"misbehaving:Misbehaving", options: {': (
                '"misbehaving:Misbehaving", options: {pause: 0.5, '
            )
        },
        "other option pause: none -> 0.5",
    ),
    "constant": ({"offset: 3": "offset: 4"}, r"other offset: 3 -> 4 mm\^2"),
    "range": ({"[0, 4]": "[5, 6]"}, r"other x: 0\.\d+ to 3\.\d+ -> 5\.\d+ to 5\.\d+ mm"),
    "size": ({"runs: 9": "runs: 8", "runs: 4": "runs: 6"}, "other x: .* mm"),
}


@pytest.mark.parametrize("changes, words", CHANGED.values(), ids=CHANGED)
def test_runs_that_do_not_fit_are_named_with_the_first_difference(place, changes, words):
    """A stored file without a run of this study: a sentence at its place, and all is missing."""
    study = write(place, **changes).found(place / "none")
    (sentence,) = study.unused
    line = study.text[: study.text.index("stored:")].count("\n") + 1
    assert sentence.startswith(f"{place / 'study.yaml'}:{line}:9: no run in 'runs/shipped.nc'")
    with pytest.raises(AssertionError, match=words):
        raise AssertionError(sentence)
    assert (study.stored(place / "none")["status"] == "missing").all()


def test_another_version_of_the_solver_is_another_run(place, monkeypatch):
    """The version belongs to the identity: 'other version 1 -> 2'."""
    monkeypatch.setattr(Misbehaving, "version", "2")
    (sentence,) = write(place).unused
    assert "other version 1 -> 2" in sentence


def test_a_file_without_the_wanted_output(place):
    """Runs that lack an output that the study wants are not taken."""
    runs = rundata.load(place / "runs/shipped.nc").drop_vars("ramp")
    rundata.save(rundata.select(runs, statuses=["ok"]), place / "runs/moved.nc")
    (sentence,) = write(place, **{"shipped.nc": "moved.nc"}).unused
    assert "it has no output ramp" in sentence


def test_damaged_and_foreign_files_are_mistakes_of_the_study(place):
    """Not netCDF, half a file, a dataset of something else: sentences with line and column."""
    whole = (place / "runs/shipped.nc").read_bytes()
    line = TEXT.count("\n") + 1
    for name, data in (("text", b"not a dataset"), ("half", whole[: len(whole) // 2])):
        (place / "runs" / name).write_bytes(data)
        with pytest.raises(StudyError, match=rf"study.yaml:{line}:9: .*{name}.* cannot be read"):
            write(place, **{"shipped.nc": name})
    rundata.save(xr.Dataset({"x": ("run", [1.0])}), place / "runs/foreign.nc")
    with pytest.raises(StudyError, match="lacks the attribute 'identity'.*'status'"):
        write(place, **{"shipped.nc": "foreign.nc"})


def test_several_files_and_the_journal_before_them(place):
    """A list of files; a run that the journal has is not counted as stored."""
    (place / "runs/other.nc").write_bytes((place / "runs/shipped.nc").read_bytes())
    study = write(place, **{"runs/shipped.nc": "[runs/shipped.nc, runs/other.nc]"})
    assert json.loads(study.stored(place / "none").attrs["stored"]) == {"runs/shipped.nc": 13}
    assert study.unused == []
    assert json.loads(study.stored(place / "results").attrs["stored"]) == {}


def test_fields_are_single_precision_and_all_else_is_exact(place):
    """A field moves by less than a millionth of its range; inputs keep every digit."""
    first = write(place).stored(place / "results")
    with h5py.File(place / "runs/shipped.nc") as file:
        assert file["ramp"].dtype == np.float32 and file["x"].dtype == np.float64
        assert file["ramp"].compression == "gzip"
    again = rundata.load(place / "runs/shipped.nc")
    np.testing.assert_array_equal(again["x"], first["x"])
    np.testing.assert_array_equal(again["square"], first["square"])
    assert abs(again["ramp"] - first["ramp"]).max() < 1e-6 * 8.0
    # a field that varies in its eighth digit only would be lost in single precision
    fine = first.assign(ramp=1.0 + 1e-8 * first["ramp"])
    stored.write(fine, place / "fine.nc")
    assert rundata.load(place / "fine.nc")["ramp"].dtype == np.float64


def test_nothing_to_store(tmp_path):
    """A study without finished runs has nothing to store."""
    with pytest.raises(ResultsError, match="nothing to store"):
        store(write(tmp_path), tmp_path / "results")


def test_stored_runs_can_be_asked_again(place):
    """`call_and_answer` gives what the solver was called with, constants included."""
    study = write(place)
    runs = study.stored(place / "none")
    for row in np.flatnonzero(runs["status"] == "ok")[:3]:
        call, answer = rundata.call_and_answer(runs, row)
        assert call["offset"] == 3.0
        again = study.spec.solver(**call)
        assert again["square"] == answer["square"]
        np.testing.assert_allclose(again["ramp"], answer["ramp"], rtol=1e-6)


def test_fresh_runs_take_nothing_over(place):
    """All runs are done again, from neither journal nor neighbours nor stored file."""
    study, before = write(place), asked(place)
    old = study.stored(place / "results")
    runs = run(study, place, fresh=True)
    assert asked(place) == before + 13
    assert (runs["finished"] > old["finished"].max()).all()
    assert json.loads(runs.attrs["stored"]) == {}
    assert run(study, place).equals(runs) and asked(place) == before + 13


def test_an_interrupted_fresh_run_keeps_the_old_and_is_resumed(place):
    """Stopped after five runs: the old results stand; repeating it does the other eight."""
    study, before = write(place), asked(place)
    old = study.stored(place / "results")

    def stop(progress):
        if progress.done == 5:
            raise KeyboardInterrupt("stopped")

    with pytest.raises(KeyboardInterrupt, match="stopped, with --fresh"):
        run(study, place, fresh=True, progress=stop)
    done = asked(place) - before
    assert study.stored(place / "results").equals(old)
    kept = interrupted(place / "results/journal")
    assert 5 <= kept <= done
    run(study, place)
    assert asked(place) == before + done  # an ordinary run has nothing to do
    runs = run(study, place, fresh=True)
    assert asked(place) == before + done + 13 - kept
    assert (runs["finished"] > old["finished"].max()).all()
    assert not (place / "results/journal_fresh").exists()
    assert len(read(place / "results/journal").records) == 13
