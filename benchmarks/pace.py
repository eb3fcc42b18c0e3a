"""How fast the command answers: processor and wall time of each verb, of workers, of predictions.

    python benchmarks/pace.py                          this version alone
    python benchmarks/pace.py --other ../v010env/bin/python
    python benchmarks/pace.py --only help schema check

`--other` is the interpreter of a virtual environment that has another version installed, such
as 0.1.0:

    git worktree add ../v010 b2f0b74
    python3 -m venv ../v010env && ../v010env/bin/pip install -e ../v010

Both versions do each task in turn, so that the load of the machine is the same for both. Each
task is a child process; times are those that the kernel counts for it and for the processes
that it waited for (`os.wait4`), the smallest of `--repeat`. Tasks that change their folder are
timed once. Nothing is measured by one version about the other: both get the same words on their
command line and the same Python.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

STUDIES = (
    "import surrogate, pathlib; print(pathlib.Path(surrogate.__file__).parents[1] / 'studies')"
)
LARGE = """
study: large
solver: {name: laplace}
parameters:
  mu_skin:    [0.10, 0.30]
  tension:    {range: [0.059, 0.137], unit: N/mm}
  leg_length: {range: [18.51, 28.99], unit: cm}
  alpha1:     [-0.899, -0.516]
  alpha2:     [-0.069, 0.114]
  alpha3:     [-0.085, 0.097]
  alpha4:     [-0.031, 0.034]
outputs: [pressure_b1]
designs:
  train: {method: latin_hypercube, runs: 1000, seed: 1}
"""
ONE_RUN = """
study: one
solver: {name: ishigami}
parameters: {X1: [-3.14, 3.14], X2: [-3.14, 3.14], X3: [-3.14, 3.14]}
designs: {train: {method: latin_hypercube, runs: 1, seed: 1}}
"""
#: A worker is ready when the first run of a cheap solver is back; one is made, no more.
WORKER = """
import time
from surrogate import Study
if __name__ == "__main__":
    study = Study.from_yaml("one.yaml")
    start = time.perf_counter()
    study.run(workers=1, fresh=True)
    print(time.perf_counter() - start)
