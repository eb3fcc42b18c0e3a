"""Jobs of a queue: their scripts, and a queue that starts them on this machine."""

import os
import signal
import stat
import subprocess
import time
from functools import partial

import numpy as np
import pytest
from misbehaving import Misbehaving

from surrogate.errors import SurrogateError
from surrogate.execution.backend import RunSettings
from surrogate.execution.execute import execute
from surrogate.execution.executors import queues
from surrogate.execution.executors.queues import LSF, PBS, SGE, Jobs, Queue, Slurm
from surrogate.runs.identity import SolverSpec
from surrogate.runs.journal import read

pytest.importorskip("dask_jobqueue")
pytestmark = pytest.mark.filterwarnings("ignore::ResourceWarning", "ignore::DeprecationWarning")

REQUEST = {
    "jobs": 20,
    "cores": 4,
    "memory": "16 GB",
    "walltime": "12 h",
    "queue": "long",
    "account": "p123",
    "setup": ["module load abaqus"],
}


def spec(**options):
    return SolverSpec("misbehaving", Misbehaving, options)


def settings(folder, **more):
    return RunSettings(spec(), spec().wanted(), folder=folder, **more)


HEADERS = {
    Slurm: ["#SBATCH -p long", "#SBATCH -A p123", "#SBATCH --cpus-per-task=4", "#SBATCH --mem=15G",
            "#SBATCH -t 12:00:00"],
    PBS: ["#PBS -q long", "#PBS -A p123", "#PBS -l select=1:ncpus=4:mem=15GB",
          "#PBS -l walltime=12:00:00"],
    LSF: ["#BSUB -q long", '#BSUB -P "p123"', "#BSUB -n 4", "#BSUB -W 12:00"],
    SGE: ["#$ -q long", "#$ -P p123", "#$ -l h_rt=12:00:00", "#$ -cwd"],
}  # fmt: skip


@pytest.mark.parametrize("kind", HEADERS)
def test_the_script_asks_for_what_the_study_says(tmp_path, kind):
    queue = kind(settings(tmp_path, timeout=1800.0), **REQUEST)
    log, ended = tmp_path / "a b.log", tmp_path / "ended"
    text = queue.script("tcp://10.0.0.5:8786", "surrogate-1", log, ended)
    lines = text.splitlines()
    assert lines[0].startswith("#!")
    for header in HEADERS[kind]:
        assert header in lines
    *_, setup, command, last = lines
    assert setup == "module load abaqus"
    assert "distributed.cli.dask_worker tcp://10.0.0.5:8786 --name surrogate-1" in command
    assert command.endswith(f"--nthreads 1 --lifetime 43170s --no-dashboard > '{log}' 2>&1")
    assert last == f"echo $? > {ended}"
    assert subprocess.run(["sh", "-n"], input=text, text=True).returncode == 0


def test_workers_take_no_run_that_their_job_may_not_live_to_finish(tmp_path):
    queue = Slurm(settings(tmp_path, timeout=1800.0), walltime="2 h")
    assert queue.useful_seconds == 7200.0 - 1800.0 - 60.0
    with pytest.raises(SurrogateError, match="walltime 20 min is too short for a run of at most"):
        _ = Slurm(settings(tmp_path, timeout=1800.0), walltime="20 min").useful_seconds


SBATCH = """#!/bin/sh
[ -e {folder}/refuse ] && {{ echo 'sbatch: error: invalid partition' >&2; exit 1; }}
setsid sh "$1" >/dev/null 2>&1 </dev/null &
echo $! >> {folder}/jobs
echo "Submitted batch job $!"
"""
SCANCEL = """#!/bin/sh
for job; do kill -9 -$job 2>/dev/null; done; exit 0
"""


