"""The same study run in three ways, one worker killed in each: equal results, nothing lost.

    python benchmarks/ways.py [--runs 400] [--milliseconds 50]

`surrogate run` on this machine, `surrogate run` on a dask cluster that `dask scheduler` and
`dask worker` started, and three `surrogate work` processes on one folder. The solver writes
down when it is called and when it answers. In a run a worker is killed (SIGKILL): a
process of the solver, a dask worker, a `surrogate work`. Counted are runs without an answer
(lost) and runs that were done again although their record was written (twice): both must be 0,
calls at most runs + killed, and the results equal to the last digit.
"""

from __future__ import annotations

import argparse
import json
import os
import signal
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from surrogate.runs.record import from_line
from surrogate.study.study import Study

#: Runs at once, and seconds after which a `surrogate work` without a sign of life is gone.
PLACES, LEASE = 3, 5.0
#: Longest time of one way in seconds, besides that of its runs.
PATIENCE = 300.0

SOLVER = """
import os
import time
import numpy as np
from surrogate.solver import Input, Output

class Diary:
    version = "1"
    inputs = {"a": Input(), "b": Input()}
    outputs = {"y": Output(), "wave": Output(dims=("t",), coordinates={"t": np.arange(5.0)})}
    def __init__(self, seconds):
        self.seconds = seconds
    def note(self, word, a, b):
        line = f"{word} {os.getpid()} {os.getppid()} {time.time()!r} {a!r} {b!r}\\n"
        with open(os.environ["SURROGATE_DIARY"], "a") as diary:
            diary.write(line)
    def __call__(self, a, b):
        self.note("call", a, b)
        time.sleep(self.seconds)
        wave = np.sin(a + np.arange(5.0)) * np.exp(b)
        self.note("answer", a, b)
        return {"y": float(wave.sum()), "wave": wave}
"""

STUDY = """
study: ways
solver: {{name: "diary:Diary", options: {{seconds: {seconds}}}}}
parameters: {{a: [0, 3], b: [-1, 1]}}
designs: {{train: {{method: sobol, runs: {runs}, seed: 1}}}}
surrogates: {{linear: {{method: linear}}}}
execution: {execution}
"""


@dataclass(frozen=True)
class Count:
    """What came of one way: the diary's lines, and the values of all runs (run, output)."""

    runs: int
    calls: int
    killed: int
    lost: int
    twice: int
    values: NDArray[np.float64]


@dataclass(frozen=True)
class Note:
    """A line of the diary."""

    word: str
    process: int
    parent: int
    moment: float
    point: tuple[float, ...]


def _note(word: str, process: str, parent: str, moment: str, *point: str) -> Note:
    return Note(word, int(process), int(parent), float(moment), tuple(map(float, point)))


@dataclass
class Arena:
    """A folder with the study, its results and the diary of its solver."""

    folder: Path
    runs: int
    seconds: float
    execution: str

    def __post_init__(self) -> None:
        self.started: list[subprocess.Popen[bytes]] = []
        self.folder.mkdir()
        (self.folder / "diary.py").write_text(SOLVER)
        text = STUDY.format(runs=self.runs, seconds=self.seconds, execution=self.execution)
        (self.folder / "study.yaml").write_text(text)

    @contextmanager
    def process(self, *command: str) -> Iterator[subprocess.Popen[bytes]]:
        """A process on the folder, ended with all that it started."""
        path = os.pathsep.join(filter(None, (str(self.folder), os.environ.get("PYTHONPATH"))))
        diary = str(self.folder / "diary.txt")
        with open(self.folder / "output.txt", "ab") as output:
            made = subprocess.Popen(
                [sys.executable, "-m", *command],
                cwd=self.folder,
                env={**os.environ, "PYTHONPATH": path, "SURROGATE_DIARY": diary},
                stdout=output,
                stderr=output,
                start_new_session=True,
            )
        self.started.append(made)
        try:
            yield made
        finally:
            if made.poll() is None:
                os.killpg(made.pid, signal.SIGTERM)
                made.wait(30)

    def notes(self) -> list[Note]:
        """The diary so far, without a line that is not whole."""
        path = self.folder / "diary.txt"
        whole = path.read_text().rpartition("\n")[0] if path.exists() else ""
        return [_note(*line.split()) for line in whole.splitlines()]

    def finished(self) -> dict[tuple[float, ...], list[float]]:
        """When each point was finished: the records of all files of the journal."""
        found: dict[tuple[float, ...], list[float]] = {}
        for path in (self.folder / "results/ways/journal").glob("**/*.jsonl"):
            for record in map(from_line, path.read_bytes().splitlines()):
                point = (float(record.inputs["a"]), float(record.inputs["b"]))
                found.setdefault(point, []).append(record.finished)
        return found

    def wait(self, done: Callable[[], bool]) -> None:
        """Until something is so; a process that fails ends the benchmark with its output."""
        until = time.monotonic() + PATIENCE + self.runs * self.seconds
        while not done():
            failed = any(one.returncode > 0 for one in self.started if one.poll() is not None)
            if failed or time.monotonic() > until:
                raise RuntimeError((self.folder / "output.txt").read_text()[-2000:])
            time.sleep(0.02)

    def kill_in_the_middle(self, parent: bool) -> None:
        """End the process that calls the solver, or its parent, in a run, a third being done."""

        def third() -> bool:
            notes = self.notes()
            done = sum(note.word == "answer" for note in notes)
            return done >= self.runs // 3 and notes[-1].word == "call"

        self.wait(third)
        last = self.notes()[-1]
        time.sleep(self.seconds / 2)  # an answer of before stands in the journal by now
        os.kill(last.parent if parent else last.process, signal.SIGKILL)

    def end(self, processes: Sequence[subprocess.Popen[bytes]]) -> Count:
        """Wait for the processes, then count; those that were killed ended with a signal."""
        self.wait(lambda: all(one.poll() is not None for one in processes))
        runs = Study.from_yaml(self.folder / "study.yaml").stored(self.folder / "results/ways")
        calls = [note for note in self.notes() if note.word == "call"]
        finished = self.finished()
        again = sum(note.moment > min(finished[note.point]) for note in calls)
        values = np.column_stack([runs["y"].values, runs["wave"].values])
        return Count(
            runs.sizes["run"],
            len(calls),
            1,
            int((runs["status"] != "ok").sum()),
            again + sum(len(moments) - 1 for moments in finished.values()),
            values,
        )


