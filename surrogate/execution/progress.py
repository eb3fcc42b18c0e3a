"""How far the runs are, and how long the others will take."""

from __future__ import annotations

import math
import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, replace

from surrogate.runs.record import Record
from surrogate.runs.time_left import WINDOW, continues, time_left

#: Seconds between two estimates: short runs end too often for one each.
ESTIMATE = 0.2
#: A place that has been silent for so many times the longest run is not there.
SILENT = 5.0
#: Seconds that clocks of two processes may be apart.
AT_ONCE = 1e-3


@dataclass(frozen=True)
class Progress:
    """How far the runs are.

    total         different runs that the designs ask for
    reused        of these, found in the journal
    done          of these, finished now or before, failed ones included
    failed        of these, without an answer (failed or timed out)
    seconds_left  estimate from the runs of this time and of earlier times
    last          the run that just ended
    finishing     runs under way that are waited for after Ctrl-C; None as long as runs start
    ahead         of the total, runs that a design which grows may still ask for
    """

    total: int
    reused: int = 0
    done: int = 0
    failed: int = 0
    seconds_left: float | None = None
    last: Record | None = None
    finishing: int | None = None
    ahead: int = 0


class Tally:
    """Counts runs, estimates the time left, and tells the listener.

    seconds  that the latest runs of this time took, all attempts
    """

    def __init__(
        self,
        now: Progress,
        workers: int,
        listener: Callable[[Progress], None],
        clock: Callable[[], float] = time.monotonic,
    ):
        self.now, self.listener, self.clock = now, listener, clock
        self.places = _Places(workers)
        self.seconds: deque[float] = deque(maxlen=50)
        self.earlier: list[float] = []
        self.estimated = -math.inf

    def start(self, records: list[Record]) -> None:
        """Count the runs that the journal has."""
        timed = [one for one in records if math.isfinite(one.seconds)]  # rows of a table are not
        timed.sort(key=lambda record: record.finished - record.seconds)
        self.earlier = [record.seconds for record in timed[-WINDOW:]]
        failed = sum(record.status != "ok" for record in records)
        self.now = replace(self.now, reused=len(records), done=len(records), failed=failed)
        self.places.begin(self.clock())
        self._tell()

    def add(self, record: Record) -> None:
        """Count a run that just ended."""
        self.seconds.append(record.seconds * record.attempts)
        self.places.ended(self.seconds[-1], self.clock())
        self.now = replace(
            self.now,
            done=self.now.done + 1,
            last=record,
            failed=self.now.failed + (record.status != "ok"),
        )
        self._tell()

    def grow(self, added: int, known: list[Record], ahead: int) -> None:
        """Count runs that a design has added, of which some are known; ahead: may still come."""
        now, failed = self.now, sum(record.status != "ok" for record in known)
        self.now = replace(
            now,
            total=now.total - now.ahead + added + ahead,
            ahead=ahead,
            reused=now.reused + len(known),
            done=now.done + len(known),
            failed=now.failed + failed,
        )
        if known or now.total != self.now.total:
            self._tell()

    def finish(self, under_way: int) -> None:
        """No more runs start; those under way are waited for."""
        self.now = replace(self.now, finishing=under_way)
        self._tell()

    def _tell(self) -> None:
        now, left = self.clock(), self.now.total - self.now.done
        if now - self.estimated >= ESTIMATE or not left:
            took, working = self.places.took, self.places.working(now)
            known = self.earlier if continues(self.earlier, took, working) else []
            order = [*range(len(known)), *(len(known) + one for one in self.places.order)]
            running = self.places.ages(now)[:left]
            seconds = time_left([*known, *took], running, left, working, order)
            self.now, self.estimated = replace(self.now, seconds_left=seconds), now
        self.listener(self.now)


class _Places:
    """When the runs under way have begun: each place begins the next run when one ends."""

    def __init__(self, count: int):
        self.count, self.total = count, 0
        self.begun: list[tuple[float, float]] = []  # moment, number
        self.first: list[tuple[float, float]] = []  # number, seconds
        self.later: deque[tuple[float, float]] = deque(maxlen=WINDOW)

    def begin(self, now: float) -> None:
        """All places are free: which of the first runs is the first is not known."""
        self.begun = [(now, (self.count - 1) / 2.0)] * self.count

    def ended(self, seconds: float, now: float) -> None:
        """A run has ended that took so long; the next one begins at its place."""
        started = now - seconds
        if not self.first:  # what was before, building the solver or a queue, comes once
            self.begun = [(max(one, started), number) for one, number in self.begun]
        before = [one for one in self.begun if one[0] <= started + AT_ONCE]
        self.begun.remove(found := max(before) if before else min(self.begun))
        kept = self.first if len(self.first) < self.count else self.later
        kept.append((found[1], max(now - found[0], 0.0)))
        self.begun.append((now, self.count + self.total))
        self.total += 1

    @property
    def _known(self) -> list[tuple[float, float]]:
        """The latest runs; without the first ones, which waited for nothing, when others do."""
        return [*(self.first if len(self.later) < 2 * self.count else ()), *self.later]

    @property
    def took(self) -> list[float]:
        """What runs cost their places, waiting included, in s."""
        return [seconds for _, seconds in self._known]

    @property
    def order(self) -> list[float]:
        """When these began, counted so that their number stands for the next to end."""
        known = self._known
        return [number - self.total + len(known) for number, _ in known]

    def ages(self, now: float) -> list[float]:
        """For how long the runs under way have run, longest first; silent places left out."""
        ages = sorted((now - one for one, _ in self.begun), reverse=True)
        if len(self.first) < self.count:
            return ages if self.first else [0.0] * self.count
        longest = max(self.took)
        return [age for age in ages if age <= SILENT * longest]

    def working(self, now: float) -> int:
        """Places from which runs come."""
        return max(1, len(self.ages(now)))
