"""Local worker processes, one pipe each, so that the loss of one harms no other.

A worker gets several short runs in one message, and tells the end of each at once.
It gets the next message when it asks for it, so the two never wait for each other.
"""

from __future__ import annotations

import os
import pickle
import signal
import tempfile
import time
from collections import deque
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from pathlib import Path

from surrogate.errors import PluginError
from surrogate.execution.answers import Outcome
from surrogate.execution.spawning import parcel, start
from surrogate.execution.workers import BATCH_SECONDS, work
from surrogate.runs.identity import RunInputs, SolverSpec
from surrogate.solver import Output

#: Longest pause between two looks at the clock, in seconds.
TICK = 0.2

#: Most runs in one message: bounds what a message and a lost batch can hold.
LARGEST_BATCH = 100

#: Workers that may die in a row before they have built the solver.
FALSE_STARTS = 3


@dataclass
class Task:
    """A run to do: its key, the solver's arguments, and the attempts made so far."""

    key: str
    call: RunInputs
    attempts: int = 0


Event = tuple[Task, Outcome] | None


@dataclass
class _Worker:
    process: BaseProcess
    connection: Connection
    printed: Path
    ready: bool = False
    busy: bool = False
    tasks: deque[Task] = field(default_factory=deque)
    since: float = 0.0

    def kill(self) -> None:
        """End the worker and what it started."""
        with suppress(ProcessLookupError, PermissionError):
            if hasattr(os, "killpg"):
                os.killpg(self.process.pid, signal.SIGKILL)
        self.process.kill()
        self.process.join()
        self.connection.close()

    def last_words(self) -> str:
        """Last line that the worker printed, as the end of a sentence."""
        with suppress(OSError):
            lines = self.printed.read_text(errors="replace").strip().splitlines()
            if lines:
                return f"; it printed last: {lines[-1].strip()[:200]}"
        return ""