def local(folder: Path, runs: int, seconds: float) -> Count:
    """`surrogate run` on this machine; a process of the solver is killed."""
    arena = Arena(folder, runs, seconds, json.dumps({"executor": "local", "places": PLACES}))
    with arena.process("surrogate", "run", "study.yaml") as run:
        arena.kill_in_the_middle(parent=False)
        return arena.end([run])


def dask(folder: Path, runs: int, seconds: float) -> Count:
    """`surrogate run` on a dask cluster; a dask worker is killed."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    address = f"tcp://127.0.0.1:{port}"
    execution = {"executor": "dask", "options": {"address": address}}
    arena = Arena(folder, runs, seconds, json.dumps(execution))
    with ExitStack() as stack:
        stack.enter_context(
            arena.process("dask", "scheduler", "--host", "127.0.0.1", "--port", str(port))
        )
        words = ("worker", address, "--nthreads", "1", "--nworkers", str(PLACES))
        stack.enter_context(arena.process("dask", *words))
        run = stack.enter_context(arena.process("surrogate", "run", "study.yaml"))
        arena.kill_in_the_middle(parent=True)
        return arena.end([run])


def shared(folder: Path, runs: int, seconds: float) -> Count:
    """Three `surrogate work` on one folder; one of them is killed."""
    execution = {"executor": "shared_folder", "options": {"lease": LEASE}}
    arena = Arena(folder, runs, seconds, json.dumps(execution))
    with ExitStack() as stack:
        words = ("surrogate", "work", "study.yaml", "--workers", "1")
        team = [stack.enter_context(arena.process(*words)) for _ in range(PLACES)]
        arena.kill_in_the_middle(parent=True)
        return arena.end(team)


WAYS: dict[str, Callable[[Path, int, float], Count]] = {
    "local": local,
    "dask": dask,
    "surrogate work": shared,
}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=int, default=400)
    parser.add_argument("--milliseconds", type=float, default=50.0)
    options = parser.parse_args()
    words = ("way", "runs", "calls", "killed", "lost", "twice", "largest difference", "s")
    print(f"{words[0]:16}" + "".join(f"{word:>{len(word) + 4}}" for word in words[1:]))
    first = None
    with tempfile.TemporaryDirectory(prefix="ways-") as place:
        for number, (name, way) in enumerate(WAYS.items()):
            start = time.monotonic()
            count = way(Path(place) / str(number), options.runs, options.milliseconds / 1000)
            first = count.values if first is None else first
            difference = float(np.abs(count.values - first).max())
            print(
                f"{name:16}{count.runs:8}{count.calls:9}{count.killed:10}{count.lost:8}"
                f"{count.twice:9}{difference:22g}{time.monotonic() - start:5.0f}",
                flush=True,
            )


if __name__ == "__main__":
    main()
