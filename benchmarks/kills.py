"""What kill -9 costs: of workers, of the program, of dask's scheduler, of `surrogate work`.

    python benchmarks/kills.py [--kills 1000] [--only workers program work scheduler]

A fast solver writes down its calls. Something is killed at a random moment, again and again,
and what is left is started again. Counted are finished runs that are lost, finished runs that
are done twice, and processes that are still there 30 s after their program has gone. All must
be 0. About two seconds a kill.
"""

from __future__ import annotations

import argparse
import os
import random
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import textwrap
import time
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

from surrogate.runs.journal import read
from surrogate.runs.record import from_line

#: Runs of a study, after which the next one begins.
RUNS = 300
#: Seconds that a process may outlive its program.
PATIENCE = 30.0
MARK = "SURROGATE_KILLS"

SOLVER = """
import time
from surrogate.solver import Input, Output

class Diary:
    version, inputs, outputs = "1", {"x": Input()}, {"y": Output()}
    def __init__(self, path):
        self.path = path
    def __call__(self, x):
        with open(self.path, "a") as file:
            file.write(f"{x!r}\\n")
        time.sleep(0.003)
        return {"y": x * x}
"""

PROGRAM = textwrap.dedent("""
    import sys
    from functools import partial
    import numpy as np
    sys.path.insert(0, {folder!r})
    from diary import Diary
    from surrogate.execution.execute import execute
    from surrogate.execution.shared.work import work
    from surrogate.execution.executors.dask import dask
    from surrogate.runs.identity import SolverSpec
    {verb}(
        SolverSpec("diary", Diary, dict(path={folder!r} + "/diary")),
        {{"x": np.arange({first}.0, {first}.0 + {runs})}},
        journal={folder!r} + "/journal", workers=2, retries=1000, {more}
    )
""")


@dataclass
class Count:
    """What was seen of one kind of kill."""

    kills: int = 0
    lost: int = 0
    twice: int = 0
    orphans: int = 0
    runs: int = 0


class Marked(subprocess.Popen[bytes]):
    """A silent process whose descendants are known by the mark in their environment."""

    def __init__(self, command: list[str], mark: str, path: str) -> None:
        self.mark = mark
        super().__init__(
            command,
            env={**os.environ, "PYTHONPATH": path, MARK: mark},
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
        )


@dataclass
class Arena:
    """A folder with a journal and a diary, and the processes that were started on it."""

    folder: Path
    draw: random.Random
    count: Count = field(default_factory=Count)
    first: int = 0
    read_to: int = 0
    done: set[float] = field(default_factory=set)
    marks: dict[str, float] = field(default_factory=dict)
    serial: int = 0

    def start(self, verb: str = "execute", more: str = "") -> Marked:
        """A program that does the runs that are left."""
        text = PROGRAM.format(
            folder=str(self.folder), verb=verb, first=self.first, runs=RUNS, more=more
        )
        return self.process([sys.executable, "-c", text])

    def process(self, command: list[str]) -> Marked:
        """A process whose modules lie in the folder, too."""
        self.serial += 1
        path = os.pathsep.join(filter(None, (str(self.folder), os.environ.get("PYTHONPATH"))))
        return Marked(command, f"{self.folder.name}-{self.serial}", path)

    def kill(self, process: Marked) -> None:
        """Kill it; what belongs to it must be gone `PATIENCE` later."""
        with suppress(ProcessLookupError):
            process.send_signal(signal.SIGKILL)
        process.wait()
        self.has_gone(process)

    def has_gone(self, process: Marked) -> None:
        """From now on nothing of this process may be left for long."""
        self.marks[process.mark] = time.monotonic()

    def check(self) -> None:
        """Compare journal and diary with what was done before; see who outlives whom."""
        # The journal first: what stands in it was called before, and is in the diary by now.
        records = read(self.folder / "journal").records.values()
        lines = (self.folder / "diary").read_bytes() if (self.folder / "diary").exists() else b""
        whole = lines[self.read_to : lines.rfind(b"\n") + 1]
        called = {float(x) for x in whole.split()}
        self.count.twice += len(called & self.done)
        self.read_to += len(whole)
        now_done = {float(r.inputs["x"]) for r in records if r.status == "ok"}
        self.count.lost += len(self.done - now_done)
        self.done = now_done
        self.count.runs = len(now_done)
        self._look_for_orphans()

    def _look_for_orphans(self) -> None:
        old = {m for m, since in self.marks.items() if time.monotonic() - since > PATIENCE}
        if old:
            found = Counter(mark for _, mark in marked() if mark in old)
            self.count.orphans += sum(found.values())
            self.marks = {m: since for m, since in self.marks.items() if m not in old}

    def finish(self) -> None:
        """The last look: records that stand twice, and processes after the last patience."""
        if self.marks:
            time.sleep(max(0.0, PATIENCE + 0.5 - (time.monotonic() - max(self.marks.values()))))
        self.check()
        paths = [*(self.folder / "journal").glob("**/*.jsonl")]
        lines = [line for path in paths for line in path.read_bytes().splitlines()]
        good = Counter(r.key for r in map(from_line, whole(lines)) if r.status == "ok")
        self.count.twice += sum(n - 1 for n in good.values())

    def wait_for_calls(self, process: subprocess.Popen[bytes]) -> None:
        """Until the solver is called."""
        path, until = self.folder / "diary", time.monotonic() + 60.0
        before = path.stat().st_size if path.exists() else 0
        while process.poll() is None and time.monotonic() < until:
            if path.exists() and path.stat().st_size > before:
                return
            time.sleep(0.02)

    def next_study(self) -> None:
        """All runs are done: new ones."""
        self.first += RUNS


