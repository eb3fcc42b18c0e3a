import os
import signal
import subprocess
import sys
import threading
import time
from functools import partial

import numpy as np
import pytest
from misbehaving import Misbehaving, Unbuildable

from surrogate.errors import PluginError, SurrogateError
from surrogate.execution.execute import execute
from surrogate.execution.executors.dask import At, dask
from surrogate.execution.executors.dask_runs import DaskRuns
from surrogate.execution.memory import KNOWN
from surrogate.runs.identity import SolverSpec
from surrogate.runs.journal import read

distributed = pytest.importorskip("distributed")
pytestmark = pytest.mark.filterwarnings("ignore::ResourceWarning", "ignore::DeprecationWarning")


def spec(**options):
    return SolverSpec("misbehaving", Misbehaving, options)


def statuses(folder):
    return [record.status for record in read(folder).records.values()]


@pytest.fixture(scope="module")
def cluster():
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, dashboard_address=":0", memory_limit=0, silence_logs=50
    ) as made:
        yield made


@pytest.fixture
def on_cluster(cluster):
    return partial(dask, address=cluster.scheduler_address)


def test_two_crashes_cost_two_runs(tmp_path):
    """60 runs on two workers of its own, two end their process by SIGSEGV: 60 calls, 2 failed."""
    ways = ["well"] * 60
    ways[10] = ways[40] = "segfault"
    log = tmp_path / "diary"
    tally = execute(
        spec(diary=str(log)),
        {"x": np.arange(60.0), "way": ways},
        journal=tmp_path / "j",
        executor=partial(dask, workers=2),
    )
    assert (tally.done, tally.failed) == (60, 2)
    assert statuses(tmp_path / "j").count("ok") == 58
    assert len(log.read_text().splitlines()) <= 62
    failed = [r for r in read(tmp_path / "j").records.values() if r.status == "failed"]
    assert {r.inputs["x"] for r in failed} == {10.0, 40.0}
    assert {r.message for r in failed} == {"the worker was killed by SIGSEGV"}


def test_dask_gives_the_records_of_local_processes(tmp_path, on_cluster):
    columns = {"x": np.arange(12.0), "way": ["well", "raise", "nan", "refuse"] * 3}
    execute(spec(), columns, journal=tmp_path / "local", workers=2)
    execute(spec(), columns, journal=tmp_path / "dask", executor=on_cluster)
    local, theirs = read(tmp_path / "local"), read(tmp_path / "dask")
    assert set(local.records) == set(theirs.records)
    for key, record in local.records.items():
        other = theirs.records[key]
        assert (other.status, other.message, other.attempts, other.outputs) == (
            record.status,
            record.message,
            record.attempts,
            record.outputs,
        )
        if record.status == "ok":
            assert (theirs.values(other, "ramp") == local.values(record, "ramp")).all()


def test_retries_are_counted_here(tmp_path, on_cluster):
    """A run that crashes, then raises, is done in the third attempt; refusals are final."""
    log = tmp_path / "diary"
    tally = execute(
        spec(diary=str(log)), {"x": [1.0], "way": ["flaky"]},
        journal=tmp_path / "j", executor=on_cluster, retries=2,
    )  # fmt: skip
    (record,) = read(tmp_path / "j").records.values()
    assert (tally.failed, record.status, record.attempts) == (0, "ok", 3)
    refused = tmp_path / "refused"
    execute(
        spec(diary=str(refused)), {"x": [1.0], "way": ["refuse"]},
        journal=tmp_path / "j2", executor=on_cluster, retries=2,
    )  # fmt: skip
    assert len(refused.read_text().splitlines()) == 1


def test_a_limit_of_time_holds_on_workers(tmp_path, on_cluster):
    tally = execute(
        spec(), {"x": [1.0, 2.0], "way": ["hang_in_c", "well"]},
        journal=tmp_path, executor=on_cluster, timeout=1.0,
    )  # fmt: skip
    assert (tally.done, tally.failed) == (2, 1)
    message = {r.inputs["x"]: r.message for r in read(tmp_path).records.values()}
    assert message == {1.0: "stopped after 1 s, the time limit of a run", 2.0: ""}


