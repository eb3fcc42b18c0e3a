"""How far the runs are, and how long the others will take."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

from surrogate.runs.record import Record


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


class Tally:
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
