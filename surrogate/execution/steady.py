"""A place that stays: runs come one at a time, each in the child process of a foreign worker.

So a crash, a time limit or a memory limit costs a run and never the worker of a cluster. The
child is kept between runs, and ends when none has come for a while, or with the worker.
"""

from __future__ import annotations

import multiprocessing
import pickle
import threading
import time
from collections import deque
from collections.abc import Generator, Mapping
from dataclasses import dataclass, field
from multiprocessing.util import Finalize
from typing import Any

from surrogate.errors import SurrogateError
from surrogate.execution.answers import Outcome
from surrogate.execution.backend import Event, RunSettings
from surrogate.execution.handle import Task
from surrogate.execution.pool import Pool
from surrogate.execution.stopping import Stop
from surrogate.runs.identity import SolverSpec

#: Seconds without a run after which the child process ends: nobody may be left who asks.
IDLE_SECONDS = 10.0


def packed(settings: RunSettings) -> bytes:
    """What a foreign worker needs to know of the runs; `place_for` unpacks it."""
    spec = settings.spec
    return pickle.dumps(
        (
            (spec.name, spec.build, dict(spec.options)),
            dict(settings.wanted),
            settings.threads or 1,
            settings.timeout,
            settings.memory,
        )
    )


@dataclass
class SteadyPlace:
    """A `Pool` of one process that answers call after call; `lock` is held during a call."""

    settings: bytes
    used: float = 0.0
    lock: threading.Lock = field(default_factory=threading.Lock)
    queue: deque[Task] = field(default_factory=deque)
    events: Generator[Event, None, None] | None = None

    def evaluate(self, call: Mapping[str, Any]) -> Outcome:
        """One attempt; raises `PluginError` when the solver cannot be built here."""
        with self.lock:
            self.queue.append(Task("", dict(call)))
            if self.events is None:
                self.events = self._pool().results(self.queue, Stop())
                threading.Thread(target=self._end_when_idle, daemon=True).start()
            try:
                for event in self.events:
                    if event is not None:
                        return event[1]
            except SurrogateError:
                self._close()
                raise
            finally:
                self.used = time.monotonic()
            raise SurrogateError("the run was given up by its worker")

    def _pool(self) -> Pool:
        spec, wanted, threads, timeout, memory = pickle.loads(self.settings)
        return Pool(SolverSpec(*spec), wanted, 1, threads, timeout, memory=memory)

    def _end_when_idle(self) -> None:
        while self.events is not None:
            time.sleep(IDLE_SECONDS / 10)
            with self.lock:
                if time.monotonic() - self.used > IDLE_SECONDS:
                    self._close()

    def close(self) -> None:
        """End the child process."""
        with self.lock:
            self._close()

    def _close(self) -> None:
        if self.events is not None:
            self.events.close()
            self.events = None
        self.queue.clear()


_PLACES: dict[int, SteadyPlace] = {}
_ready = False


def place_for(settings: bytes) -> SteadyPlace:
    """The place of this thread for the runs of a study; that of an earlier study ends."""
    _prepare()
    thread = threading.get_ident()
    place = _PLACES.get(thread)
    if place is None or place.settings != settings:
        if place is not None:
            place.close()
        place = _PLACES[thread] = SteadyPlace(settings)
    return place


def close_places() -> None:
    """End the child processes of this worker."""
    for place in list(_PLACES.values()):
        if place.lock.acquire(blocking=False):
            place._close()
            place.lock.release()


def _prepare() -> None:
    """Let this process have children: a worker that its nanny made a daemon may not otherwise.

    A daemon would leave them behind; ours end with it, by their guardian if need be.
    """
    global _ready
    if not _ready:
        multiprocessing.current_process()._config["daemon"] = False  # type: ignore[attr-defined]
        Finalize(None, close_places, exitpriority=100)
        _ready = True
