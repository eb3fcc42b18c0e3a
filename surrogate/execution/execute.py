"""Runs the solver where the journal has no answer yet.

Nothing that a run does can harm another one: an exception, a wrong answer, a
crash, a hang each cost one row, with a sentence that says what happened. What is
finished is in the journal, whenever and however the program ends.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Mapping
from concurrent.futures import Executor
from contextlib import nullcontext
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

from surrogate.errors import ResultsError, StudyError
from surrogate.execution.attempts import finished_runs
from surrogate.execution.backend import Backend, RunSettings, Start, cores
from surrogate.execution.executors.futures import in_executor
from surrogate.execution.executors.local import local
from surrogate.execution.growth import Growth
from surrogate.execution.handle import Task
from surrogate.execution.memory import KNOWN
from surrogate.execution.progress import Progress, Tally
from surrogate.execution.rerun import is_asked
from surrogate.execution.rerun import mistakes as wrong_reruns
from surrogate.execution.stopping import Stop, stop_on_signals
from surrogate.runs.identity import SolverSpec, keys, run_inputs
from surrogate.runs.journal import Journal, read
from surrogate.runs.record import Record
from surrogate.runs.stored import KnownRuns, StoredMatches
from surrogate.solver import Output


def execute(
    spec: SolverSpec,
    columns: Mapping[str, Any],
    *,
    journal: str | Path | Journal,
    constants: Mapping[str, Any] | None = None,
    outputs: Iterable[str] | None = None,
    workers: int | None = None,
    threads: int | None = None,
    timeout: float | None = None,
    retries: int = 0,
    rerun: Iterable[str] = (),
    others: Iterable[str | Path] = (),
    given: StoredMatches | None = None,
    executor: Executor | Start | None = None,
    memory: float | None = None,
    progress: Callable[[Progress], None] | None = None,
    growth: Growth | None = None,
) -> Progress:
    """Run the solver at each row of `columns` that the journal does not have; return the tally.

    columns    physical values, name -> (run,); equal rows run once (deterministic solvers)
    journal    folder of the journal, or the journal itself, opened
    outputs    names of the outputs to keep; None keeps all
    workers    processes, or runs at a time in `executor` (no more than it has places);
               None: as many as there are cores, or places of a cluster
    threads    of numerical libraries in each worker; None: cores / workers
    timeout    seconds that one run may take; None for any. A run that takes longer is killed
    retries    more attempts for a run that crashed, hung or raised, at least `LOST_AGAIN` for
               one that the machine lost. An answer of a deterministic solver, `SolverError`
               included, is not asked for again
    rerun      earlier runs to do again: "failed", "timed_out", "message~text". Runs that the
               machine lost, or that timed out under a shorter limit than today's, are done
               again in any case
    others     folders of other studies' journals; their good runs are copied, not repeated
    given      stored runs: neither repeated nor copied
    executor   starts another backend than local processes (surrogate.execution.executors), or
               any concurrent.futures executor. That cannot kill a run: one over time is given
               up and its place in the executor stays taken
    memory     bytes that a run may use with all that it starts; one above it is killed
    progress   called with a `Progress` at the start and after each run
    growth     adds runs as answers come, whenever a place is free

    A first Ctrl-C waits for the runs under way, a second one or SIGTERM stops at once. Raises
    KeyboardInterrupt then, when all that was finished is kept;
    `ResultsError` when the journal is in use or the disk full; `StudyError` for wrong
    arguments; `PluginError` when workers cannot build the solver.
    """
    check(workers, threads, timeout, retries, rerun, memory)
    wanted, given = spec.wanted(outputs), given or StoredMatches()
    asked = run_inputs(spec, columns, constants)
    runs = dict(zip(keys(spec, asked), asked, strict=True))
    opened = nullcontext(journal) if isinstance(journal, Journal) else Journal(journal)
    with opened as book:
        missing = to_do(runs, KnownRuns(book.contents, given, wanted), timeout, rerun)
        missing = _adopt(book, missing, wanted, others)
        queue = deque(Task(key, runs[key]) for key in missing)
        if executor is None and growth is None:
            workers = min(workers or cores(), max(1, len(queue)))
        ahead = growth.ahead if growth else 0
        total = Progress(len(runs) + ahead, ahead=ahead)
        tally = Tally(total, workers or cores(), progress or (lambda _: None))
        known = KnownRuns(book.contents, given, wanted)
        tally.start([known.records[key] for key in runs.keys() - set(missing)])
        grow = _Growing(growth, known, queue, workers or cores(), tally) if growth else None
        if grow:
            grow.on()
        if queue:
            settings = RunSettings(
                spec, wanted, workers, threads, timeout, memory, retries, book.folder.parent
            )
            with stop_on_signals() as stop:
                backend = _starter(executor)(settings)
                _record(backend, settings, stop, queue, book, tally, grow)
                if stop.finish:
                    raise KeyboardInterrupt(
                        f"stopped: {tally.now.done} of {tally.now.total} runs "
                        "are done and kept; run again to go on"
                    )
    return tally.now


def _starter(executor: Executor | Start | None) -> Start:
    if executor is None:
        return local
    return partial(in_executor, executor) if isinstance(executor, Executor) else executor


def check(
    workers: int | None,
    threads: int | None,
    timeout: float | None,
    retries: int,
    rerun: Iterable[str],
    memory: float | None,
) -> None:
    """Raise `StudyError` with all mistakes in these arguments of `execute`."""
    mistakes = [
        f"{name}: {value} must be 1 or more"
        for name, value in (("workers", workers), ("threads", threads))
        if value is not None and value < 1
    ]
    if timeout is not None and not timeout > 0:
        mistakes.append(f"timeout: {timeout:g} s must be above 0")
    if memory is not None and not memory > 0:
        mistakes.append(f"memory: {memory:g} bytes must be above 0")
    if memory is not None and not KNOWN:
        mistakes.append("memory: only Linux tells how much a run holds; leave the limit out")
    if retries < 0:
        mistakes.append(f"retries: {retries} must be 0 or more")
    mistakes += wrong_reruns(rerun)
    if mistakes:
        raise StudyError(*mistakes)


def to_do(
    runs: Iterable[str], known: KnownRuns, timeout: float | None, rerun: Iterable[str]
) -> list[str]:
    """Keys of the runs to be done (again); a row of a table has no call that could be repeated."""
    return [
        key
        for key in runs
        if not settled(known.records.get(key), known.wanted, timeout, rerun)
        and not known.origin(key)
    ]


def settled(
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
    return not is_asked(record.status, record.message, rerun)


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
    backend: Backend,
    settings: RunSettings,
    stop: Stop,
    queue: deque[Task],
    book: Journal,
    tally: Tally,
    grow: _Growing | None,
) -> None:
    """Write what the backend gives into the journal."""
    for finished in finished_runs(backend, settings, queue, stop):
        if stop.finish and tally.now.finishing is None:
            tally.finish(backend.under_way)
        if finished is None:
            book.sync()
            continue
        record, fields = finished
        if settings.spec.deterministic:
            record = _with_earlier(record, book.records.get(record.key))
        book.append(record, fields)
        tally.add(record)
        if grow:
            grow.ended(record.key, stop)


class _Growing:
    """Puts the runs that a growth adds into the queue.

    under_way  keys of runs in the queue or begun
    """

    def __init__(
        self, growth: Growth, known: KnownRuns, queue: deque[Task], places: int, tally: Tally
    ) -> None:
        self.growth, self.known, self.queue, self.places = growth, known, queue, places
        self.tally, self.under_way = tally, {task.key for task in queue}

    def ended(self, key: str, stop: Stop) -> None:
        """A run has ended: its place is free."""
        self.under_way.discard(key)
        if not stop.finish:
            self.on()

    def on(self) -> None:
        """Add runs for the places that are free; those that are known already free it again."""
        while True:
            added = self.growth.more(self.known.ended, max(self.places - len(self.under_way), 0))
            known = [record for key in added if (record := self.known.ended(key)) is not None]
            self.tally.grow(len(added), known, self.growth.ahead)
            over = {record.key for record in known}
            new = [Task(key, call) for key, call in added.items() if key not in over]
            self.queue.extend(new)
            self.under_way |= {task.key for task in new}
            if new or not added:
                return


def _with_earlier(record: Record, earlier: Record | None) -> Record:
    """The record, with outputs that the same run was asked for at another time."""
    if earlier is None or record.status != "ok":
        return record
    return replace(record, outputs={**earlier.outputs, **record.outputs}, fields=earlier.fields)