@pytest.fixture
def slurm(tmp_path, monkeypatch):
    """A queue whose jobs start on this machine at once."""
    folder = tmp_path / "bin"
    folder.mkdir()
    for name, text in (("sbatch", SBATCH.format(folder=folder)), ("scancel", SCANCEL)):
        (folder / name).write_text(text)
        (folder / name).chmod(0o755 | stat.S_IEXEC)
    monkeypatch.setenv("PATH", f"{folder}:{os.environ['PATH']}")
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join(filter(None, __import__("sys").path)))
    yield folder
    for job in (folder / "jobs").read_text().split() if (folder / "jobs").exists() else ():
        try:
            os.killpg(int(job), signal.SIGKILL)
        except ProcessLookupError:
            pass


def jobs(folder):
    return [int(line) for line in (folder / "jobs").read_text().split()]


def is_running(group):
    try:
        os.killpg(group, 0)
    except ProcessLookupError:
        return False
    return True


def test_runs_go_through_jobs_and_a_lost_job_is_replaced(tmp_path, slurm, monkeypatch):
    """Two jobs, of which one is killed: its run is done again, another job takes its place."""
    monkeypatch.setattr(queues, "LOST_SECONDS", 0.5)
    killed = []

    def kill(tally):
        if tally.done == 4 and not killed:
            killed.append(jobs(slurm)[0])
            os.killpg(killed[0], signal.SIGKILL)

    tally = execute(
        spec(pause=0.1), {"x": np.arange(40.0)}, journal=tmp_path / "r" / "journal",
        executor=partial(Slurm, jobs=2, interface="lo"), progress=kill,
    )  # fmt: skip
    assert killed and (tally.done, tally.failed) == (40, 0)
    assert 2 <= len(jobs(slurm)) <= 4
    assert sum(r.attempts for r in read(tmp_path / "r" / "journal").records.values()) <= 41
    until = time.monotonic() + 20
    while any(map(is_running, jobs(slurm))) and time.monotonic() < until:
        time.sleep(0.05)
    assert not any(map(is_running, jobs(slurm)))


def test_jobs_that_bring_no_worker_are_told_with_what_they_printed(tmp_path, slurm, monkeypatch):
    monkeypatch.setattr(queues, "FIRST_PAUSE", 0.05)
    with pytest.raises(SurrogateError) as caught:
        execute(
            spec(), {"x": [1.0]}, journal=tmp_path / "r" / "journal",
            executor=partial(Slurm, interface="lo", python="echo no licence; false"),
        )  # fmt: skip
    sentence = str(caught.value)
    assert sentence.startswith("3 jobs in a row brought no worker; job ")
    assert "Finished runs are kept" in sentence


def test_a_refused_job_is_told_in_the_words_of_the_queue(tmp_path, slurm, monkeypatch):
    monkeypatch.setattr(queues, "FIRST_PAUSE", 0.05)
    (slurm / "refuse").touch()
    with pytest.raises(SurrogateError, match="sbatch refused a job: sbatch: error: invalid parti"):
        execute(
            spec(), {"x": [1.0]}, journal=tmp_path / "r" / "journal",
            executor=partial(Slurm, interface="lo"),
        )  # fmt: skip


def test_submissions_pause_longer_and_longer_and_have_a_ceiling(tmp_path, monkeypatch):
    submitted, moment = [], [1000.0]
    monkeypatch.setattr(time, "monotonic", lambda: moment[0])
    queue = Slurm(settings(tmp_path), jobs=1, hourly=100)
    made = Jobs(queue, tmp_path)

    def submit(now):
        submitted.append(now)
        made.submitted.append(now)
        made._failed("no licence", now)

    monkeypatch.setattr(made, "_submit", submit)
    for _ in range(7000):
        made.tend(set(), 5)
        moment[0] += 1.0
    pauses = np.diff(submitted)
    assert pauses[:6].tolist() == [5.0, 10.0, 20.0, 40.0, 80.0, 160.0]
    assert pauses.max() <= queues.LONGEST_PAUSE
    made.failures, made.not_before, queue.hourly = 0, 0.0, 8
    monkeypatch.setattr(made, "_failed", lambda words, now: None)
    before = len(submitted)
    for _ in range(3000):
        made.tend(set(), 5)
        moment[0] += 1.0
    assert len(submitted) - before <= 8
    assert issubclass(Slurm, Queue)
