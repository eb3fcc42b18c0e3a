"""Runs on dask workers: dask carries them there and back, everything else is decided here.

One task at a time for each thread of each worker, bound to that worker, so that the end of a
worker blames the run that it was at and no other. Short runs travel together; those of a lost
worker are then sent again one by one, which blames nobody before. A key belongs to one attempt
of one run, so that dask never answers from memory. Attempts are counted by `attempts`. A result
is released when it is in the journal.
"""

from __future__ import annotations

import logging
import secrets
import time
from collections import deque
from collections.abc import Generator, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from queue import Empty, SimpleQueue
from typing import TYPE_CHECKING, Any, Protocol

from surrogate.errors import PluginError, SurrogateError
from surrogate.execution.answers import Outcome, describe
from surrogate.execution.backend import Event, RunSettings
from surrogate.execution.clock import TICK
from surrogate.execution.handle import Task
from surrogate.execution.pool import LARGEST_BATCH
from surrogate.execution.steady import close_places, packed, place_for
from surrogate.execution.stopping import Stop
from surrogate.execution.workers import BATCH_SECONDS

if TYPE_CHECKING:
    from distributed import Client, Future

#: Seconds between two looks which workers are there.
LOOK_SECONDS = 1.0

#: Seconds to find a scheduler.
CONNECT_SECONDS = 60.0

Place = tuple[str, int]


class WorkerSource(Protocol):
    """Where dask workers come from.

    patience: seconds without any worker until `absence` is asked for a reason to give up.
    """

    patience: float

    def open(self) -> str:
        """See that there is a scheduler; returns its address."""

    def tend(self, workers: set[str], wanted: int) -> None:
        """See that workers come: these are there by name, so many runs want one."""

    def lifetime(self, worker: str) -> float | None:
        """Seconds for which a worker takes new runs; None for any."""

    def absence(self) -> str | None:
        """Why no worker is there; None while it is worth waiting."""

    def close(self) -> None:
        """End what was started."""


def run_in_child(settings: bytes, calls: Sequence[Mapping[str, Any]]) -> list[Outcome]:
    """Attempts of runs, in a child process of the dask worker that this is called in.

    When they have taken `BATCH_SECONDS` the others are left.
    """
    place, until = place_for(settings), time.perf_counter() + BATCH_SECONDS
    outcomes = []
    for call in calls:
        outcomes.append(place.evaluate(call))
        if time.perf_counter() > until:
            break
    return outcomes


@dataclass
class Sent:
    """Runs that were sent to a place."""

    tasks: list[Task]
    place: Place
    since: float


