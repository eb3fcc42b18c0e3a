"""Runs in somebody's concurrent.futures executor: threads, processes, dask, MPI.

An executor cannot kill a run, so a time limit is kept as well as may be: a run
over time is given up, and the place that it occupies counts as lost.
"""

from __future__ import annotations

import uuid
from collections import deque
from collections.abc import Generator, Iterator, Mapping
from concurrent.futures import BrokenExecutor, CancelledError, Executor, Future
from dataclasses import dataclass, field
from queue import Empty, SimpleQueue

from surrogate.errors import SurrogateError
from surrogate.execution.answers import Outcome
from surrogate.execution.clock import TICK, RunClock
from surrogate.execution.handle import Task
from surrogate.execution.pool import Event
from surrogate.execution.stopping import Stop
from surrogate.execution.workers import BuiltSolver
from surrogate.runs.identity import SolverSpec
from surrogate.solver import Output


@dataclass
class ExecutorRuns:
    """At most `places` runs at a time in `executor`; timeout: seconds that a run may take."""

    executor: Executor
    spec: SolverSpec
    wanted: Mapping[str, Output]
    places: int
    timeout: float | None = None
    going: dict[Future[Outcome], Task] = field(default_factory=dict)
    since: dict[Future[Outcome], float] = field(default_factory=dict)
    lost: list[Future[Outcome]] = field(default_factory=list)
    clock: RunClock = field(default_factory=RunClock)

    @property
    def under_way(self) -> int:
        """Runs that the executor has not given back."""
        return len(self.going)

    def results(self, queue: deque[Task], stop: Stop) -> Generator[Event, None, None]:
        """Like `surrogate.execution.pool.Pool.results`.

        Raises `SurrogateError` when the executor breaks or has no place left.
        """
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
