"""Local worker processes, one pipe each, so that the loss of one harms no other.

A worker gets several short runs in one message, and tells the end of each at once.
It gets the next message when it asks for it, so the two never wait for each other.
"""

from __future__ import annotations

import secrets
import time
from collections import deque
from collections.abc import Generator, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from itertools import count
from multiprocessing.connection import wait
from pathlib import Path

from surrogate.errors import PluginError, SurrogateError
from surrogate.execution import guardian, memory
from surrogate.execution.answers import Outcome
from surrogate.execution.backend import Event
from surrogate.execution.channel import TOKEN_BYTES, Channel, Garbled
from surrogate.execution.clock import TICK, RunClock
from surrogate.execution.folder import owned_folder, worker_place
from surrogate.execution.guardian import Guardian
from surrogate.execution.handle import Task, WorkerHandle
from surrogate.execution.spawning import parcel, start
from surrogate.execution.stopping import Stop
from surrogate.execution.workers import BATCH_SECONDS, Message, work
from surrogate.runs.identity import SolverSpec
from surrogate.solver import Output

#: Most runs in one message: bounds what a message and a lost batch can hold.
LARGEST_BATCH = 100

#: Workers that may end in a row before they have built the solver; `retries` come on top
#: for those that are killed from outside.
FALSE_STARTS = 3

#: Least limit, in seconds, for starting a worker and building the solver where runs have one.
BUILD_SECONDS = 30.0

#: Seconds between two attempts to send what found no room in a pipe.
FLUSH_SECONDS = 0.01


