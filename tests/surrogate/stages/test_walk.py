"""The walk through the stages: what is done, what is not done again, what is mended."""

import json
import multiprocessing
import os
import shutil
import signal
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

from surrogate import counting
from surrogate.runs import dataset as rundata
from surrogate.stages import kept, labour
from surrogate.stages.digest import digest, of_object
from surrogate.stages.stage import Job, Result
from surrogate.stages.table import STAGES
from surrogate.study.analysis import parts_of, walk
from surrogate.study.study import Study

STUDY = {
    "study": "walked",
    "about": "First.",
    "solver": "borehole",
    "parameters": {"rw": [0.05, 0.15], "L": [1120, 1680]},
    "designs": {
        "train": {"method": "latin_hypercube", "runs": 12, "seed": 1},
        "test": {"method": "latin_hypercube", "runs": 6, "seed": 2},
    },
    "surrogates": {"linear": "linear", "quadratic": "quadratic"},
    "sensitivity": {"method": "sobol"},
    "screening": {"freeze_below": 0.02},
}


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    """Runs, and all that follows from them."""
    folder = tmp_path_factory.mktemp("results") / "walked"
    with ThreadPoolExecutor(1) as executor:
        Study.from_mapping(STUDY).run(results=folder, executor=executor)
    assert {"linear of flow", "sobol of flow", "report"} <= done(folder)
    return folder


@pytest.fixture
def folder(finished, tmp_path):
    """A copy of the finished study's results, times of files included."""
    return Path(shutil.copytree(finished, tmp_path / "walked"))


def done(folder, **changes):
    """Stages and jobs that were done, not taken from where they are kept."""
    steps = []
    study = Study.from_mapping({**STUDY, **changes})
    walk(study, folder, progress=steps.append).write()
    return {step.label or step.stage for step in steps if step.done < step.total}


def test_the_table_is_in_order():
    """Each stage needs only what was given or stands above it, and reads parts there are."""
    parts, known = parts_of(Study.from_mapping(STUDY)), {"runs", "cases"}
    for stage in STAGES:
        assert set(stage.needs) - {"not_done", "figures", "stamp"} <= known, stage.name
        assert {*stage.reads, *(stage.each or ())} <= set(parts), stage.name
        known.add(stage.name)


def test_nothing_is_done_twice(folder):
    assert done(folder) == set()


@pytest.mark.parametrize(
    "change, again, not_again",
    [
        ({"about": "Second."}, {"report"}, {"linear of flow", "comparison", "sobol of flow"}),
        (
            {"screening": {"freeze_below": 0.3}},
            {"screening", "report", "summary"},
            {"linear of flow", "comparison", "sobol of flow"},
        ),
        (
            {"surrogates": {**STUDY["surrogates"], "linear": "interactions"}},
            {"linear of flow", "comparison", "report"},
            {"quadratic of flow"},
        ),
        (
            {"sensitivity": {"method": "sobol", "confidence": 0.9}},
            {"sobol of flow", "screening", "report"},
            {"linear of flow", "comparison", "regression"},
        ),
        (
            {"parameters": {"rw": [0.05, 0.15], "L": [1120, 1650]}},
            {"linear of flow", "sobol of flow", "report"},
            set(),
        ),
    ],
    ids=lambda value: next(iter(value)) if isinstance(value, dict) else None,
)
def test_only_what_changed_is_done_again(folder, change, again, not_again):
    """An edited word of the study costs the stages that read it, and those after them."""
    if "parameters" in change:
        with ThreadPoolExecutor(1) as executor:
            Study.from_mapping({**STUDY, **change}).run(results=folder, executor=executor)
    found = done(folder, **change)
    assert again <= found and not found & not_again, found


WRITTEN = ("runs.nc", "comparison.nc", "report.html", "summary.json", "surrogates/linear.json")


@pytest.mark.parametrize("damage", [None, lambda b: b[:-9], lambda b: b[:-9] + b"?" * 9])
def test_a_damaged_file_is_made_again(folder, damage):
    """Missing, truncated, changed: size and time tell, then the digest; nothing is refitted."""
    before = {name: (folder / name).read_bytes() for name in WRITTEN}
    for name, content in before.items():
        if damage is None:
            (folder / name).unlink()
        else:
            (folder / name).write_bytes(damage(content))
    assert not done(folder) & {"linear of flow", "comparison", "sobol of flow"}
    for name in ("summary.json", "surrogates/linear.json"):
        assert (folder / name).read_bytes() == before[name]
    for name in ("runs.nc", "comparison.nc"):
        assert rundata.load(folder / name).sizes
    assert (folder / "report.html").read_bytes().rstrip().endswith(b"</html>")
    assert done(folder) == set()


def test_a_file_with_another_time_is_read_and_found_sound(folder):
    os.utime(folder / "report.html", (1, 1))
    before = (folder / "report.html").stat().st_mtime_ns
    assert done(folder) == set()
    assert (folder / "report.html").stat().st_mtime_ns == before


@pytest.mark.parametrize("damage", [lambda b: b[:-5], lambda b: b[:-5] + b"?????", lambda b: b""])
def test_a_damaged_kept_result_is_not_loaded(folder, damage):
    """Its digest is checked before it is unpickled; the fit is done again."""
    (path,) = (folder / "kept").glob("fits-quadratic*")
    path.write_bytes(damage(path.read_bytes()))
    found = done(folder, screening={"freeze_below": 0.4})
    assert "quadratic of flow" in found and "linear of flow" not in found


