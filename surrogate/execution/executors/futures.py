"""Runs in somebody's concurrent.futures executor: threads, processes, dask, MPI.

An executor cannot kill a run, so a time limit is kept as well as may be: a run
over time is given up, and the place that it occupies counts as lost.
"""

from __future__ import annotations

import uuid
from collections import deque
from collections.abc import Callable, Generator, Iterator, Mapping
from concurrent.futures import BrokenExecutor, CancelledError, Executor, Future, ThreadPoolExecutor
from dataclasses import dataclass, field
from queue import Empty, SimpleQueue
from typing import Any

from surrogate.errors import SurrogateError
from surrogate.execution.answers import Outcome, describe
from surrogate.execution.backend import Backend, Event, RunSettings, cores
from surrogate.execution.clock import TICK, RunClock
from surrogate.execution.handle import Task
from surrogate.execution.stopping import Stop
from surrogate.execution.workers import BuiltSolver
from surrogate.runs.identity import SolverSpec
from surrogate.solver import Output


def threads(settings: RunSettings) -> Backend:
    """Threads of this process: for solvers that wait for something else, and release Python."""
    places = settings.places or cores()
    return in_executor(ThreadPoolExecutor(places), settings, owned=True)


def serial(settings: RunSettings) -> Backend:
    """One run after the other in this process, for debuggers; it cannot stop a run."""
    return in_executor(_Serial(), RunSettings(**{**vars(settings), "places": 1}), owned=True)


def in_executor(executor: Executor, settings: RunSettings, owned: bool = False) -> Backend:
    """Runs in any concurrent.futures executor; owned: it is shut down at the end."""
    places = settings.places or cores()
    return ExecutorRuns(executor, settings.spec, settings.wanted, places, settings.timeout, owned)


def factory(make: Callable[[], Executor], name: str, settings: RunSettings) -> Backend:
    """Runs in the executor that `make` gives; `name` stands for it in messages."""
    try:
        executor = make()
    except Exception as error:  # a stranger's function raises whatever it likes
        raise SurrogateError(
            f"executor '{name}' does not start: {describe(error)}; finished runs are kept"
        ) from error
    return in_executor(executor, settings, owned=True)


class _Serial(Executor):
    """Carries out a call when it is submitted."""

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """The future of a call that has ended."""
        future: Future[Any] = Future()
        try:
            future.set_result(fn(*args, **kwargs))
        except Exception as error:
            future.set_exception(error)
        return future


@dataclass
class ExecutorRuns:
    """At most `places` runs at a time in `executor`; timeout: seconds that a run may take."""

    executor: Executor
    spec: SolverSpec
    wanted: Mapping[str, Output]
    places: int
    timeout: float | None = None
    owned: bool = False
    going: dict[Future[Outcome], Task] = field(default_factory=dict)
    since: dict[Future[Outcome], float] = field(default_factory=dict)
    lost: list[Future[Outcome]] = field(default_factory=list)
    clock: RunClock = field(default_factory=RunClock)

    @property
    def under_way(self) -> int:
        """Runs that the executor has not given back."""
        return len(self.going)

    def results(self, queue: deque[Task], stop: Stop) -> Generator[Event, None, None]:
        """As `Backend.results`; `SurrogateError` when the executor breaks or has no place left."""
        finished: SimpleQueue[Future[Outcome]] = SimpleQueue()
        token = uuid.uuid4().hex
        try:
            while not stop.now and (self.going or (queue and not stop.finish)):
                if stop.finish:
                    self._take_back(queue)
                else:
                    self._submit(queue, token, finished)
                try:
                    future = finished.get(timeout=TICK)
                except Empty:
                    self._check_places()
                else:
                    if future in self.going:
                        yield self.going.pop(future), _outcome(future)
                yield from self._give_up_overdue()
                yield None
            for future in [future for future in self.going if future.done()]:
                yield self.going.pop(future), _outcome(future)
        finally:
            for future in self.going:
                future.cancel()
            if self.owned:
                self.executor.shutdown(wait=False, cancel_futures=True)

    def _take_back(self, queue: deque[Task]) -> None:
        """Runs that wait for a place in the executor wait in the queue instead."""
        for future in [future for future in self.going if future.cancel()]:
            queue.append(self.going.pop(future))

    @property
    def _stuck(self) -> int:
        return sum(not future.done() for future in self.lost)

    def _submit(
        self, queue: deque[Task], token: str, finished: SimpleQueue[Future[Outcome]]
    ) -> None:
        while queue and len(self.going) + self._stuck < self.places:
            task = queue.popleft()
            future = self.executor.submit(
                BuiltSolver.evaluate,
                token,
                self.spec.build,
                dict(self.spec.options),
                task.call,
                self.wanted,
            )
            self.going[future], self.since[future] = task, self.clock.now()
            future.add_done_callback(finished.put)

    def _check_places(self) -> None:
        """Stop when runs wait for places that runs over time do not leave."""
        stuck = self._stuck
        waiting = self._says_running and not any(future.running() for future in self.going)
        if stuck and (stuck >= self.places or waiting):
            raise SurrogateError(
                f"all {stuck} places of the executor are taken by runs over the "
                f"time limit of {self.timeout:g} s; the runs finished so far are "
                "kept. Local workers (no executor) can stop such runs"
            )

    @property
    def _says_running(self) -> bool:
        """Whether the executor tells which runs are under way; dask's does not."""
        return any(future.running() for future in [*self.going, *self.lost])

    def _give_up_overdue(self) -> Iterator[Event]:
        if self.timeout is None:
            return
        now, says_running = self.clock.now(), self._says_running
        for future, task in list(self.going.items()):
            if says_running and not future.running():
                self.since[future] = now  # waits for a place, which costs it no time
            elif now - self.since[future] >= self.timeout and not future.done():
                del self.going[future]
                self.lost.append(future)
                yield (
                    task,
                    Outcome(
                        "timed_out",
                        f"given up after {self.timeout:g} s, the time limit of a run; "
                        "the executor cannot stop it",
                        now - self.since[future],
                        answered=False,
                    ),
                )


def _outcome(future: Future[Outcome]) -> Outcome:
    try:
        return future.result()
    except (BrokenExecutor, CancelledError) as error:
        raise SurrogateError(
            f"the executor stopped working ({type(error).__name__}: {error}); the "
            "runs finished so far are kept. Local workers (no executor) survive "
            "a solver that crashes"
        ) from error
    except Exception as error:  # the executor's own trouble: pickling, a lost machine
        return Outcome("failed", f"{type(error).__name__}: {error}", 0.0, answered=False)