@dataclass
class Pool:
    """`workers` processes that answer the tasks of a queue.

    threads  for numerical libraries in each worker; timeout: seconds a run may take, or None.
    retries  more attempts for a worker that is killed while it starts
    memory   bytes that a run may hold with all that it started, or None
    """

    spec: SolverSpec
    wanted: Mapping[str, Output]
    workers: int
    threads: int
    timeout: float | None = None
    retries: int = 0
    memory: float | None = None

    def __post_init__(self) -> None:
        self._parcel = parcel(self.spec)
        self._team: list[WorkerHandle] = []
        self._false_starts = 0
        self._mean_seconds: float | None = None
        self._clock = RunClock()
        self._numbers, self._places = count(1), count(1)
        self._looked = self._weighed = 0.0

    @property
    def under_way(self) -> int:
        """Workers that have runs."""
        return sum(bool(worker.tasks) for worker in self._team)

    def results(self, queue: deque[Task], stop: Stop) -> Generator[Event, None, None]:
        """As `Backend.results`; `SurrogateError` when workers are killed again and again."""
        with owned_folder() as folder:
            self._guardian = Guardian(folder)
            try:
                while not stop.now and (self.under_way or (queue and not stop.finish)):
                    if not stop.finish:
                        self._hire(folder, queue)
                        self._feed(queue)
                    yield from self._listen(queue)
                    yield from self._end_overdue(queue)
                    yield from self._end_overweight(queue)
                    yield None
                for worker in self._team:
                    yield from self._hear(worker, queue)
            finally:
                self._dismiss()
                self._guardian.dismiss()

    def _hire(self, folder: Path, queue: deque[Task]) -> None:
        needed = min(self.workers, len(queue) + self.under_way)
        while len(self._team) < needed:
            place, token = (
                worker_place(folder, next(self._places)),
                secrets.token_bytes(TOKEN_BYTES),
            )
            process, connection = start(work, self._parcel, self.wanted, self.threads, place, token)
            channel = Channel(connection, token, waits=False)
            self._team.append(WorkerHandle(process, channel, place, self._clock.now()))
            self._guardian.watch(self._team[-1].pid, place)

    def _feed(self, queue: deque[Task]) -> None:
        for worker in self._team:
            if queue and worker.ready and not worker.busy:
                batch = [queue.popleft() for _ in range(self._batch_size(len(queue)))]
                for task in batch:
                    task.number = next(self._numbers)
                worker.tasks.extend(batch)
                worker.busy, worker.since = True, self._clock.now()
                with suppress(OSError):  # a worker that just died is found by _listen
                    worker.channel.send([(task.number, task.call) for task in batch])

    def _batch_size(self, waiting: int) -> int:
        """Runs that fill `BATCH_SECONDS`, at most a fair share of those that wait."""
        if self._mean_seconds is None:
            return 1
        fitting = BATCH_SECONDS / max(self._mean_seconds, 1e-6)
        share = -(-waiting // (2 * self.workers))
        return max(1, min(int(fitting), share, LARGEST_BATCH))

    def _listen(self, queue: deque[Task]) -> Iterator[Event]:
        heard = set(wait([worker.channel.connection for worker in self._team], self._pause()))
        for worker in list(self._team):
            if worker.channel.connection in heard:
                yield from self._hear(worker, queue)
        # A process that a solver forked may hold the pipe of a worker that has ended.
        moment = time.monotonic()
        if moment - self._looked >= TICK:
            self._looked = moment
            for worker in list(self._team):
                if worker.has_left():
                    yield from self._hear(worker, queue)
                    if worker in self._team:
                        yield from self._bury(worker, queue)

    def _pause(self) -> float:
        """Seconds until something has to be done even when nobody says a word."""
        pauses = [TICK]
        for worker in self._team:
            with suppress(OSError):
                if not worker.channel.flush():
                    pauses.append(FLUSH_SECONDS)
        if self.timeout is not None:
            now = self._clock.now()
            pauses += [w.since + self.timeout - now for w in self._team if w.tasks]
        return max(0.0, min(pauses))

    def _hear(self, worker: WorkerHandle, queue: deque[Task]) -> Iterator[Event]:
        """Runs that the worker tells of; takes it out when it ended or makes no sense."""
        try:
            for message in worker.channel.receive():
                event = self._understood(message, worker, queue)
                if event:
                    yield event
        except Garbled as error:
            yield from self._end(worker, queue, "failed", f"the worker {error}")
            return
        if worker.channel.closed:
            yield from self._bury(worker, queue)

    def _understood(self, message: Message, worker: WorkerHandle, queue: deque[Task]) -> Event:
        process, number, said = message
        if process != worker.pid:
            raise Garbled(
                f"was answered for by process {process}, a copy of it that the solver forked; "
                "such a copy must end with os._exit()"
            )
        if isinstance(said, str):
            raise PluginError(
                f"solver {self.spec.name} cannot be built in a worker process: {said}"
            )
        if said is None:
            if not worker.ready:
                self._false_starts = 0
            worker.ready, worker.busy = True, False
            queue.extendleft(reversed(worker.tasks))
            worker.tasks.clear()
            return None
        if not worker.tasks or number != worker.tasks[0].number:
            raise Garbled("sent the answer of another run")
        task = worker.tasks.popleft()
        worker.since = self._clock.now()
        mean = self._mean_seconds
        self._mean_seconds = said.seconds if mean is None else 0.9 * mean + 0.1 * said.seconds
        return task, said

    def _bury(self, worker: WorkerHandle, queue: deque[Task]) -> Iterator[Event]:
        """Take a worker out that has ended: the run that it was at failed, the others wait."""
        worker.process.join(TICK)
        reason, lost = worker.cause()
        yield from self._end(worker, queue, "failed", reason, lost)

    def _end(
        self,
        worker: WorkerHandle,
        queue: deque[Task],
        status: str,
        reason: str,
        lost: bool = False,
    ) -> Iterator[Event]:
        self._team.remove(worker)
        worker.kill()
        self._guardian.forget(worker.pid)
        if not worker.ready:
            self._count_false_start(reason, lost)
        if worker.tasks:
            task = worker.tasks.popleft()
            queue.extendleft(reversed(worker.tasks))
            worker.tasks.clear()
            seconds = self._clock.now() - worker.since
            yield task, Outcome(status, reason, seconds, answered=False, lost=lost)

    def _count_false_start(self, reason: str, lost: bool) -> None:
        """Go on with fewer workers where some work (memory for no more), else give up."""
        self._false_starts += 1
        if self._parcel.needs_main and not lost:
            reason += (
                ". It runs the script again to find the solver in it: put the script's own "
                'calls below `if __name__ == "__main__":`'
            )
        elif self._false_starts < FALSE_STARTS + (self.retries if lost else 0):
            return
        working = sum(worker.ready for worker in self._team)
        if working:
            self.workers, self._false_starts = working, 0
        elif lost:
            raise SurrogateError(
                f"{self._false_starts} workers in a row ended while they started: {reason}. "
                "The runs finished so far are kept; run again to go on"
            )
        else:
            raise PluginError(
                f"solver {self.spec.name} cannot be built in a worker process: {reason}"
            )

    def _end_overdue(self, queue: deque[Task]) -> Iterator[Event]:
        if self.timeout is None:
            return
        now, building = self._clock.now(), max(self.timeout, BUILD_SECONDS)
        for worker in list(self._team):
            if not worker.ready and now - worker.since >= building:
                self._false_starts = FALSE_STARTS
                reason = (
                    f"it was not ready after {building:g} s; if it takes that long, raise "
                    f"timeout{worker.last_words()}"
                )
                yield from self._end(worker, queue, "failed", reason)
            elif worker.tasks and now - worker.since >= self.timeout:
                head = worker.tasks[0]
                yield from self._hear(worker, queue)
                if worker in self._team and worker.tasks and worker.tasks[0] is head:
                    message = f"stopped after {self.timeout:g} s, the time limit of a run"
                    message += worker.last_words()
                    yield from self._end(worker, queue, "timed_out", message)

    def _end_overweight(self, queue: deque[Task]) -> Iterator[Event]:
        moment = time.monotonic()
        if self.memory is None or moment - self._weighed < memory.LOOK_SECONDS:
            return
        self._weighed = moment
        for worker in [worker for worker in self._team if worker.tasks]:
            if memory.is_above(self.memory, worker.pid, worker.place):
                message = f"stopped above {self.memory / 1e9:g} GB, the memory limit of a run"
                yield from self._end(worker, queue, "failed", message + worker.last_words())

    def _dismiss(self) -> None:
        """End all workers; idle ones may leave by themselves first."""
        known = guardian.tree({worker.pid: worker.place for worker in self._team})
        idle = [worker for worker in self._team if worker.ready and not worker.busy]
        for worker in idle:
            with suppress(OSError):
                worker.channel.send(None)
        end = time.monotonic() + 1.0
        for worker in idle:
            worker.process.join(max(0.0, end - time.monotonic()))
        for worker in self._team:
            worker.kill(known)
        self._team.clear()