@pytest.mark.skipif(not KNOWN, reason="only Linux tells how much a run holds")
def test_a_run_above_the_memory_limit_costs_itself_on_workers(tmp_path, on_cluster):
    """The limit is that of a run, not of the dask worker, which lives on."""
    columns = {"x": [1.0, 2.0, 3.0], "way": ["well", "greedy", "well"]}
    tally = execute(spec(), columns, journal=tmp_path, executor=on_cluster, memory=300e6)
    assert (tally.done, tally.failed) == (3, 1)
    found = {r.inputs["x"]: (r.status, r.message) for r in read(tmp_path).records.values()}
    assert found[2.0] == ("failed", "stopped above 0.3 GB, the memory limit of a run")
    assert found[1.0] == found[3.0] == ("ok", "")


def test_a_killed_dask_worker_costs_no_other_run(tmp_path, cluster, on_cluster):
    """Whatever ends a worker: its run is done again by default, no result is lost."""
    log = tmp_path / "diary"
    victims = []

    def kill(tally):
        if tally.done == 5:
            victims.append(next(iter(cluster.workers.values())).pid)
            os.kill(victims[0], signal.SIGKILL)

    tally = execute(
        spec(diary=str(log), pause=0.05), {"x": np.arange(30.0)},
        journal=tmp_path / "j", executor=on_cluster, progress=kill,
    )  # fmt: skip
    assert victims and (tally.done, tally.failed) == (30, 0)
    calls = len(log.read_text().splitlines())
    assert calls <= 31
    attempts = [record.attempts for record in read(tmp_path / "j").records.values()]
    assert sum(attempts) <= 31


def test_no_worker_is_a_sentence(tmp_path):
    """The scheduler is there, its workers are not; what was finished before stays."""
    with distributed.LocalCluster(n_workers=0, dashboard_address=":0", silence_logs=50) as empty:

        def short(settings):
            source = At(empty.scheduler_address)
            source.patience = 0.5
            return DaskRuns(settings, source)

        with pytest.raises(SurrogateError, match="has had no worker for 0.5 s; start some"):
            execute(spec(), {"x": [1.0]}, journal=tmp_path, executor=short)


def test_no_scheduler_is_a_sentence(tmp_path, monkeypatch):
    from surrogate.execution.executors import dask_runs

    monkeypatch.setattr(dask_runs, "CONNECT_SECONDS", 0.5)
    with pytest.raises(SurrogateError, match="no dask scheduler answers at tcp://127.0.0.1:9"):
        execute(
            spec(), {"x": [1.0]}, journal=tmp_path,
            executor=partial(dask, address="tcp://127.0.0.1:9"),
        )  # fmt: skip


def test_a_solver_that_workers_cannot_build_is_one_sentence(tmp_path, on_cluster):
    broken = SolverSpec("unbuildable", Unbuildable, {"home": os.getpid()})
    with pytest.raises(PluginError, match="cannot be built in a worker process: OSError"):
        execute(broken, {"x": [1.0, 2.0]}, journal=tmp_path, executor=on_cluster)


def test_children_end_when_nobody_asks_any_more(tmp_path, monkeypatch):
    """The child of a worker goes when no run has come for a while, whoever was killed."""
    from surrogate.execution import steady
    from surrogate.execution.backend import RunSettings

    monkeypatch.setattr(steady, "IDLE_SECONDS", 0.2)
    settings = RunSettings(spec(), spec().wanted())
    place = steady.SteadyPlace(steady.packed(settings))
    assert place.evaluate({"x": 2.0, "offset": 0.0, "way": "well"}).outputs == {"square": 4.0}
    idle = threading.Event()
    until = time.monotonic() + 20
    while place.events is not None and time.monotonic() < until:
        idle.wait(0.02)
    assert place.events is None
    assert place.evaluate({"x": 3.0, "offset": 0.0, "way": "well"}).outputs == {"square": 9.0}
    place.close()


def test_check_and_status_do_without_dask_workers(tmp_path):
    study = tmp_path / "s.yaml"
    study.write_text(
        "study: s\nsolver: ishigami\nparameters: {X1: [-3, 3], X2: [-3, 3], X3: [-3, 3]}\n"
        "designs: {train: {method: sobol, runs: 4}}\n"
        "execution: {executor: dask, options: {address: 'tcp://127.0.0.1:9'}}\n"
    )
    code = (
        "import sys; from surrogate.cli import verbs, standing\n"
        "from pathlib import Path; from surrogate.study.study import Study\n"
        f"s = Study.from_yaml({str(study)!r}); standing.check(s, Path('r')); "
        "standing.status(s, Path('r'))\n"
        "assert not {'dask_jobqueue', 'distributed'} & set(sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
