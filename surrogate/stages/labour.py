"""Jobs done side by side: other processes join in once the work has gone on for a while.

Results do not depend on who did a job: each runs with one BLAS thread and no shared state.
"""

from __future__ import annotations

import multiprocessing
import multiprocessing.process
import os
import signal
import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager, suppress
from functools import partial
from pickle import PicklingError

from threadpoolctl import threadpool_limits

from surrogate.counting import Reached, listening
from surrogate.errors import SurrogateError
from surrogate.stages.board import Board
from surrogate.stages.stage import Job, Result

Hear = Callable[[Reached], None]

#: Other processes take about this long to start, in s; shorter work is not worth them.
PATIENCE = 1.5
#: Seconds between two looks at how far another process is.
LOOK = 0.5


def do(job: Job, hear: Hear = lambda part: None) -> Result:
    """The job's result; what could not be done is a sentence. hear: told how far it is.

    With one BLAS thread, so that the digits do not depend on who does it.
    """
    try:
        with threadpool_limits(1), listening(hear):
            return Result(job.function(**job.arguments))
    except SurrogateError as error:
        return Result(None, (str(error),))


def carry_out(
    jobs: Sequence[Job], workers: int = 1, hear: Hear = lambda part: None
) -> Iterator[tuple[Job, Result]]:
    """Each job with its result, in order.

    workers: processes, this one included. The others start when the jobs have taken
    `PATIENCE`, and end with the last job or with a Ctrl-C. hear: told how far the job is
    that comes next, whoever does it.
    """
    helpers = _Helpers(jobs, workers) if workers > 1 and len(jobs) > 1 else None
    try:
        for job in jobs:
            yield job, (helpers.result(job, hear) if helpers else do(job, hear))
    finally:
        if helpers:
            helpers.end()


class _Helpers:
    """Processes that take jobs from the end of the list while this one works on its start."""

    def __init__(self, jobs: Sequence[Job], workers: int):
        self.jobs, self.workers = list(jobs), min(workers, len(jobs))
        self.board = Board([job.label for job in jobs])
        self.futures: dict[str, Future[Result]] = {}
        self.pool: ProcessPoolExecutor | None = None
        self.lock = threading.RLock()
        self.timer = threading.Timer(PATIENCE, self._come)
        self.timer.daemon = True
        self.timer.start()

    def _come(self) -> None:
        """Start the pool, a job for each of its processes."""
        context = multiprocessing.get_context("spawn")
        with self.lock, _ctrl_c_is_for_the_parent():
            if self.jobs:
                self.pool = ProcessPoolExecutor(self.workers - 1, context, _begin, (self.board,))
            for _ in range(self.workers - 1):
                self._hand_out()

    def _hand_out(self) -> None:
        """Give the last job that nobody has begun to the process that is free now."""
        with self.lock, suppress(RuntimeError):  # the pool has lost a process, or is at its end
            if self.jobs and self.pool is not None:
                future = self.pool.submit(_do_alone, self.jobs[-1])
                self.futures[self.jobs.pop().label] = future
                future.add_done_callback(lambda _: self._hand_out())

    def result(self, job: Job, hear: Hear) -> Result:
        """The job's result: from the process that has taken it, or done here."""
        with self.lock:
            future = self.futures.get(job.label)
            if future is None:
                self.jobs.remove(job)
        if future is None:
            return do(job, hear)
        while not wait([future], LOOK).done:
            part = self.board.read(job.label)
            if part is not None:
                hear(part)
        try:
            return future.result()
        except (BrokenProcessPool, PicklingError, AttributeError, TypeError, ImportError):
            return do(job, hear)  # a process was lost, or the job cannot be sent to one

    def end(self) -> None:
        """Stop the timer and the processes, whatever they are at."""
        self.timer.cancel()
        with self.lock:
            self.jobs.clear()
            if self.pool is None:
                return
            processes = list((getattr(self.pool, "_processes", None) or {}).values())
            self.pool.shutdown(wait=False, cancel_futures=True)
            for process in processes:
                with suppress(OSError):
                    process.kill()


#: Where a process of the pool writes how far its job is.
_board: Board | None = None


def _do_alone(job: Job) -> Result:
    return do(job, partial(_board.write, job.label)) if _board else do(job)


def _begin(board: Board) -> None:
    """Start of a process: it ends when its parent does, even by kill -9."""
    global _board
    _board = board
    parent = multiprocessing.parent_process()
    if parent is not None:
        threading.Thread(target=_end_with, args=(parent,), daemon=True).start()


def _end_with(parent: multiprocessing.process.BaseProcess) -> None:
    parent.join()
    os._exit(1)


@contextmanager
def _ctrl_c_is_for_the_parent() -> Iterator[None]:
    """Processes started in here do not hear of a Ctrl-C: their parent ends them."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    from multiprocessing import resource_tracker

    resource_tracker.ensure_running()  # else the start of a process does, and lets signals through
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
