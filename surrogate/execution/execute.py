"""Runs the solver where the journal has no answer yet.

Nothing that a run does can harm another one: an exception, a wrong answer, a
crash, a hang each cost one row, with a sentence that says what happened. What is
finished is in the journal, whenever and however the program ends.
"""

from __future__ import annotations

import math
import os
import time
from collections import deque
from collections.abc import Callable, Iterable, Mapping
from concurrent.futures import Executor
from contextlib import closing
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from surrogate.errors import ResultsError, StudyError
from surrogate.execution.executors import ExecutorRuns
from surrogate.execution.handle import Task
from surrogate.execution.pool import Pool
from surrogate.execution.stopping import Stop, stop_on_signals
from surrogate.runs.identity import SolverSpec, keys, run_inputs
from surrogate.runs.journal import Journal, read
from surrogate.runs.record import Record
from surrogate.runs.stored import KnownRuns, StoredMatches
from surrogate.solver import Output

#: More attempts, by default, for a run that the machine lost: killed for memory, a node's end.
LOST_AGAIN = 2


@dataclass(frozen=True)
class Progress:
    """How far the runs are.

    total         different runs that the designs ask for
    reused        of these, found in the journal
    done          of these, finished now or before, failed ones included
    failed        of these, without an answer (failed or timed out)
    seconds_left  estimate from the runs of this time, and before from those of earlier times
    last          the run that just ended
    finishing     runs under way that are waited for after Ctrl-C; None as long as runs start
    """

    total: int
    reused: int = 0
    done: int = 0
    failed: int = 0
    seconds_left: float | None = None
    last: Record | None = None
    finishing: int | None = None


