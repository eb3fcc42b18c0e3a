"""Runs shared with other processes, on this machine or any, through the results folder alone.

Each worker claims a run before it begins, writes what it finishes into a segment of its own,
and takes over the runs of workers that are gone. It ends when all runs are done, whoever did
them. No scheduler, no port, no lock.
"""

from __future__ import annotations

import os
import secrets
import socket
import time
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from surrogate.errors import Mistake, ResultsError
from surrogate.execution.attempts import finished_runs
from surrogate.execution.backend import RunSettings, cores
from surrogate.execution.clock import TICK
from surrogate.execution.execute import check, to_do
from surrogate.execution.executors.local import local
from surrogate.execution.growth import Growth
from surrogate.execution.handle import Task
from surrogate.execution.progress import Progress, Tally
from surrogate.execution.shared.claims import ENDED, LEASE, SIGNS, SharedFolder, Watch
from surrogate.execution.stopping import Stop, stop_on_signals
from surrogate.runs.identity import RunInputs, SolverSpec, keys, run_inputs
from surrogate.runs.journal import LOCK, JournalContents, read
from surrogate.runs.lock import Lock
from surrogate.runs.record import Record
from surrogate.runs.segment import Segment
from surrogate.runs.stored import KnownRuns, StoredMatches

#: Seconds of work that a worker claims ahead, and most runs: they wait for it while others idle.
AHEAD_SECONDS, MOST_AHEAD = 0.5, 400

#: Seconds between two looks at what others have done.
LOOK_SECONDS = 1.0


@dataclass(frozen=True)
class Shared:
    """Runs shared with `surrogate work` processes through the results folder.

    lease: seconds without a sign of life after which a worker counts as gone.
    """

    lease: float = LEASE

    @classmethod
    def mistakes(cls, options: Mapping[str, Any], timeout: float | None) -> Iterator[Mistake]:
        """What is wrong with the value of the lease."""
        lease = options.get("lease", LEASE)
        if isinstance(lease, int | float) and not lease > 0:
            yield Mistake(("lease",), f"lease: {lease:g} s must be above 0; {LEASE:g} is usual")


def work(
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
    memory: float | None = None,
    rerun: Iterable[str] = (),
    others: Iterable[str | Path] = (),
    given: StoredMatches | None = None,
    progress: Callable[[Progress], None] | None = None,
    lease: float = LEASE,
    shared: SharedFolder | None = None,
    growth: Growth | None = None,
) -> Progress:
    """As `execute`, side by side with others that do the same; ends when all runs are done.

    workers  processes of this machine that run the solver
    lease    seconds without a sign of life after which a worker counts as gone: longer than
             the folder takes to show what another machine wrote
    shared   the folder as this worker sees it; default: that of `journal`
    growth   adds runs as answers come, and tells of those that other workers have added
    """
    check(workers, threads, timeout, retries, rerun, memory)
    wanted, given = spec.wanted(outputs), given or StoredMatches()
    asked = run_inputs(spec, columns, constants)
    runs = dict(zip(keys(spec, asked), asked, strict=True))
    shared = shared or SharedFolder(Path(journal))
    _keep_clear_of_a_run(shared.folder)
    stored = KnownRuns(shared.contents(), given, wanted)
    known, missing = stored.records, to_do(runs, stored, timeout, rerun)
    places = workers or cores()
    if growth is None:
        places = min(places, max(1, len(missing)))
    settings = RunSettings(spec, wanted, places, threads, timeout, memory, retries)
    ahead = growth.ahead if growth else 0
    total = Progress(len(runs) + ahead, ahead=ahead)
    tally = Tally(total, places, progress or (lambda _: None))
    tally.start([known[key] for key in runs.keys() - set(missing)])
    if missing or ahead:
        before = {key: known[key].finished for key in missing if key in known}
        member = Member(shared, Watch(shared, lease), runs, deque(missing), before)
        with stop_on_signals() as stop, Segment(shared.folder, member.name) as segment:
            try:
                _Worker(settings, member, segment, tally, others, given, growth).work(stop)
            finally:
                member.leave(segment.length)
            if stop.finish:
                raise KeyboardInterrupt(
                    f"stopped: {tally.now.done} of {tally.now.total} runs are done and kept; "
                    "other workers go on, or run again"
                )
    return tally.now