def whole(lines: list[bytes]) -> Iterator[bytes]:
    """Lines that are records; a torn one was never finished."""
    for line in lines:
        with suppress(ValueError):
            from_line(line)
            yield line


def marked() -> Iterator[tuple[int, str]]:
    """Processes with a mark."""
    for name in os.listdir("/proc"):
        if name.isdecimal():
            with suppress(OSError):
                state = Path(f"/proc/{name}/stat").read_text().rpartition(")")[2].split()[0]
                for word in Path(f"/proc/{name}/environ").read_bytes().split(b"\0"):
                    if word.startswith(MARK.encode() + b"=") and state not in "ZX":
                        yield int(name), word.decode().partition("=")[2]


def ended(process: subprocess.Popen[bytes], seconds: float) -> bool:
    """Whether it ends within a time."""
    with suppress(subprocess.TimeoutExpired):
        process.wait(seconds)
    return process.poll() is not None


def workers(arena: Arena, kills: int) -> None:
    """Worker processes of a run."""
    program = arena.start()
    while arena.count.kills < kills:
        if ended(program, arena.draw.uniform(0.0, 0.4)):
            arena.has_gone(program)
            arena.check()
            if program.returncode == 0:
                arena.next_study()
            program = arena.start()
            continue
        children = [
            pid
            for pid, mark in marked()
            if mark == program.mark and b"spawn_main" in command_of(pid)
        ]
        if children:
            with suppress(ProcessLookupError):
                os.kill(arena.draw.choice(children), signal.SIGKILL)
                arena.count.kills += 1
        if arena.count.kills % 20 == 0:
            arena.check()
    arena.kill(program)


def command_of(pid: int) -> bytes:
    """Its command line."""
    with suppress(OSError):
        return Path(f"/proc/{pid}/cmdline").read_bytes()
    return b""


def program(arena: Arena, kills: int) -> None:
    """The main process of a run."""
    while arena.count.kills < kills:
        running = arena.start()
        if arena.draw.random() < 0.8:  # else while it starts
            arena.wait_for_calls(running)
        if ended(running, arena.draw.uniform(0.0, 0.8)):
            arena.has_gone(running)
            arena.next_study()
        else:
            arena.kill(running)
            arena.count.kills += 1
        arena.check()


def work(arena: Arena, kills: int) -> None:
    """One of three `surrogate work` processes."""
    more = "lease=2.0"
    team = [arena.start("work", more) for _ in range(3)]
    while arena.count.kills < kills:
        victim = arena.draw.randrange(3)
        if arena.draw.random() < 0.8:
            arena.wait_for_calls(team[victim])
        time.sleep(arena.draw.uniform(0.0, 0.8))
        if all(one.poll() == 0 for one in team):
            arena.next_study()
        if team[victim].poll() is None:
            arena.kill(team[victim])
            arena.count.kills += 1
        for n, one in enumerate(team):
            if one.poll() is not None:
                arena.has_gone(one)
                if n == victim or all(o.poll() is not None for o in team):
                    team[n] = arena.start("work", more)
        arena.check()
    for one in team:
        arena.kill(one)


def scheduler(arena: Arena, kills: int) -> None:
    """The scheduler of a dask cluster."""
    while arena.count.kills < kills:
        with socket.socket() as probe:
            probe.bind(("127.0.0.1", 0))
            port = probe.getsockname()[1]
        address = f"tcp://127.0.0.1:{port}"
        command = [sys.executable, "-m"]
        head = arena.process(
            [*command, "distributed.cli.dask_scheduler", "--port", str(port)]
            + ["--host", "127.0.0.1", "--no-dashboard", "--dashboard-address", ":0"]
        )
        crew = arena.process(
            [*command, "distributed.cli.dask_worker", address, "--nworkers", "2"]
            + ["--nthreads", "1", "--no-dashboard", "--death-timeout", "30"]
        )
        while True:
            running = arena.start(more=f"executor=partial(dask, address={address!r})")
            arena.wait_for_calls(running)
            if not ended(running, arena.draw.uniform(0.0, 1.5)):
                break
            arena.has_gone(running)
            arena.next_study()
        head.kill()
        head.wait()
        arena.count.kills += 1
        if not ended(running, 90.0):
            print("the program did not notice that the scheduler was gone", flush=True)
        arena.kill(running)
        os.killpg(crew.pid, signal.SIGKILL)
        for one in (head, crew):
            arena.kill(one)
        arena.check()


#: What is killed, and its share of the kills.
WAYS: dict[str, tuple[Callable[[Arena, int], None], float]] = {
    "workers": (workers, 0.75),
    "program": (program, 0.12),
    "work": (work, 0.12),
    "scheduler": (scheduler, 0.01),
}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--kills", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", nargs="*", choices=WAYS, default=list(WAYS))
    options = parser.parse_args()
    share = sum(WAYS[name][1] for name in options.only)
    print(f"{'killed':12}{'kills':>8}{'runs':>8}{'lost':>8}{'twice':>8}{'orphans':>9}{'s':>8}")
    bad = 0
    for name in options.only:
        way, part = WAYS[name]
        start = time.monotonic()
        arena = Arena(Path(tempfile.mkdtemp(prefix="kills-")), random.Random(options.seed))
        (arena.folder / "diary.py").write_text(SOLVER)
        way(arena, max(1, round(options.kills * part / share)))
        arena.finish()
        c = arena.count
        bad += c.lost + c.twice + c.orphans
        print(
            f"{name:12}{c.kills:8}{c.runs:8}{c.lost:8}{c.twice:8}{c.orphans:9}"
            f"{time.monotonic() - start:8.0f}",
            flush=True,
        )
        shutil.rmtree(arena.folder, ignore_errors=True)
    sys.exit(1 if bad else 0)


if __name__ == "__main__":
    main()