@dataclass
class DaskRuns:
    """At most one task at a time in each place of the workers that `source` provides."""

    settings: RunSettings
    source: WorkerSource
    going: dict[Future[list[Outcome]], Sent] = field(default_factory=dict)
    places: set[Place] = field(default_factory=set)
    seen: dict[str, float] = field(default_factory=dict)
    alone: set[str] = field(default_factory=set)
    finished: SimpleQueue[Future[list[Outcome]]] = field(default_factory=SimpleQueue)
    _looked: float = -LOOK_SECONDS
    _there: float = 0.0
    _mean: float | None = None

    @property
    def under_way(self) -> int:
        """Runs that were sent and are not back."""
        return sum(len(sent.tasks) for sent in self.going.values())

    def results(self, queue: deque[Task], stop: Stop) -> Generator[Event, None, None]:
        """As `Backend.results`; `SurrogateError` when scheduler or workers stay away."""
        self._content, self._session = packed(self.settings), secrets.token_hex(4)
        with _dask_silenced():
            try:
                client = self._connected()
                try:
                    yield from self._results(client, queue, stop)
                finally:
                    self._leave(client)
            finally:
                self.source.close()

    def _connected(self) -> Client:
        from distributed import Client

        address = self.source.open()
        try:
            return Client(address, timeout=CONNECT_SECONDS, set_as_default=False)
        except (OSError, ValueError) as error:
            raise SurrogateError(
                f"no dask scheduler answers at {address} ({describe(error)}); start one: "
                "dask scheduler. The runs finished so far are kept"
            ) from error

    def _results(
        self, client: Client, queue: deque[Task], stop: Stop
    ) -> Generator[Event, None, None]:
        self._there = time.monotonic()
        while not stop.now and (self.going or (queue and not stop.finish)):
            yield from self._look(client, queue)
            if not stop.finish:
                self._send(client, queue)
            yield from self._gather(queue)
            yield None
        while not self.finished.empty():
            yield from self._gather(queue)

    def _send(self, client: Client, queue: deque[Task]) -> None:
        busy = {sent.place for sent in self.going.values()}
        most = self.settings.places or len(self.places)
        free = sorted(self.places - busy) if queue and len(busy) < most else []
        for place in free[: most - len(busy)]:
            if not queue:
                return
            if self._is_old(place[0]):
                continue
            tasks = self._batch(queue)
            future = client.submit(
                run_in_child,
                self._content,
                [task.call for task in tasks],
                key=f"{tasks[0].key}-{tasks[0].attempts}-{self._session}-{secrets.token_hex(3)}",
                pure=False,
                workers=[place[0]],
                allow_other_workers=False,
                retries=0,
            )
            self.going[future] = Sent(tasks, place, time.monotonic())
            future.add_done_callback(self.finished.put)

    def _batch(self, queue: deque[Task]) -> list[Task]:
        """The next runs: as many as fill `BATCH_SECONDS`, at most a fair share of the queue."""
        tasks = [queue.popleft()]
        if tasks[0].key in self.alone or self._mean is None:
            return tasks
        fitting = int(BATCH_SECONDS / max(self._mean, 1e-6))
        share = -(-len(queue) // (2 * max(1, len(self.places))))
        for _ in range(min(fitting, share, LARGEST_BATCH) - 1):
            if queue[0].key in self.alone:
                break
            tasks.append(queue.popleft())
        return tasks

    def _is_old(self, worker: str) -> bool:
        """True for a worker that may not live until the end of another run."""
        life = self.source.lifetime(worker)
        return life is not None and time.monotonic() - self.seen[worker] > life

    def _gather(self, queue: deque[Task]) -> Iterator[Event]:
        """Results that have come; each is released after it was taken."""
        try:
            future = self.finished.get(timeout=TICK)
        except Empty:
            return
        sent = self.going.pop(future, None)
        if sent is not None:
            outcomes = self._outcomes(future, sent)
            if outcomes[0].lost:  # its worker takes nothing before it was seen again
                self.places = {place for place in self.places if place[0] != sent.place[0]}
                yield from self._lose(sent, outcomes[0], queue)
            else:
                queue.extendleft(reversed(sent.tasks[len(outcomes) :]))
                for task, outcome in zip(sent.tasks, outcomes, strict=False):
                    mean, took = self._mean, outcome.seconds
                    self._mean = took if mean is None else 0.9 * mean + 0.1 * took
                    yield task, outcome
            future.release()

    def _lose(self, sent: Sent, outcome: Outcome, queue: deque[Task]) -> Iterator[Event]:
        """A run that was alone is lost; of several nobody knows which, so each is tried alone."""
        if len(sent.tasks) == 1:
            yield sent.tasks[0], outcome
        else:
            self.alone.update(task.key for task in sent.tasks)
            queue.extendleft(reversed(sent.tasks))

    def _outcomes(self, future: Future[list[Outcome]], sent: Sent) -> list[Outcome]:
        from distributed import CancelledError
        from distributed.scheduler import KilledWorker

        try:
            outcomes: list[Outcome] = future.result(timeout=CONNECT_SECONDS)
            return outcomes
        except (KilledWorker, CancelledError, TimeoutError, OSError):
            return [_lost(sent)]
        except PluginError:
            raise
        except SurrogateError as error:  # its children were killed while they started
            return [Outcome("failed", str(error), 0.0, answered=False, lost=True)]
        except Exception as error:  # the worker cannot import what it needs, or ran full
            said = f"dask worker {sent.place[0]}: {describe(error)}"
            return [Outcome("failed", said, 0.0, answered=False)] * len(sent.tasks)

    def _look(self, client: Client, queue: deque[Task]) -> Iterator[Event]:
        """See which workers are there; runs of those that are gone are lost."""
        moment = time.monotonic()
        if moment - self._looked < LOOK_SECONDS:
            return
        self._looked = moment
        there = self._workers(client)
        threads = {worker: int(told["nthreads"]) for worker, told in there.items()}
        self.seen = {worker: self.seen.get(worker, moment) for worker in threads}
        self.places = {(worker, n) for worker, count in threads.items() for n in range(count)}
        young = {str(there[worker]["name"]) for worker in there if not self._is_old(worker)}
        self.source.tend(young, len(queue) + self.under_way)
        for future, sent in list(self.going.items()):
            if sent.place[0] not in threads and sent.since < moment and not future.done():
                del self.going[future]
                future.cancel()
                yield from self._lose(sent, _lost(sent), queue)
        if threads:
            self._there = moment
        elif moment - self._there > self.source.patience:
            why = self.source.absence()
            if why:
                raise SurrogateError(f"{why}. Finished runs are kept; run again to go on")

    def _workers(self, client: Client) -> dict[str, Any]:
        """What the scheduler tells of each worker that is there, by its address."""
        try:
            if client.status != "running":
                raise OSError(f"the connection is {client.status}")
            return dict(client.scheduler_info(n_workers=-1)["workers"])
        except (OSError, TimeoutError, RuntimeError) as error:
            raise SurrogateError(
                f"the dask scheduler has gone ({describe(error)}); the runs finished so far are "
                "kept, run again to go on"
            ) from error

    def _leave(self, client: Client) -> None:
        """Give up what still runs, and end the solver's processes on all workers."""
        try:
            if client.status == "running":
                client.cancel(list(self.going), force=True)
                client.run(close_places, on_error="ignore")
        except Exception:  # a scheduler that has gone; its workers end the processes themselves
            pass
        finally:
            client.close(timeout=5)


@contextmanager
def _dask_silenced() -> Iterator[None]:
    """What dask would print about lost workers and schedulers is said in sentences here."""
    import distributed  # noqa: F401  # makes its loggers

    loggers = [
        one
        for name, one in logging.root.manager.loggerDict.items()
        if name.startswith("distributed") and isinstance(one, logging.Logger)
    ]
    levels = [one.level for one in loggers]
    for one in loggers:
        one.setLevel(logging.CRITICAL + 1)
    try:
        yield
    finally:
        for one, level in zip(loggers, levels, strict=True):
            one.setLevel(level)


def _lost(sent: Sent) -> Outcome:
    return Outcome(
        "failed",
        f"the dask worker {sent.place[0]} was lost: it, or its machine, ended from outside",
        time.monotonic() - sent.since,
        answered=False,
        lost=True,
    )