def _keep_clear_of_a_run(folder: Path) -> None:
    """Raise `ResultsError` while `surrogate run` uses the folder for itself."""
    for attempt in range(10):
        try:
            with suppress(OSError):  # a folder that has no locks: nobody holds one
                folder.mkdir(parents=True, exist_ok=True)
                Lock(folder / LOCK).release()
            return
        except ResultsError:  # held by a run, or for a moment by another worker that looks
            if attempt == 9:
                raise
            time.sleep(0.05)


@dataclass
class Member:
    """This worker among the others: the runs that it, and that others have.

    before  when runs that are to be done again were done last
    mine    claimed here and not done: run -> generation of the claim
    theirs  claimed by others, as far as seen
    """

    shared: SharedFolder
    watch: Watch
    runs: dict[str, RunInputs]
    untried: deque[str]
    before: Mapping[str, float]
    mine: dict[str, int] = field(default_factory=dict)
    theirs: dict[str, int] = field(default_factory=dict)
    name: str = field(default_factory=lambda: own_name())
    _signs: int = 0
    _signed: float | None = None

    def __post_init__(self) -> None:
        # Each starts somewhere else, so that they seldom reach for the same run.
        self.untried.rotate(secrets.randbelow(max(1, len(self.untried))))

    def live(self) -> None:
        """Give a sign of life when it is time."""
        now = self.watch.clock.now()
        if self._signed is None or now - self._signed >= self.watch.lease / SIGNS:
            self._signs, self._signed = self._signs + 1, now
            self.shared.show(self.name, str(self._signs))

    def leave(self, length: int) -> None:
        """Say that no more comes; length: of the segment."""
        self.shared.show(self.name, f"{ENDED} {length}")

    def claim(self, most: int) -> Iterator[str]:
        """Claim runs until this worker has `most`."""
        while self.untried and len(self.mine) < most:
            key = self.untried.popleft()
            if self.shared.claim(key, 0, self.name) or self.shared.owner(key, 0) == self.name:
                self.mine[key] = 0
                yield key
            else:
                self.theirs[key] = 0

    def done_by_others(self, contents: JournalContents) -> Iterator[Record]:
        """Records of others' runs that have come."""
        for key in list(self.theirs):
            record = contents.records.get(key)
            if record is not None and record.finished != self.before.get(key):
                del self.theirs[key]
                yield record

    def take_over(self, most: int) -> Iterator[str]:
        """Claim runs of workers that are gone, until this worker has `most`.

        A worker may have finished a run just before; so the records are read after it was
        seen to be gone.
        """
        gone = [key for key in self.theirs if self._is_gone(key)]
        if not gone:
            return
        contents = self.shared.contents()
        for key in gone:
            record = contents.records.get(key)
            done = record is not None and record.finished != self.before.get(key)
            if done or len(self.mine) >= most:
                continue
            generation = self.theirs[key] + 1
            if self.shared.claim(key, generation, self.name):
                del self.theirs[key]
                self.mine[key] = generation
                yield key
            else:
                self.theirs[key] = generation

    def _is_gone(self, key: str) -> bool:
        while (owner := self.shared.owner(key, self.theirs[key] + 1)) is not None:
            self.theirs[key] += 1
        generation = self.theirs[key]
        owner = self.shared.owner(key, generation)
        return self.watch.is_gone(owner or "", f"{key}.{generation}")

    def still_has(self, key: str) -> bool:
        """False when others took the run over, because they took this worker for gone."""
        generation = self.mine.pop(key)
        if self.shared.owner(key, generation + 1) is None:
            return True
        self.theirs[key] = generation + 1
        return False


