"""A worker process as its program sees it: what it does now, and why it ended."""

from __future__ import annotations

import shutil
import signal
from collections import deque
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass, field
from multiprocessing.process import BaseProcess
from pathlib import Path

from surrogate.execution import guardian
from surrogate.execution.channel import Channel
from surrogate.execution.clock import TICK
from surrogate.runs.identity import RunInputs

#: Bytes at the end of what a worker printed in which its last line is looked for.
LAST_BYTES = 4096

#: Signals by which systems, schedulers and people end a process that did nothing wrong.
FROM_OUTSIDE = {
    getattr(signal, name)
    for name in ("SIGKILL", "SIGTERM", "SIGHUP", "SIGINT", "SIGQUIT", "SIGPWR", "SIGXCPU")
    if hasattr(signal, name)
}


@dataclass
class Task:
    """A run to do: its key, the solver's arguments, and the attempts made so far.

    number: tells the run's answer from all others of a pool; given when a worker gets it.
    """

    key: str
    call: RunInputs
    attempts: int = 0
    number: int = 0


@dataclass
class WorkerHandle:
    """A worker: its process and pipe, and the runs that it was given, the present one first.

    place  its temporary folder; what it prints goes to a file beside it
    since  when it began to start, or began its present run (`RunClock`)
    """

    process: BaseProcess
    channel: Channel
    place: Path
    since: float
    ready: bool = False
    busy: bool = False
    tasks: deque[Task] = field(default_factory=deque)

    @property
    def pid(self) -> int:
        """The process's number."""
        assert self.process.pid is not None  # it was started
        return self.process.pid

    def kill(self, known: Iterable[int] = ()) -> None:
        """End the worker and what it started (`known`: more of that); remove its files."""
        guardian.end({self.pid: self.place}, known)
        self.process.kill()
        self.process.join(10 * TICK)  # longer only where a disk of the network hangs
        self.channel.close()
        shutil.rmtree(self.place, ignore_errors=True)

    def has_left(self) -> bool:
        """True when the process has ended."""
        return not self.process.is_alive()

    def cause(self) -> tuple[str, bool]:
        """Why it ended, and whether that came from outside; to be asked when it has."""
        code = self.process.exitcode
        reason = f"the worker {_cause(code)}{self.last_words()}"
        return reason, code is not None and -code in FROM_OUTSIDE

    def last_words(self) -> str:
        """Last line that the worker printed, as the end of a sentence."""
        with suppress(OSError), open(self.place.with_suffix(".txt"), "rb") as file:
            file.seek(max(0, file.seek(0, 2) - LAST_BYTES))
            lines = file.read().decode(errors="replace").strip().splitlines()
            if lines:
                return f"; it printed last: {lines[-1].strip()[:200]}"
        return ""


def _cause(exitcode: int | None) -> str:
    if exitcode is None:
        return "closed its connection"
    if exitcode >= 0:
        return f"ended by itself with exit code {exitcode}"
    with suppress(ValueError):
        name = signal.Signals(-exitcode).name
        hint = ", which the system sends when memory runs out" if name == "SIGKILL" else ""
        return f"was killed by {name}{hint}"
    return f"was killed by signal {-exitcode}"
