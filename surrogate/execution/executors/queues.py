"""Jobs of a queue (Slurm, PBS, LSF, Grid Engine), each with dask workers that find their way back.

The scheduler runs in this process. Job scripts are those of dask-jobqueue. Jobs are submitted
one by one as they are needed, never more than a number an hour, with longer and longer pauses
while they fail. A worker takes no new run that its job may not live to finish.
"""

from __future__ import annotations

import re
import shlex
import subprocess
import time
from collections import deque
from collections.abc import Generator, Iterator, Mapping
from dataclasses import dataclass, field
from importlib import import_module
from pathlib import Path
from typing import Any, ClassVar

from surrogate.errors import Mistake, PluginError, StudyError, SurrogateError
from surrogate.execution.backend import Event, RunSettings
from surrogate.execution.executors.dask import MISSING, Own
from surrogate.execution.executors.dask_runs import DaskRuns
from surrogate.execution.handle import Task
from surrogate.execution.stopping import Stop
from surrogate.space.units import seconds, size

#: Seconds before the end of a job's walltime in which its workers take no new run.
SPARE_SECONDS = 60.0

#: Seconds without any of its workers after which a job that had some counts as ended.
LOST_SECONDS = 30.0

#: First and longest pause, in seconds, after a job that gave no worker.
FIRST_PAUSE, LONGEST_PAUSE = 5.0, 1800.0

#: Jobs in a row without a worker after which it is given up.
MOST_FAILURES = 3