def execute(
    spec: SolverSpec,
    columns: Mapping[str, Any],
    *,
    journal: str | Path,
    constants: Mapping[str, Any] | None = None,
    outputs: Iterable[str] | None = None,
    workers: int | None = None,
    threads: int | None = None,
    timeout: float | None = None,
    retries: int = 0,
    rerun: Iterable[str] = (),
    others: Iterable[str | Path] = (),
    given: StoredMatches | None = None,
    executor: Executor | None = None,
    progress: Callable[[Progress], None] | None = None,
) -> Progress:
    """Run the solver at each row of `columns` that the journal does not have; return the tally.

    columns    physical values, name -> (run,); equal rows run once (deterministic solvers)
    journal    folder of the journal
    outputs    names of the outputs to keep; None keeps all
    workers    processes, or runs at a time in `executor` (no more than it has places);
               None: as many as there are cores
    threads    of numerical libraries in each worker; None: cores / workers
    timeout    seconds that one run may take; None for any. A run that takes longer is killed
    retries    more attempts for a run that crashed, hung or raised, at least `LOST_AGAIN` for
               one that the machine lost. An answer of a deterministic solver, `SolverError`
               included, is not asked for again
    rerun      statuses of earlier runs to do again: "failed", "timed_out". Runs that the
               machine lost, or that timed out under a shorter limit than today's, are done
               again in any case
    others     folders of other studies' journals; their good runs are copied, not repeated
    given      stored runs: neither repeated nor copied
    executor   any concurrent.futures executor. It cannot kill a run: one over time is given
               up and its place in the executor stays taken
    progress   called with a `Progress` at the start and after each run

    A first Ctrl-C waits for the runs under way, a second one or SIGTERM stops at once. Raises
    KeyboardInterrupt then, when all that was finished is kept;
    `ResultsError` when the journal is in use or the disk full; `StudyError` for wrong
    arguments; `PluginError` when workers cannot build the solver.
    """
    _check(workers, threads, timeout, retries, rerun)
    wanted, given = spec.wanted(outputs), given or StoredMatches()
    asked = run_inputs(spec, columns, constants)
    runs = dict(zip(keys(spec, asked), asked, strict=True))
    with Journal(journal) as book:
        known = KnownRuns(book.contents, given, wanted).records
        missing = [key for key in runs if not _settled(known.get(key), wanted, timeout, rerun)]
        missing = _adopt(book, missing, wanted, others)
        queue = deque(Task(key, runs[key]) for key in missing)
        workers = min(workers or cores(), max(1, len(queue)))
        threads = threads or max(1, cores() // workers)
        tally = _Tally(Progress(len(runs)), workers, progress or (lambda _: None))
        known = KnownRuns(book.contents, given, wanted).records
        tally.start([known[key] for key in runs.keys() - set(missing)])
        if queue:
            with stop_on_signals() as stop:
                place = (
                    Pool(spec, wanted, workers, threads, timeout, retries)
                    if executor is None
                    else ExecutorRuns(executor, spec, wanted, workers, timeout)
                )
                _record(place, stop, queue, book, tally, spec, timeout, retries)
                if stop.finish:
                    raise KeyboardInterrupt(
                        f"stopped: {tally.now.done} of {tally.now.total} runs "
                        "are done and kept; run again to go on"
                    )
    return tally.now


def cores() -> int:
    """Cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def _check(
    workers: int | None,
    threads: int | None,
    timeout: float | None,
    retries: int,
    rerun: Iterable[str],
) -> None:
    mistakes = [
        f"{name}: {value} must be 1 or more"
        for name, value in (("workers", workers), ("threads", threads))
        if value is not None and value < 1
    ]
    if timeout is not None and not timeout > 0:
        mistakes.append(f"timeout: {timeout:g} s must be above 0")
    if retries < 0:
        mistakes.append(f"retries: {retries} must be 0 or more")
    mistakes += [
        f"rerun: '{status}' is unknown; use failed or timed_out"
        for status in rerun
        if status not in ("failed", "timed_out")
    ]
    if mistakes:
        raise StudyError(*mistakes)


def _settled(
    record: Record | None, wanted: Mapping[str, Output], timeout: float | None, rerun: Iterable[str]
) -> bool:
    """True when a run need not be done (again)."""
    if record is None or not record.answers(wanted):
        return False
    if record.status == "ok":
        return True
    if record.lost:
        return False
    if record.status == "timed_out" and record.limit is not None:
        if timeout is None or timeout > record.limit:
            return False
    return record.status not in rerun


def _adopt(
    book: Journal, missing: list[str], wanted: Mapping[str, Output], others: Iterable[str | Path]
) -> list[str]:
    """Copy good runs from other journals; return the keys that none of them has."""
    for folder in others:
        if not missing:
            break
        try:
            contents = read(folder)
        except ResultsError:  # told when that study itself is asked for
            continue
        found = {
            key
            for key in missing
            if key in contents.records and contents.records[key].holds(wanted)
        }
        for key in found:
            book.adopt(contents.records[key], contents)
        missing = [key for key in missing if key not in found]
    return missing


def _record(
    place: Pool | ExecutorRuns,
    stop: Stop,
    queue: deque[Task],
    book: Journal,
    tally: _Tally,
    spec: SolverSpec,
    timeout: float | None,
    retries: int,
) -> None:
    """Write what `place` gives into the journal; put failed runs back while they may."""
    described = spec.described
    with closing(place.results(queue, stop)) as source:
        for event in source:
            if stop.finish and tally.now.finishing is None:
                tally.finish(place.under_way)
            if event is None:
                book.sync()
                continue
            task, outcome = event
            task.attempts += 1
            decided = outcome.answered and (spec.deterministic or outcome.status == "ok")
            allowed = max(retries, LOST_AGAIN) if outcome.lost else retries
            if outcome.status != "ok" and not decided and task.attempts <= allowed:
                queue.append(task)
                continue
            record = Record(
                task.key,
                task.call,
                outcome.status,
                outcome.message,
                outcome.seconds,
                task.attempts,
                time.time(),
                timeout,
                outcome.outputs,
                solver=described,
                lost=outcome.lost,
            )
            if spec.deterministic:
                record = _with_earlier(record, book.records.get(task.key))
            book.append(record, outcome.fields)
            tally.add(record)


def _with_earlier(record: Record, earlier: Record | None) -> Record:
    """The record, with outputs that the same run was asked for at another time."""
    if earlier is None or record.status != "ok":
        return record
    return replace(record, outputs={**earlier.outputs, **record.outputs}, fields=earlier.fields)


class _Tally:
    """Counts runs, estimates the time left, and tells the listener."""

    def __init__(self, now: Progress, workers: int, listener: Callable[[Progress], None]):
        self.now, self.workers, self.listener = now, workers, listener
        self.seconds: list[float] = []
        self.earlier: float | None = None

    def start(self, records: list[Record]) -> None:
        """Count the runs that the journal has."""
        good = [record.seconds for record in records if record.status == "ok"]
        timed = [seconds for seconds in good if math.isfinite(seconds)]  # rows of a table are not
        self.earlier = sum(timed) / len(timed) if timed else None
        failed = len(records) - len(good)
        self.now = replace(self.now, reused=len(records), done=len(records), failed=failed)
        self._tell()

    def add(self, record: Record) -> None:
        """Count a run that just ended."""
        self.seconds.append(record.seconds * record.attempts)
        self.now = replace(
            self.now,
            done=self.now.done + 1,
            last=record,
            failed=self.now.failed + (record.status != "ok"),
        )
        self._tell()

    def finish(self, under_way: int) -> None:
        """No more runs start; those under way are waited for."""
        self.now = replace(self.now, finishing=under_way)
        self._tell()

    def _tell(self) -> None:
        recent = self.seconds[-100:]
        mean = sum(recent) / len(recent) if recent else self.earlier
        left = self.now.total - self.now.done
        seconds = None if left and mean is None else left * (mean or 0.0) / self.workers
        self.now = replace(self.now, seconds_left=seconds)
        self.listener(self.now)
