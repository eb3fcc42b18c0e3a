"""Runs on dask workers: dask carries them there and back, everything else is decided here.

One run at a time for each thread of each worker, bound to that worker, so that the end of a
worker blames the run that it was at and no other. A key belongs to one attempt of one run, so
that dask never answers from memory. Attempts are counted by `attempts`. A result is released
when it is in the journal.
"""

from __future__ import annotations

import logging
import secrets
import time
from collections import deque
from collections.abc import Generator, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from queue import Empty, SimpleQueue
from typing import TYPE_CHECKING, Any, Protocol

from surrogate.errors import PluginError, SurrogateError
from surrogate.execution.answers import Outcome, describe
from surrogate.execution.backend import Event, RunSettings
from surrogate.execution.clock import TICK
from surrogate.execution.handle import Task
from surrogate.execution.steady import close_places, packed, place_for
from surrogate.execution.stopping import Stop

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


def run_in_child(settings: bytes, call: Mapping[str, Any]) -> Outcome:
    """One attempt of a run, in a child process of the dask worker that this is called in."""
    return place_for(settings).evaluate(call)


@dataclass
class Sent:
    """A run that was sent to a place."""

    task: Task
    place: Place
    since: float


@dataclass
class DaskRuns:
    """At most one run at a time in each place of the workers that `source` provides."""

    settings: RunSettings
    source: WorkerSource
    going: dict[Future[Outcome], Sent] = field(default_factory=dict)
    places: set[Place] = field(default_factory=set)
    seen: dict[str, float] = field(default_factory=dict)
    finished: SimpleQueue[Future[Outcome]] = field(default_factory=SimpleQueue)
    _looked: float = -LOOK_SECONDS
    _there: float = 0.0

    @property
    def under_way(self) -> int:
        """Runs that were sent and are not back."""
        return len(self.going)

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
            yield from self._look(client, len(queue))
            if not stop.finish:
                self._send(client, queue)
            yield from self._gather(client)
            yield None
        while not self.finished.empty():
            yield from self._gather(client)

    def _send(self, client: Client, queue: deque[Task]) -> None:
        busy = {sent.place for sent in self.going.values()}
        most = self.settings.places or len(self.places)
        free = sorted(self.places - busy) if queue and len(busy) < most else []
        for place in free[: most - len(busy)]:
            if not queue:
                return
            if self._is_old(place[0]):
                continue
            task = queue.popleft()
            future = client.submit(
                run_in_child,
                self._content,
                task.call,
                key=f"{task.key}-{task.attempts}-{self._session}-{secrets.token_hex(3)}",
                pure=False,
                workers=[place[0]],
                allow_other_workers=False,
                retries=0,
            )
            self.going[future] = Sent(task, place, time.monotonic())
            future.add_done_callback(self.finished.put)

    def _is_old(self, worker: str) -> bool:
        """True for a worker that may not live until the end of another run."""
        life = self.source.lifetime(worker)
        return life is not None and time.monotonic() - self.seen[worker] > life

    def _gather(self, client: Client) -> Iterator[Event]:
        """Results that have come; each is released after it was taken."""
        try:
            future = self.finished.get(timeout=TICK)
        except Empty:
            return
        sent = self.going.pop(future, None)
        if sent is not None:
            outcome = self._outcome(future, sent)
            if outcome.lost:  # its worker takes nothing before it was seen again
                self.places = {place for place in self.places if place[0] != sent.place[0]}
            yield sent.task, outcome
            future.release()

    def _outcome(self, future: Future[Outcome], sent: Sent) -> Outcome:
        from distributed import CancelledError
        from distributed.scheduler import KilledWorker

        try:
            outcome: Outcome = future.result(timeout=CONNECT_SECONDS)
            return outcome
        except (KilledWorker, CancelledError, TimeoutError, OSError):
            return _lost(sent)
        except PluginError:
            raise
        except SurrogateError as error:  # its children were killed while they started
            return Outcome("failed", str(error), 0.0, answered=False, lost=True)
        except Exception as error:  # the worker cannot import what it needs, or ran full
            return Outcome(
                "failed", f"dask worker {sent.place[0]}: {describe(error)}", 0.0, answered=False
            )

    def _look(self, client: Client, waiting: int) -> Iterator[Event]:
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
        self.source.tend(young, waiting + len(self.going))
        for future, sent in list(self.going.items()):
            if sent.place[0] not in threads and sent.since < moment and not future.done():
                del self.going[future]
                future.cancel()
                yield sent.task, _lost(sent)
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
