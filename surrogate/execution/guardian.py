"""Ends what a worker has started, also when the program itself is killed.

The program starts this file as a process of its own, `guardian.py FOLDER PROCESS`, and
tells it of its workers. When the program is gone, whatever ended it, the guardian ends the
workers with all that they started and removes the temporary folder. A worker cannot do so:
it may sit in C code that holds the interpreter, and its children may have left its process
group and session. Uses the standard library only and starts fast.
"""

from __future__ import annotations

import os
import select
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

#: Seconds between two looks whether the program still lives, and to wait for an end.
PATIENCE = 1.0


class Guardian:
    """The program's hold on its guardian; where there are no process groups it does nothing.

    folder: temporary folder of the program, removed at the end.
    """

    def __init__(self, folder: Path):
        self.process: subprocess.Popen[bytes] | None = None
        if hasattr(os, "killpg"):
            self.process = subprocess.Popen(
                [sys.executable, "-I", "-S", __file__, str(folder), str(os.getpid())],
                stdin=subprocess.PIPE,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
                start_new_session=True,
            )

    def watch(self, worker: int, place: Path) -> None:
        """End this worker when the program ends; place: its temporary folder."""
        self._tell(f"{worker} {place}\n")

    def forget(self, worker: int) -> None:
        """The worker has ended."""
        self._tell(f"{worker} \n")

    def _tell(self, line: str) -> None:
        if self.process is not None and self.process.stdin is not None:
            with suppress(OSError):  # somebody killed it; workers still end with their program
                self.process.stdin.write(os.fsencode(line))
                self.process.stdin.flush()

    def dismiss(self) -> None:
        """All workers have ended, and the folder is removed."""
        if self.process is not None:
            with suppress(OSError, subprocess.TimeoutExpired):
                self.process.communicate(timeout=10 * PATIENCE)


class _Process(NamedTuple):
    parent: int
    session: int
    alive: bool


def tree(places: Mapping[int, Path]) -> set[int]:
    """Processes that workers started, themselves included.

    places: temporary folder of each worker, by its process. To a worker belong its session,
    the processes that have its temporary folder in their environment, and all their
    descendants. Empty where the system has no /proc.
    """
    marks = [b"TMPDIR=" + os.fsencode(place) for place in places.values()]
    running = _running()
    found = {
        pid
        for pid, process in running.items()
        if pid in places or process.session in places or (marks and _is_marked(pid, marks))
    }
    more = found
    while more:
        more = {pid for pid, process in running.items() if process.parent in found} - found
        found |= more
    return {pid for pid in found if running[pid].alive} - {os.getpid()}


def _running() -> dict[int, _Process]:
    processes = {}
    for name in os.listdir("/proc") if os.path.exists("/proc/self/stat") else ():
        if name.isdecimal():
            with suppress(OSError, ValueError, IndexError):
                with open(f"/proc/{name}/stat", "rb") as file:
                    state, parent, _, session = file.read().rpartition(b")")[2].split()[:4]
                processes[int(name)] = _Process(
                    int(parent), int(session), state not in (b"Z", b"X")
                )
    return processes


def _is_marked(pid: int, marks: list[bytes]) -> bool:
    with suppress(OSError), open(f"/proc/{pid}/environ", "rb") as file:
        return not set(file.read().split(b"\0")).isdisjoint(marks)
    return False


def end(places: Mapping[int, Path], known: Iterable[int] = ()) -> None:
    """Kill workers and all that they started; `known`: more processes to kill.

    All are stopped before the first is killed: what a dead process has started is hard to find.
    """
    if not hasattr(os, "killpg"):
        return
    stopped: set[int] = set()
    found = set(known) | tree(places)
    until = time.monotonic() + PATIENCE
    while found and time.monotonic() < until:
        _send(signal.SIGSTOP, found)
        stopped |= found
        found = tree(places) - stopped
    _send(signal.SIGKILL, stopped | found)
    for worker in places:
        with suppress(ProcessLookupError, PermissionError):
            os.killpg(worker, signal.SIGKILL)


def _send(number: signal.Signals, processes: Iterable[int]) -> None:
    for process in processes:
        with suppress(ProcessLookupError, PermissionError):
            os.kill(process, number)


def main() -> None:
    """Listen to the program until it is gone, then end what it left."""
    folder, program = Path(sys.argv[1]), int(sys.argv[2])
    places: dict[int, Path] = {}
    heard = b""
    while os.getppid() == program:
        if not select.select([0], [], [], PATIENCE)[0]:
            continue
        data = os.read(0, 1 << 16)
        if not data:
            break
        *lines, heard = (heard + data).split(b"\n")
        for line in lines:
            worker, _, place = line.partition(b" ")
            if place:
                places[int(worker)] = Path(os.fsdecode(place))
            else:
                places.pop(int(worker), None)
    end(places)
    shutil.rmtree(folder, ignore_errors=True)


if __name__ == "__main__":
    main()