@dataclass
class _Worker:
    """Does claimed runs in local processes."""

    settings: RunSettings
    member: Member
    segment: Segment
    tally: Tally
    others: Iterable[str | Path]
    given: StoredMatches
    growth: Growth | None = None
    _looked: float = 0.0
    _grown: float = -LOOK_SECONDS
    _pause: float = LOOK_SECONDS

    def __post_init__(self) -> None:
        self._neighbours: list[JournalContents] = []
        for folder in self.others:
            with suppress(ResultsError):  # told when that study itself is asked for
                self._neighbours.append(read(folder))

    def work(self, stop: Stop) -> None:
        """Do runs until none is left, or as `stop` asks."""
        member = self.member
        while not stop.finish and (member.untried or member.theirs or member.mine or self._grow()):
            member.live()
            queue: deque[Task] = deque()
            self._fill(queue)
            if queue:
                self._carry_out(queue, stop)
            elif member.theirs:
                time.sleep(TICK)

    def _carry_out(self, queue: deque[Task], stop: Stop) -> None:
        backend = local(self.settings)
        for finished in finished_runs(backend, self.settings, queue, stop):
            self.member.live()
            if stop.finish and self.tally.now.finishing is None:
                self.tally.finish(backend.under_way)
            if finished is None:
                self.segment.sync()
            else:
                record, fields = finished
                if self.member.still_has(record.key):
                    self.tally.add(self.segment.append(record, fields))
            if not stop.finish:
                self._fill(queue)

    def _fill(self, queue: deque[Task]) -> None:
        """Claim as many runs as this worker should have."""
        most = self._most()
        if self.growth and time.monotonic() - self._grown >= LOOK_SECONDS:
            self._grow()
        self._add(queue, self.member.claim(most))
        now = time.monotonic()
        if self.member.theirs and now - self._looked >= self._pause:
            for record in self.member.done_by_others(self.member.shared.contents()):
                self.tally.add(record)
            if not self.member.untried:
                self._add(queue, self.member.take_over(most))
            self._looked = time.monotonic()
            self._pause = max(LOOK_SECONDS, 10 * (self._looked - now))

    def _grow(self) -> bool:
        """Take in the runs that a growing design has added, here or elsewhere; True for some."""
        if self.growth is None:
            return False
        member, places = self.member, self.settings.places or 1
        known = KnownRuns(member.shared.contents(), self.given, self.settings.wanted)
        free = 0 if member.untried else max(places - len(member.mine), 0)
        added = self.growth.more(known.ended, free)
        ended = [record for key in added if (record := known.ended(key)) is not None]
        self.tally.grow(len(added), ended, self.growth.ahead)
        member.runs.update(added)
        over = {record.key for record in ended}
        member.untried.extend(key for key in added if key not in over)
        self._grown = time.monotonic()
        return bool(added)

    def _add(self, queue: deque[Task], claimed: Iterator[str]) -> None:
        for key in claimed:
            record = self._known_elsewhere(key)
            if record is None:
                queue.append(Task(key, self.member.runs[key]))
            elif self.member.still_has(key):
                self.tally.add(record)

    def _known_elsewhere(self, key: str) -> Record | None:
        for contents in self._neighbours:
            record = contents.records.get(key)
            if record is not None and record.holds(self.settings.wanted):
                return self.segment.adopt(record, contents)
        return None

    def _most(self) -> int:
        """Runs that this worker has at a time: one a place, more of short ones."""
        places = self.settings.places or 1
        recent = self.tally.seconds
        mean = sum(recent) / len(recent) if recent else AHEAD_SECONDS
        return max(places, min(MOST_AHEAD, int(AHEAD_SECONDS * places / max(mean, 1e-6))))


def own_name() -> str:
    """A name for a worker of this process that no other has."""
    host = "".join(c if c.isalnum() or c == "-" else "-" for c in socket.gethostname())
    return f"{host[:40]}-{os.getpid()}-{secrets.token_hex(3)}"