@dataclass
class Queue:
    """Jobs of a queue.

    jobs        at most so many at a time
    cores       of a job; they are shared by its `processes`, one run at a time each
    memory      of a job: 4 GB
    walltime    of a job: 12 h
    processes   runs at once in a job, each with an equal part of its cores
    queue       partition or queue
    account     who pays (project of LSF and Grid Engine)
    setup       lines of shell before the workers start: module load ...
    directives  more lines for the queue, without its prefix: ["--gres=gpu:1"]
    interface   network of this machine that jobs can reach: eth0, ib0
    python      interpreter of the jobs; default: the one that runs this
    hourly      most submissions in an hour
    """

    settings: RunSettings
    jobs: int = 1
    cores: int = 1
    memory: str = "4 GB"
    walltime: str = "1 h"
    processes: int = 1
    queue: str | None = None
    account: str | None = None
    setup: list[str] = field(default_factory=list)
    directives: list[str] = field(default_factory=list)
    interface: str | None = None
    python: str | None = None
    hourly: int = 60

    job: ClassVar[str]
    submit: ClassVar[str]
    cancel: ClassVar[str]
    payer: ClassVar[str] = "account"
    standard_input: ClassVar[bool] = False

    @classmethod
    def mistakes(cls, options: Mapping[str, Any], timeout: float | None) -> Iterator[Mistake]:
        """What is wrong with the values of options; timeout: seconds that a run may take."""
        for name in ("jobs", "cores", "processes", "hourly"):
            if _is_whole(options.get(name, 1)) and options.get(name, 1) < 1:
                yield Mistake((name,), f"{name}: {options[name]} must be 1 or more")
        for name, read, example in (("memory", size, "16 GB"), ("walltime", seconds, "12 h")):
            given = options.get(name, example)
            if not isinstance(given, str):
                yield Mistake((name,), f"{name}: {given!r} has no unit; write it as in {example}")
                continue
            try:
                found = read(given)
            except StudyError as error:
                yield Mistake((name,), f"{name}: {error}")
                continue
            if found <= 0:
                yield Mistake((name,), f"{name}: {given} must be above 0; for example {example}")
            elif name == "walltime" and timeout and _useful(found, timeout) <= 0:
                yield Mistake((name,), _too_short(given, timeout))

    def __post_init__(self) -> None:
        try:
            import_module(self.job.partition(":")[0])
        except ImportError:
            raise PluginError(MISSING.format(type(self).__name__.lower())) from None
        threads = self.settings.threads or max(1, self.cores // self.processes)
        settings = RunSettings(**{**vars(self.settings), "threads": threads})
        self._runs = DaskRuns(settings, Jobs(self, self.settings.folder / "jobs"))

    @property
    def under_way(self) -> int:
        """Runs that are not given back yet."""
        return self._runs.under_way

    def results(self, queue: deque[Task], stop: Stop) -> Generator[Event, None, None]:
        """As `Backend.results`."""
        return self._runs.results(queue, stop)

    @property
    def seconds(self) -> float:
        """The walltime."""
        return seconds(self.walltime)

    @property
    def useful_seconds(self) -> float:
        """Seconds of a job in which its workers take new runs."""
        longest = self.settings.timeout or 0.0
        useful = _useful(self.seconds, longest)
        if useful <= 0:
            raise SurrogateError(_too_short(self.walltime, longest))
        return useful

    def script(self, address: str, name: str, log: Path, ended: Path) -> str:
        """The job's script; output goes to `log`, the exit status of the workers to `ended`."""
        module, kind = self.job.split(":")
        made = getattr(import_module(module), kind)(**self._words(address, name))
        *before, command = made.job_script().rstrip().splitlines()
        told = f"{command} > {shlex.quote(str(log))} 2>&1"
        return "\n".join([*before, told, f"echo $? > {shlex.quote(str(ended))}", ""])

    def _words(self, address: str, name: str) -> dict[str, Any]:
        # One run at a time in a process: the later of two --nthreads counts.
        life = max(1, int(self.seconds - min(SPARE_SECONDS, self.seconds / 10) / 2))
        arguments = ["--nthreads", "1", "--lifetime", f"{life}s", "--no-dashboard"]
        words: dict[str, Any] = {
            "scheduler": address,
            "name": name,
            "job_name": name,
            "queue": self.queue,
            "cores": self.cores,
            "memory": f"{int(size(self.memory))} B",
            "processes": self.processes,
            "walltime": self.clock_time,
            "job_script_prologue": self.setup,
            "job_extra_directives": self.directives,
            "worker_extra_args": arguments,
            "death_timeout": 120,
            "interface": None,
            self.payer: self.account,
        }
        return words if self.python is None else {**words, "python": self.python}

    @property
    def clock_time(self) -> str:
        """The walltime as the queue writes it."""
        minutes, seconds = divmod(int(self.seconds), 60)
        return f"{minutes // 60:02d}:{minutes % 60:02d}:{seconds:02d}"


def _is_whole(value: Any) -> bool:
    return isinstance(value, int) and not isinstance(value, bool)


def _useful(walltime: float, longest: float) -> float:
    """Seconds of a job in which a run of at most `longest` seconds may begin."""
    return walltime - longest - min(SPARE_SECONDS, walltime / 10)


def _too_short(walltime: str, longest: float) -> str:
    return (
        f"walltime {walltime} is too short for a run of at most {longest:g} s; raise walltime or "
        "lower timeout"
    )


class Slurm(Queue):
    """Jobs of Slurm (sbatch), each with dask workers."""

    job, submit, cancel = "dask_jobqueue.slurm:SLURMJob", "sbatch", "scancel"


class PBS(Queue):
    """Jobs of PBS or Torque (qsub), each with dask workers."""

    job, submit, cancel = "dask_jobqueue.pbs:PBSJob", "qsub", "qdel"


class LSF(Queue):
    """Jobs of LSF (bsub), each with dask workers."""

    job, submit, cancel = "dask_jobqueue.lsf:LSFJob", "bsub", "bkill"
    payer, standard_input = "project", True

    @property
    def clock_time(self) -> str:
        """Hours and minutes."""
        minutes = max(1, -(-int(self.seconds) // 60))
        return f"{minutes // 60:02d}:{minutes % 60:02d}"


class SGE(Queue):
    """Jobs of Grid Engine (qsub), each with dask workers."""

    job, submit, cancel = "dask_jobqueue.sge:SGEJob", "qsub", "qdel"
    payer = "project"


@dataclass
class Job:
    """A job that was submitted; number: the queue's."""

    name: str
    number: str
    log: Path
    ended: Path
    seen: float | None = None

    def is_over(self, workers: set[str], moment: float) -> bool:
        """True when it has ended, by its own word or because its workers are gone."""
        if any(f"{worker}-".startswith(f"{self.name}-") for worker in workers):
            self.seen = moment
            return False
        gone = self.seen is not None and moment - self.seen > LOST_SECONDS
        return gone or self.ended.exists()


class Jobs(Own):
    """The workers that jobs of a queue bring; folder: for their scripts and output."""

    patience = 1.0

    def __init__(self, queue: Queue, folder: Path):
        super().__init__(0)
        self.queue, self.folder = queue, folder
        self.going: list[Job] = []
        self.submitted: deque[float] = deque()
        self.failures, self.last_words = 0, ""
        self.not_before = 0.0

    def options(self) -> dict[str, Any]:
        """Where the scheduler listens: at an address that jobs can reach."""
        from distributed.utils import get_ip, get_ip_interface

        interface = self.queue.interface
        return {"host": get_ip_interface(interface) if interface else get_ip()}

    def open(self) -> str:
        """Start the scheduler."""
        self.life = self.queue.useful_seconds
        self.address = super().open()
        self.folder.mkdir(parents=True, exist_ok=True)
        return self.address

    def lifetime(self, worker: str) -> float | None:
        """Seconds for which a worker takes new runs."""
        return self.life

    def tend(self, workers: set[str], wanted: int) -> None:
        """Submit jobs while more runs wait than there are workers."""
        moment = time.monotonic()
        for job in [job for job in self.going if job.is_over(workers, moment)]:
            self.going.remove(job)
            self._note(job, moment)
        if workers:
            self.failures = 0
        needed = min(self.queue.jobs, -(-wanted // self.queue.processes)) - len(self.going)
        for _ in range(needed):
            if moment < self.not_before or not self._may_submit(moment):
                return
            self._submit(moment)

    def _note(self, job: Job, moment: float) -> None:
        if job.seen is None:
            said = job.log.read_text(errors="replace") if job.log.exists() else ""
            self._failed(f"job {job.number} brought no worker: {_end_of(said)}", moment)

    def _failed(self, words: str, moment: float) -> None:
        self.failures, self.last_words = self.failures + 1, words
        pause = min(LONGEST_PAUSE, FIRST_PAUSE * 2 ** (self.failures - 1))
        self.not_before = moment + pause

    def _may_submit(self, moment: float) -> bool:
        while self.submitted and moment - self.submitted[0] > 3600.0:
            self.submitted.popleft()
        return len(self.submitted) < self.queue.hourly

    def _submit(self, moment: float) -> None:
        name = f"surrogate-{time.strftime('%H%M%S')}-{len(self.submitted)}"
        log, ended = self.folder / f"{name}.log", self.folder / f"{name}.ended"
        script = self.folder / f"{name}.sh"
        script.write_text(self.queue.script(self.address, name, log.resolve(), ended.resolve()))
        self.submitted.append(moment)
        command = [self.queue.submit] + [str(script)] * (not self.queue.standard_input)
        try:
            with open(script, "rb") as text:
                done = subprocess.run(command, stdin=text, capture_output=True, timeout=60)
        except FileNotFoundError:
            raise SurrogateError(
                f"{self.queue.submit} is not found on this machine; run the study where jobs can "
                "be submitted. Finished runs are kept"
            ) from None
        except subprocess.TimeoutExpired:
            self._failed(f"{self.queue.submit} did not answer within a minute", moment)
            return
        number = re.search(rb"\d+", done.stdout)
        if done.returncode or number is None:
            said = (done.stderr or done.stdout).decode(errors="replace")
            self._failed(f"{self.queue.submit} refused a job: {_end_of(said)}", moment)
        else:
            self.going.append(Job(name, number[0].decode(), log, ended))

    def absence(self) -> str | None:
        """Why no worker is there: None while a job may still bring one."""
        if self.failures < MOST_FAILURES:
            return None
        return (
            f"{self.failures} jobs in a row brought no worker; {self.last_words} (scripts and "
            f"output: {self.folder})"
        )

    def close(self) -> None:
        """Cancel the jobs, end the scheduler."""
        try:
            super().close()
        finally:
            numbers = [job.number for job in self.going if not job.ended.exists()]
            if numbers:
                command = [self.queue.cancel, *numbers]
                try:
                    subprocess.run(command, capture_output=True, timeout=60)
                except (OSError, subprocess.TimeoutExpired):
                    pass  # they end by themselves without a scheduler


def _end_of(text: str) -> str:
    lines = [line.strip() for line in text.strip().splitlines() if line.strip()]
    return " / ".join(lines[-3:])[-300:] or "it printed nothing"