"""
#: Processor time of a prediction alone: nugget given and one start, so that the fit is short.
PROCESS = """
import sys, time
import numpy as np
from surrogate.regressors.gaussian_process import GaussianProcess
runs, deviation = int(sys.argv[1]), sys.argv[2] == "deviation"
rng = np.random.default_rng(1)
X, Z = rng.uniform(-1, 1, (runs, 8)), rng.uniform(-1, 1, (100_000, 8))
fit = GaussianProcess(nugget=1e-6, starts=1).fit(X, np.sin(X @ np.arange(1.0, 9.0) / 8))
fit.predict(Z[:1000], return_std=deviation)
start = time.process_time()
fit.predict(Z, return_std=deviation)
print(time.process_time() - start)
"""
AT = (
    "mu_skin=0.2 tension=0.09 leg_length=24 alpha1=-0.7 alpha2=0.02 alpha3=0.0 alpha4=0.0"
).split()
FLOW = "rw=0.1 Hu=1050 Hl=760 L=1400 Kw=11000".split()


@dataclass(frozen=True)
class Task:
    """What is timed: words behind the interpreter, and the goal in seconds of the figure shown.

    changes  its folder, so that it cannot be repeated
    told     the child prints its own figure, which takes the place of its processor time
    """

    name: str
    words: tuple[str, ...]
    goal: float | None = None
    changes: bool = False
    told: bool = False


@dataclass(frozen=True)
class Time:
    """Seconds of the processor and of the wall clock."""

    processor: float
    wall: float


def tasks(studies: Path) -> Iterator[Task]:
    """All tasks in their order: later ones find what earlier ones have left."""
    for verb in ("--help", "--version", "schema", "list"):
        yield _verb(verb.lstrip("-"), verb, goal=0.3)
    yield _verb("new", "new", "flow", changes=True)
    yield _verb("check, new study", "check", "flow.yaml")
    yield _verb("run, new study", "run", "flow.yaml", changes=True)
    yield _verb("run, finished", "run", "flow.yaml")
    yield _verb("status, finished", "status", "flow.yaml")
    yield _verb("report, new study", "report", "flow.yaml")
    yield _verb("predict, new study", "predict", "flow.yaml", *FLOW)
    bandage = str(studies / "bandage_surrogates.yaml")
    yield _verb("check, bandage_surrogates", "check", bandage)
    alone = ("run", bandage, "--workers", "1")
    yield _verb("run, bandage_surrogates, stored runs", *alone, goal=10.0, changes=True)
    yield _verb("run, bandage_surrogates, finished", "run", bandage)
    yield _verb("status, bandage_surrogates", "status", bandage)
    yield _verb("report, bandage_surrogates", "report", bandage, changes=True)
    yield _verb("predict, bandage_surrogates", "predict", bandage, *AT)
    yield _verb("check, 1000 runs of 7 parameters", "check", "large.yaml")
    yield _verb("status, 1000 runs of 7 parameters", "status", "large.yaml")
    yield Task("worker ready (wall)", ("worker.py",), told=True)
    process = "Gaussian process, 1e5 points: "
    yield Task(f"{process}mean, n 1000", ("process.py", "1000", "mean"), 0.5, told=True)
    yield Task(f"{process}deviation, n 300", ("process.py", "300", "deviation"), 2.0, told=True)


def _verb(name: str, *words: str, goal: float | None = None, changes: bool = False) -> Task:
    return Task(name, ("-m", "surrogate", *words), goal, changes)


def measured(python: str, task: Task, folder: Path) -> Time:
    """One child process; NaN, with its words on the error stream, when it fails."""
    with tempfile.TemporaryFile() as said:
        start = time.perf_counter()
        child = subprocess.Popen(
            [python, *task.words], cwd=folder, stdout=said, stderr=subprocess.STDOUT
        )
        _, status, usage = os.wait4(child.pid, 0)
        wall = time.perf_counter() - start
        child.returncode = os.waitstatus_to_exitcode(status)
        said.seek(0)
        words = said.read().decode()
    if child.returncode:
        print(f"{' '.join([python, *task.words])}\n{words}", file=sys.stderr)
        return Time(math.nan, math.nan)
    own = float(words.split()[-1]) if task.told else usage.ru_utime + usage.ru_stime
    return Time(own, wall)


def prepared(folder: Path) -> Path:
    """A folder with the studies and programs of the tasks."""
    folder.mkdir()
    for name, text in {
        "large.yaml": LARGE,
        "one.yaml": ONE_RUN,
        "worker.py": WORKER,
        "process.py": PROCESS,
    }.items():
        (folder / name).write_text(text, encoding="utf-8")
    return folder


def studies_of(python: str, folder: Path) -> Path:
    """The studies that lie beside an installed version: stored runs belong to its solvers."""
    found = subprocess.run(
        [python, "-c", STUDIES], cwd=folder, capture_output=True, text=True, check=True
    )
    return Path(found.stdout.strip())


def compared(pythons: list[str], repeat: int, only: list[str]) -> Iterator[tuple[Task, list[Time]]]:
    """Each task with the times of each interpreter."""
    with tempfile.TemporaryDirectory() as top:
        folders = [prepared(Path(top) / str(k)) for k in range(len(pythons))]
        todo = zip(
            *(tasks(studies_of(*pair)) for pair in zip(pythons, folders, strict=True)), strict=True
        )
        for same in todo:
            if only and not any(word in same[0].name for word in only):
                continue
            count = 1 if same[0].changes else repeat
            rounds = [
                [measured(*given) for given in zip(pythons, same, folders, strict=True)]
                for _ in range(count)
            ]
            yield same[0], [_least(times) for times in zip(*rounds, strict=True)]


def _least(times: tuple[Time, ...]) -> Time:
    return Time(min(t.processor for t in times), min(t.wall for t in times))


def row(task: Task, times: list[Time]) -> str:
    """A line of the table: processor and wall time of each, their ratio, the goal."""
    ours, *others = times
    columns = [f"{ours.processor:9.2f} {ours.wall:9.2f}"]
    for other in others:
        columns.append(f"{other.processor:9.2f} {other.wall:9.2f} {_ratio(other, ours):7.1f}")
    goal = "" if task.goal is None else f"{task.goal:7.1f}"
    if task.goal is not None:
        goal += "  met" if ours.processor <= task.goal else "  missed"
    return f"{task.name:42} {' '.join(columns)} {goal}".rstrip()


def _ratio(other: Time, ours: Time) -> float:
    return other.processor / max(ours.processor, 1e-9)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--other", metavar="PYTHON", help="interpreter with another version")
    parser.add_argument("--repeat", type=int, default=3, help="of each task that can be repeated")
    parser.add_argument("--only", nargs="+", default=[], metavar="WORD", help="tasks with a word")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write the figures, too")
    given = parser.parse_args()
    pythons = [sys.executable, *([given.other] if given.other else [])]
    heads = ["processor      wall", "    other      wall   ratio"][: len(pythons)]
    print(f"{'seconds':42} {' '.join(heads)}    goal", flush=True)
    figures = {}
    for task, times in compared(pythons, given.repeat, given.only):
        print(row(task, times), flush=True)
        figures[task.name] = [[t.processor, t.wall] for t in times]
    if given.json:
        given.json.write_text(json.dumps(figures, indent=1), encoding="utf-8")


if __name__ == "__main__":
    main()