def test_a_stop_loses_no_finished_fit(folder):
    """Ctrl-C at the second fit: the first is kept and not done again."""

    def stop(step):
        if step.label == "quadratic of flow":
            raise KeyboardInterrupt

    shutil.rmtree(folder / "kept")
    with pytest.raises(KeyboardInterrupt):
        walk(Study.from_mapping(STUDY), folder, progress=stop).write()
    found = done(folder)
    assert "quadratic of flow" in found and "linear of flow" not in found


def test_kept_results_of_dropped_surrogates_go(folder):
    done(folder, surrogates={"linear": "linear"})
    assert not list((folder / "kept").glob("fits-quadratic*"))


def test_other_processes_give_the_same_figures(folder, monkeypatch):
    """Jobs done by other processes at once change no digit of the summary."""
    monkeypatch.setattr(labour, "PATIENCE", 0.0)
    figures = []
    for workers in (1, 2):
        stages = walk(Study.from_mapping(STUDY), folder, workers=workers)
        stages.folder = folder.parent / str(workers)
        stages.write()
        figures.append(json.loads((stages.folder / "summary.json").read_text()))
    for one in figures:
        for name in ("fit_seconds", "predict_seconds"):
            one["comparison"].pop(name)
    assert figures[0] == figures[1]


def slow_square(number, wait):
    for other in wait:
        while not os.path.exists(other):
            pass
    return np.square(number)


def unsendable():
    return lambda: None


def test_help_comes_and_what_cannot_be_sent_is_done_here(tmp_path, monkeypatch):
    """The first job waits for what the last one writes, so another process must have done it."""
    monkeypatch.setattr(labour, "PATIENCE", 0.0)
    flag = tmp_path / "flag"
    jobs = [
        Job("waits", slow_square, {"number": 3, "wait": [flag]}),
        Job("unsendable", lambda: 7, {}),
        Job("writes", os.mkdir, {"path": flag}),
    ]
    found = [result for _, result in labour.carry_out(jobs, workers=2)]
    assert found == [Result(9), Result(7), Result(None)]


def wait_for_ever(ready):
    ready.touch()
    time.sleep(1000)


def test_a_stop_ends_the_other_processes(tmp_path, monkeypatch):
    """A job under way in another process is not waited for."""
    monkeypatch.setattr(labour, "PATIENCE", 0.0)
    ready = tmp_path / "ready"
    jobs = [
        Job("waits", slow_square, {"number": 3, "wait": [ready]}),
        Job("endless", wait_for_ever, {"ready": ready}),
    ]
    before = set(multiprocessing.active_children())
    going = labour.carry_out(jobs, workers=2)
    assert next(going)[1] == Result(9)
    (process,) = set(multiprocessing.active_children()) - before
    going.close()
    until = time.monotonic() + 30  # the pool's own thread may be the one that hears of the end
    while process.exitcode is None and time.monotonic() < until:
        process.join(0.01)
    assert process.exitcode == -signal.SIGKILL


def test_digests_tell_apart():
    """Arrays by value, shape and type; estimators by class and every parameter."""
    from sklearn.ensemble import RandomForestRegressor

    assert digest(np.zeros(4)) == digest(np.zeros(4)) != digest(np.zeros((2, 2)))
    assert digest(np.zeros(2)) != digest(np.zeros(2, dtype=int))
    assert digest({"a": 1, "b": 2}) == digest({"b": 2, "a": 1})
    assert of_object(RandomForestRegressor(3)) == of_object(RandomForestRegressor(3))
    assert of_object(RandomForestRegressor(3)) != of_object(RandomForestRegressor(4))


def test_a_result_that_cannot_be_pickled_is_not_kept(tmp_path):
    path = kept.path_of(tmp_path, "stage", "job")
    kept.save(path, "made", Result(1))
    assert kept.load(path, "made") == Result(1) and kept.load(path, "other") is None
    kept.save(path, "made", Result(unsendable()))
    assert kept.load(path, "made") is None


def told_then_waited(ready, go):
    """Tells that it is in the second of three parts, and ends when `go` is there."""
    counting.PAUSE = 0.0
    for k in counting.counted("part", range(3)):
        while k == 1 and not go.exists():
            ready.touch()


def test_other_processes_tell_how_far_they_are(tmp_path, monkeypatch):
    """The part of a job in another process is told while it is waited for."""
    monkeypatch.setattr(labour, "PATIENCE", 0.0)
    monkeypatch.setattr(labour, "LOOK", 0.01)
    ready, go = tmp_path / "ready", tmp_path / "go"
    jobs = [
        Job("waits", slow_square, {"number": 3, "wait": [ready]}),
        Job("tells", told_then_waited, {"ready": ready, "go": go}),
    ]

    def hear(part):
        if part.text == "part 2 of 3":
            assert part.share == pytest.approx(1 / 3, abs=1e-6)
            go.touch()

    found = [result for _, result in labour.carry_out(jobs, workers=2, hear=hear)]
    assert found == [Result(9), Result(None)]