@dataclass
class Pool:
    """`workers` processes that answer the tasks of a queue.

    threads  for numerical libraries in each worker; timeout: seconds a run may take, or None
    """

    spec: SolverSpec
    wanted: Mapping[str, Output]
    workers: int
    threads: int
    timeout: float | None = None

    def __post_init__(self):
        self._parcel = parcel(self.spec)
        self._team: list[_Worker] = []
        self._false_starts = 0
        self._mean_seconds: float | None = None

    def results(self, queue: deque[Task], stopping: Callable[[], bool]) -> Iterator[Event]:
        """Yield (task, outcome) as runs end, and None now and then when none does.

        Whoever consumes it may append tasks to the queue. It ends when the queue is empty
        and no run goes on, or after `stopping()`: then finished runs are still yielded and
        the others are given up. Raises `PluginError` when workers cannot build the solver.
        """
        with tempfile.TemporaryDirectory(prefix="surrogate-") as folder:
            try:
                while not stopping() and (queue or any(w.tasks for w in self._team)):
                    self._hire(Path(folder), queue)
                    self._feed(queue)
                    yield from self._listen(queue)
                    yield from self._end_overdue(queue)
                    yield None
                for worker in self._team:
                    yield from self._drain(worker, queue)
            finally:
                self._dismiss()

    def _hire(self, folder: Path, queue: deque[Task]) -> None:
        needed = min(self.workers, len(queue) + sum(bool(w.tasks) for w in self._team))
        while len(self._team) < needed:
            self._team.append(self._start(folder))

    def _start(self, folder: Path) -> _Worker:
        number, printed = tempfile.mkstemp(dir=folder)
        os.close(number)
        process, connection = start(work, self._parcel, self.wanted, self.threads, printed)
        return _Worker(process, connection, Path(printed))

    def _feed(self, queue: deque[Task]) -> None:
        for worker in self._team:
            if queue and worker.ready and not worker.busy:
                batch = [queue.popleft() for _ in range(self._batch_size(len(queue)))]
                worker.tasks.extend(batch)
                worker.busy, worker.since = True, time.monotonic()
                with suppress(OSError):  # a worker that just died is found by _listen
                    worker.connection.send([(i, task.call) for i, task in enumerate(batch)])

    def _batch_size(self, waiting: int) -> int:
        """Runs that fill `BATCH_SECONDS`, at most a fair share of those that wait."""
        if self._mean_seconds is None:
            return 1
        fitting = BATCH_SECONDS / max(self._mean_seconds, 1e-6)
        share = -(-waiting // (2 * self.workers))
        return max(1, min(int(fitting), share, LARGEST_BATCH))

    def _listen(self, queue: deque[Task]) -> Iterator[Event]:
        pause = TICK
        if self.timeout is not None:
            ends = [w.since + self.timeout for w in self._team if w.tasks]
            pause = max(0.0, min([TICK, *(end - time.monotonic() for end in ends)]))
        heard = set(wait([w.connection for w in self._team], pause))
        for worker in list(self._team):
            alive = True
            if worker.connection in heard:
                alive, event = self._receive(worker, queue)
                if event:
                    yield event
            elif not heard:
                alive = worker.process.is_alive()
            if not alive:
                yield from self._bury(worker, queue)

    def _receive(self, worker: _Worker, queue: deque[Task]) -> tuple[bool, Event]:
        """Whether the worker still talks, and the run that it tells of."""
        try:
            message = worker.connection.recv()
        except (EOFError, OSError, pickle.UnpicklingError):
            return False, None
        if isinstance(message, str):
            raise PluginError(
                f"solver {self.spec.name} cannot be built in a worker process: {message}"
            )
        if message is None:
            if not worker.ready:
                self._false_starts = 0
            worker.ready, worker.busy = True, False
            queue.extendleft(reversed(worker.tasks))
            worker.tasks.clear()
            return True, None
        task, outcome = worker.tasks.popleft(), message[1]
        worker.since = time.monotonic()
        mean = self._mean_seconds
        self._mean_seconds = outcome.seconds if mean is None else 0.9 * mean + 0.1 * outcome.seconds
        return True, (task, outcome)

    def _drain(self, worker: _Worker, queue: deque[Task]) -> Iterator[Event]:
        """Runs that the worker finished and that still lie in its pipe."""
        talks = True
        while talks and worker.connection.poll():
            talks, event = self._receive(worker, queue)
            if event:
                yield event

    def _bury(self, worker: _Worker, queue: deque[Task]) -> Iterator[Event]:
        """Take a dead worker out: the run that it was at failed, the others wait again."""
        yield from self._drain(worker, queue)
        self._team.remove(worker)
        worker.process.join(TICK)
        reason = f"the worker {_cause(worker.process.exitcode)}{worker.last_words()}"
        worker.kill()
        if not worker.ready:
            self._count_false_start(reason)
        yield from self._lose_run(worker, queue, "failed", reason)

    def _count_false_start(self, reason: str) -> None:
        """Go on with fewer workers where some work (memory for no more), else give up."""
        self._false_starts += 1
        if self._parcel.needs_main:
            reason += (
                ". It runs the script again to find the solver in it: put the script's own "
                'calls below `if __name__ == "__main__":`'
            )
        elif self._false_starts < FALSE_STARTS:
            return
        working = sum(worker.ready for worker in self._team)
        if not working:
            raise PluginError(
                f"solver {self.spec.name} cannot be built in a worker process: {reason}"
            )
        self.workers, self._false_starts = working, 0

    def _end_overdue(self, queue: deque[Task]) -> Iterator[Event]:
        if self.timeout is None:
            return
        for worker in list(self._team):
            if worker.tasks and time.monotonic() - worker.since >= self.timeout:
                head = worker.tasks[0]
                yield from self._drain(worker, queue)
                if worker.tasks and worker.tasks[0] is head:
                    self._team.remove(worker)
                    worker.kill()
                    message = f"stopped after {self.timeout:g} s, the time limit of a run"
                    yield from self._lose_run(
                        worker, queue, "timed_out", message + worker.last_words()
                    )

    def _lose_run(
        self, worker: _Worker, queue: deque[Task], status: str, message: str
    ) -> Iterator[Event]:
        if worker.tasks:
            task = worker.tasks.popleft()
            queue.extendleft(reversed(worker.tasks))
            worker.tasks.clear()
            seconds = time.monotonic() - worker.since
            yield task, Outcome(status, message, seconds, answered=False)

    def _dismiss(self) -> None:
        """End all workers; idle ones may leave by themselves first."""
        for worker in self._team:
            if worker.ready and not worker.busy:
                with suppress(OSError):
                    worker.connection.send(None)
        end = time.monotonic() + 1.0
        for worker in self._team:
            if worker.ready and not worker.busy:
                worker.process.join(max(0.0, end - time.monotonic()))
            worker.kill()
        self._team.clear()


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
